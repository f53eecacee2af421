#include "scenes/reader/schema_acts.h"

#include "scenes/reader/fields.h"

namespace epafi {

std::vector<Field> region_box() {
  return {needed(table("box", "axis-aligned box",
                       {required("min", "", "m", Kind::vec3, {}, "lower corner"),
                        required("max", "", "m", Kind::vec3, {}, "upper corner")}))};
}

namespace {
/// Fields of a condition on the value of a measure.
std::vector<Field> condition_fields() {
  return {text("measure", "name of a measure"), text("component", "component of the measure"),
          optional("above", "", "", Kind::number, {}, "the value is above this"),
          optional("below", "", "", Kind::number, {}, "the value is below this"),
          with_default(required("for", "", "s", Kind::number, not_negative, "for at least this time"), Value(0.0))};
}

}  // namespace

TableSchema stage_table() {
  auto until = condition_fields() +
               std::vector<Field>{required("at_most", "", "s", Kind::number, positive,
                                           "longest time; a stage that ends then did not meet its condition")};
  return {"stage",
          TableSchema::Form::list,
          "one stage of a run: its length, and the keys of the scene that it changes (world.gravity, contact.friction, "
          "body.NAME = { motion, fixed, force, torque, remove } ...)",
          {text("name", "name in progress, summary and frames"),
           optional("duration", "", "s", Kind::number, positive, "length of the stage; or write until"),
           table("until", "condition that ends the stage", std::move(until))}};
}

TableSchema start_table() {
  return {"start",
          TableSchema::Form::single,
          "begins with the bodies and contacts of an earlier run; from may be a table of these keys with `run`",
          {optional("from", "", "", Kind::text, {}, "folder of the run"),
           optional("run", "", "", Kind::text, {}, "folder of the run, in place of from"),
           optional("time", "", "s", Kind::number, not_negative, "time of a snapshot; default: the last state"),
           optional("bodies", "", "", Kind::texts, {1, infinity}, "names of bodies to take; default: all"),
           table("region", "takes bodies whose centres are inside", region_box()),
           with_default(required("at_rest", "", "", Kind::boolean, {}, "sets all velocities to zero"), Value(false)),
           with_default(required("move", "", "m", Kind::vec3, {}, "displacement of all bodies, after the rotation"),
                        Value(Vec3(Vec3::Zero()))),
           with_default(required("euler_deg", "", "", Kind::vec3, {},
                                 "rotation of all bodies about the origin: roll, pitch, yaw in degrees"),
                        Value(Vec3(Vec3::Zero())))}};
}

std::vector<Field> bound_fields(bool ends_run) {
  const std::vector<Field> thens = ends_run ? std::vector<Field>{number_bound_fields()[1]} : std::vector<Field>{};
  const auto of_body =
      std::vector<Field>{
          optional("body", "", "", Kind::text, {}, "name of the body or bodies"),
          optional("group", "", "", Kind::text, {}, "name of a group of bodies"),
          required("below", "", "m", Kind::number, not_negative, "bound"),
          with_default(required("after", "", "s", Kind::number, not_negative, "time from which it is measured"),
                       Value(0.0))} +
      thens;
  const auto number = [](const char* name, const char* help) {
    return optional(name, "", "", Kind::bound, not_negative, help);
  };
  std::vector<Field> all{number("energy_error", "relative energy error"),
                         number("overlap_relative", "overlap over bounding radius"),
                         number("momentum_error", "relative momentum error"),
                         number("residual", "residual of the contact problem"),
                         table("drift", "horizontal displacement of bodies", of_body),
                         table("sag", "vertical displacement of bodies", of_body)};
  if (!ends_run) return all;
  all.push_back(tables("measure", "values of measures, each left where it is not above or below its bound"));
  return all;
}

TableSchema bounds_measure_table() {
  return {"bounds.measure", TableSchema::Form::list, "a bound on a measure: it stays above or below",
          condition_fields() + std::vector<Field>{with_default(required("after", "", "s", Kind::number, not_negative,
                                                                        "time from which it counts"),
                                                               Value(0.0)),
                                                  number_bound_fields()[1]}};
}

std::vector<Field> number_bound_fields() {
  Field then =
      with_default(word("then", "fail: exit code 1; stop: the run ends early with exit code 0", {"fail", "stop"}),
                   Value(std::string("fail")));
  return {required("below", "", "", Kind::number, not_negative, "bound"), then};
}

}  // namespace epafi
