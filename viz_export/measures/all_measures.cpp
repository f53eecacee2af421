#include "viz_export/measures/all_measures.h"

#include "viz_export/measures/body_measures.h"
#include "viz_export/measures/bulk_measures.h"
#include "viz_export/measures/contact_measures.h"
#include "viz_export/measures/count_measure.h"
#include "viz_export/measures/flow_measures.h"
#include "viz_export/measures/granular_measures.h"
#include "viz_export/measures/wheelset_measure.h"

namespace epafi {

namespace {

const Field body{"body", "", "", Kind::text, {}, {}, "name of a body or a group"};
const Field relative_to{"relative_to", "", "", Kind::text, {}, {},
                        "name of the body that it is seen from, as a table that moves or turns; the ground where not written", true};
const Field between{"between", "", "", Kind::texts, {}, {}, "two names of bodies or groups"};
const Field plane{"plane", "", "", Kind::table, {}, {}, "plane that is crossed", false, {},
                  {{"point", "", "m", Kind::vec3, {}, {}, "a point of the plane"},
                   {"normal", "", "", Kind::vec3, {}, {}, "direction that counts positive"}}};
const Field region{"region", "", "", Kind::table, {}, {}, "part of space; the whole periodic cell where not written", true, {},
                   {{"box", "", "", Kind::table, {}, {}, "between two corners", false, {},
                     {{"min", "", "m", Kind::vec3, {}, {}, "lower corner"}, {"max", "", "m", Kind::vec3, {}, {}, "upper corner"}}}}};
const Field axis{"axis", "", "", Kind::text, Value(std::string("z")), {}, "direction across the layers", false, {"x", "y", "z"}};
const Field centre{"centre", "", "m", Kind::vec3, Value(Vec3(0, 0, 0)), {}, "top of the axis of the heap, on its base"};
const Field cell{"cell", "", "m", Kind::number, {}, positive, "edge of the cubes that are compared"};
const Field outlet{"outlet", "", "", Kind::text, {}, {}, "name of an outlet"};
const Field bins{"bins", "", "", Kind::integer, 10.0, {1, 200}, "number of layers"};
const Field rings{
    "bins", "", "", Kind::integer, {}, {1, 1000}, "number of rings or layers; else they are one mean diameter wide",
    true};
const Field least{"least", "", "", Kind::integer, 4.0, {1, 100},
                  "contacts below which a body is a rattler: 4 without friction, 2 with it"};
const Field window{"window", "", "s", Kind::number, 0.1, positive, "the rate is the mean over this time"};

/// The same key where a kind does without it.
Field if_written(Field field) {
  field.optional = true;
  return field;
}

template <BodyQuantity Q>
std::unique_ptr<Measure> make_body(MeasureSetup s) { return std::make_unique<BodyMeasure>(std::move(s), Q); }

}  // namespace

const std::vector<MeasureEntry>& all_measures() {
  static const std::vector<MeasureEntry> list{
      {{"mass_flow", "mass through a plane: rate, mass", {plane, window}, {}, ""},
       [](MeasureSetup s) { return std::make_unique<MassFlow>(std::move(s)); }},
      {{"energy",
        "kinetic, potential, elastic, dissipated with its parts, work and the ledger's relative error",
        {},
        {},
        ""},
       [](MeasureSetup) { return std::make_unique<EnergyMeasure>(); }},
      {{"contact", "overlap, forces and slip between two bodies or groups", {between}, {}, ""},
       [](MeasureSetup s) { return std::make_unique<ContactMeasure>(std::move(s)); }},
      {{"position", "centre of mass of a body or group", {body}, {}, ""}, make_body<BodyQuantity::position>},
      {{"velocity", "velocity of the centre of mass", {body}, {}, ""}, make_body<BodyQuantity::velocity>},
      {{"angular_velocity", "angular velocity (mean by mass)", {body}, {}, ""},
       make_body<BodyQuantity::angular_velocity>},
      {{"force", "sum of the contact forces on a body or group", {body}, {}, ""},
       [](MeasureSetup s) { return std::make_unique<ForceMeasure>(std::move(s)); }},
      {{"drift",
        "largest horizontal displacement (distance) and sag since the start",
        {body, relative_to},
        {},
        ""},
       [](MeasureSetup s) { return std::make_unique<DriftMeasure>(std::move(s)); }},
      {{"count",
        "number, mass and volume of bodies in a region or on one side of a plane",
        {if_written(body), region, if_written(plane)},
        {},
        ""},
       [](MeasureSetup s) { return std::make_unique<CountMeasure>(std::move(s)); }},
      {{"coordination",
        "mean number of touching neighbours, with and without rattlers",
        {least},
        {},
        "Agnolin and Roux 2007"},
       [](MeasureSetup s) { return std::make_unique<Coordination>(s); }},
      {{"stress",
        "stress of the contacts in a region: pressure and six components",
        {region},
        {},
        "Love 1927; Weber 1966"},
       [](MeasureSetup s) { return std::make_unique<StressMeasure>(std::move(s)); }},
      {{"solid_fraction", "share of a region that bodies fill", {region}, {}, ""},
       [](MeasureSetup s) { return std::make_unique<SolidFractionMeasure>(std::move(s)); }},
      {{"profile", "velocity and density in layers of a region", {region, axis, bins}, {}, ""},
       [](MeasureSetup s) { return std::make_unique<ProfileMeasure>(std::move(s)); }},
      {{"hysteresis", "force over overlap of one contact and the area of its loop", {between}, {}, ""},
       [](MeasureSetup s) { return std::make_unique<HysteresisMeasure>(std::move(s)); }},
      {{"force_chains",
        "chains of bodies of high stress, share of strong contacts",
        {},
        {},
        "Peters et al. 2005; Radjai et al. 1996"},
       [](MeasureSetup s) { return std::make_unique<ForceChains>(std::move(s)); }},
      {{"angle_of_repose", "slope of a heap (degrees), its height and reach", {centre, axis, rings}, {}, ""},
       [](MeasureSetup s) { return std::make_unique<ReposeMeasure>(std::move(s)); }},
      {{"mixing", "Lacey's index of two groups", {between, cell}, {}, "Lacey 1954"},
       [](MeasureSetup s) { return std::make_unique<MixingMeasure>(std::move(s)); }},
      {{"outlet", "bodies and mass that an outlet has taken out", {outlet}, {}, ""},
       [](MeasureSetup s) { return std::make_unique<OutletMeasure>(std::move(s)); }},
      {{"wheelset",
        "a wheelset in the axes of its track: place, angles, forces of the rails on each wheel",
        {body},
        {},
        ""},
       [](MeasureSetup s) { return std::make_unique<WheelsetMeasure>(std::move(s)); }},
      {{"swing", "amplitude of a wheelset's hunting within the last window", {body, window}, {}, ""},
       [](MeasureSetup s) { return std::make_unique<SwingMeasure>(std::move(s)); }},
  };
  return list;
}

}  // namespace epafi
