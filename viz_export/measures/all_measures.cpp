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
const Field relative_to{"relative_to",
                        "",
                        "",
                        Kind::text,
                        {},
                        {},
                        "body that is the frame of reference, as a moving table; default: the ground",
                        true};
const Field between{"between", "", "", Kind::texts, {}, {2, 2}, "two names of bodies or groups"};
const Field plane{"plane",
                  "",
                  "",
                  Kind::table,
                  {},
                  {},
                  "plane that is crossed",
                  false,
                  {},
                  {{"point", "", "m", Kind::vec3, {}, {}, "a point of the plane"},
                   {"normal", "", "", Kind::vec3, {}, {}, "direction that counts positive"}}};
const Field region_box{
    "box",
    "",
    "",
    Kind::table,
    {},
    {},
    "between two corners",
    false,
    {},
    {{"min", "", "m", Kind::vec3, {}, {}, "lower corner"}, {"max", "", "m", Kind::vec3, {}, {}, "upper corner"}}};
const Field region{"region", "", "",          Kind::table, {}, {}, "part of space; default: the whole periodic cell",
                   true,     {}, {region_box}};
const Field axis{"axis",         "", "", Kind::text, Value(std::string("z")), {}, "direction across the layers", false,
                 {"x", "y", "z"}};
const Field centre{"centre", "", "m", Kind::vec3, Value(Vec3(0, 0, 0)), {}, "top of the axis of the heap, on its base"};
const Field cell{"cell", "", "m", Kind::number, {}, positive, "edge of the cubes that are compared"};
const Field outlet{"outlet", "", "", Kind::text, {}, {}, "name of an outlet"};
const Field bins{"bins", "", "", Kind::integer, 10.0, {1, 200}, "number of layers"};
const Field rings{
    "bins", "", "", Kind::integer, {}, {1, 1000}, "number of rings or layers; else they are one mean diameter wide",
    true};
const Field least{"least",
                  "",
                  "",
                  Kind::integer,
                  4.0,
                  {1, 100},
                  "contacts below which a body is a rattler: 4 without friction, 2 with it"};
const Field window{"window", "", "s", Kind::number, 0.1, positive, "the rate is the mean over this time"};

/// The same key as an optional one.
Field if_written(Field field) {
  field.optional = true;
  return field;
}

template <class M>
MeasureEntry measure_entry(const char* name, const char* summary, std::vector<Field> keys, const char* source = "") {
  return {{name, summary, std::move(keys), {}, source}, [](MeasureSetup setup) -> std::unique_ptr<Measure> {
            if constexpr (std::is_constructible_v<M, MeasureSetup>)
              return std::make_unique<M>(std::move(setup));
            else
              return std::make_unique<M>();
          }};
}

template <BodyQuantity Q>
MeasureEntry body_entry(const char* name, const char* summary) {
  return {{name, summary, {body}},
          [](MeasureSetup setup) { return std::make_unique<BodyMeasure>(std::move(setup), Q); }};
}

}  // namespace

const std::vector<MeasureEntry>& all_measures() {
  static const std::vector<MeasureEntry> list{
      measure_entry<MassFlow>("mass_flow", "mass through a plane: rate, mass", {plane, window}),
      measure_entry<EnergyMeasure>(
          "energy", "kinetic, potential, elastic, dissipated with its parts, work and the ledger's relative error", {}),
      measure_entry<ContactMeasure>("contact", "overlap, forces and slip between two bodies or groups", {between}),
      body_entry<BodyQuantity::position>("position", "centre of mass of a body or group"),
      body_entry<BodyQuantity::velocity>("velocity", "velocity of the centre of mass"),
      body_entry<BodyQuantity::angular_velocity>("angular_velocity", "angular velocity (mean by mass)"),
      measure_entry<ForceMeasure>("force", "sum of the contact forces on a body or group", {body}),
      measure_entry<DriftMeasure>("drift", "largest horizontal displacement (distance) and sag since the start",
                                  {body, relative_to}),
      measure_entry<CountMeasure>("count", "number, mass and volume of bodies in a region or on one side of a plane",
                                  {if_written(body), region, if_written(plane)}),
      measure_entry<Coordination>("coordination", "mean number of touching neighbours, with and without rattlers",
                                  {least}, "Agnolin and Roux 2007"),
      measure_entry<StressMeasure>("stress", "stress of the contacts in a region: pressure and six components",
                                   {region}, "Love 1927; Weber 1966"),
      measure_entry<SolidFractionMeasure>("solid_fraction", "solid fraction of a region", {region}),
      measure_entry<ProfileMeasure>("profile", "velocity and density in layers of a region", {region, axis, bins}),
      measure_entry<HysteresisMeasure>("hysteresis", "force over overlap of one contact and the area of its loop",
                                       {between}),
      measure_entry<ForceChains>("force_chains", "chains of bodies of high stress, share of strong contacts", {},
                                 "Peters et al. 2005; Radjai et al. 1996"),
      measure_entry<ReposeMeasure>("angle_of_repose", "slope of a heap (degrees), its height and reach",
                                   {centre, axis, rings}),
      measure_entry<MixingMeasure>("mixing", "Lacey's index of two groups", {between, cell}, "Lacey 1954"),
      measure_entry<OutletMeasure>("outlet", "number and mass of bodies that an outlet has removed", {outlet}),
      measure_entry<WheelsetMeasure>(
          "wheelset", "a wheelset in the axes of its track: place, angles, forces of the rails on each wheel", {body}),
      measure_entry<SwingMeasure>("swing", "amplitude of a wheelset's hunting within the last window", {body, window}),
  };
  return list;
}

}  // namespace epafi
