#include "scenes/reader/schema_acts.h"

#include "scenes/reader/fields.h"

namespace epafi {

std::vector<Field> region_box() {
  return {needed(table("box", "axis-aligned box",
                       {required("min", "", "m", Kind::vec3, {}, "lower corner"),
                        required("max", "", "m", Kind::vec3, {}, "upper corner")}))};
}

namespace {
/// What a value of a measure must do.
std::vector<Field> condition_fields() {
  return {text("measure", "name of a measure"), text("component", "of the measure"),
          optional("above", "", "", Kind::number, {}, "it is above this"),
          optional("below", "", "", Kind::number, {}, "it is below this"),
          with_default(required("for", "", "s", Kind::number, not_negative, "without a break"), Value(0.0))};
}

}  // namespace

TableSchema stage_table() {
  auto until = condition_fields() + std::vector<Field>{required("at_most", "", "s", Kind::number, positive,
                                                                "longest time; what ends there did not meet it")};
  return {"stage",
          TableSchema::Form::list,
          "one act of a scene: how long it lasts, and keys of the scene that change with it "
          "(world.gravity, contact.friction, body.NAME = { motion, fixed, force, torque, remove } ...)",
          {text("name", "name in progress, summary and frames"),
           optional("duration", "", "s", Kind::number, positive, "how long it lasts, or until"),
           table("until", "a condition that ends it", std::move(until))}};
}

TableSchema start_table() {
  return {
      "start",
      TableSchema::Form::single,
      "bodies, contacts and their memory of a run that has been made; from may be a table of these keys with `run`",
      {optional("from", "", "", Kind::text, {}, "folder of the run"),
       optional("run", "", "", Kind::text, {}, "the same"),
       optional("time", "", "s", Kind::number, not_negative,
                "of one of its snapshots; its last state where not written"),
       optional("bodies", "", "", Kind::texts, {1, infinity}, "names of those that come along; all where not written"),
       table("region", "those whose centres are in it", region_box()),
       with_default(required("at_rest", "", "", Kind::boolean, {}, "velocities are left behind"), Value(false)),
       with_default(required("move", "", "m", Kind::vec3, {}, "displaces all, after they were turned"),
                    Value(Vec3(Vec3::Zero()))),
       with_default(
           required("euler_deg", "", "", Kind::vec3, {}, "turns all about the origin: roll, pitch, yaw in degrees"),
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
  Field then = with_default(word("then", "fail: exit code 1; stop: the run ends early and well", {"fail", "stop"}),
                            Value(std::string("fail")));
  return {required("below", "", "", Kind::number, not_negative, "bound"), then};
}

}  // namespace epafi
