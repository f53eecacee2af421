#include "scenes/all_measures.h"

namespace epafi {
namespace {

Field body() { return {"body", "", "", Kind::text, std::nullopt, {}, "name of a body or of a repeated group"}; }

Field between() { return {"between", "", "", Kind::texts, std::nullopt, {2, 2}, "names of the two bodies"}; }

Field plane() {
  Field field{"plane", "", "", Kind::table, std::nullopt, {}, "plane that bodies cross along its normal"};
  field.fields = {{"point", "", "m", Kind::vec3, std::nullopt, {}, "a point of the plane"},
                  {"normal", "n", "", Kind::vec3, std::nullopt, {}, "direction counted as positive, any length"}};
  return field;
}

Field region() {
  Field box{"box", "", "", Kind::table, std::nullopt, {}, "axis-aligned box"};
  box.fields = {{"min", "", "m", Kind::vec3, std::nullopt, {}, "lower corner"}, {"max", "", "m", Kind::vec3, std::nullopt, {}, "upper corner"}};
  Field field{"region", "", "", Kind::table, std::nullopt, {}, "where it is measured; everywhere if not written"};
  field.fields = {box};
  field.optional = true;
  return field;
}

}  // namespace

const std::vector<Entry>& all_measures() {
  static const std::vector<Entry> list{
      {"energy", "kinetic, potential, elastic, dissipated energy and work [J]", {}, {}, ""},
      {"position", "x y z of a body's centre of mass [m]", {body()}, {}, ""},
      {"velocity", "x y z of a body's velocity [m/s]", {body()}, {}, ""},
      {"angular_velocity", "x y z of a body's angular velocity in world axes [rad/s]", {body()}, {}, ""},
      {"contact", "overlap, forces, slip and point of the contacts of two bodies", {between()}, {}, ""},
      {"mass_flow", "mass through a plane [kg] and its rate [kg/s]", {plane()}, {}, ""},
      {"drift", "largest horizontal displacement of the bodies since the start [m]", {body()}, {}, ""},
      {"coordination", "mean number of contacts of a free body", {region()}, {}, ""},
  };
  return list;
}

}  // namespace epafi
