/// @file read_stages.cpp  [[stage]]: how long each lasts, and what it changes of bodies.
#include <algorithm>

#include "engine/units/nearest.h"
#include "scenes/reader/parts.h"

namespace epafi {

Condition read_condition(Reading& reading, const TableValues& v, const std::string& prefix, const std::string& label) {
  Condition c;
  if (v.has(prefix + "measure")) c.measure = v.text(prefix + "measure");
  if (v.has(prefix + "component")) c.component = v.text(prefix + "component");
  c.duration = v.number_or(prefix + "for", 0.0);
  c.above = v.has(prefix + "above");
  if (v.written(prefix + "above") == v.written(prefix + "below"))
    reading.error(v.written(prefix + "above") ? v.place_of(prefix + "above") : v.place,
                  label + ": write above or below");
  c.limit = c.above ? v.number(prefix + "above") : v.number_or(prefix + "below", 0.0);
  return c;
}

void check_condition(Draft& draft, const Condition& condition, const Place& place, const std::string& label) {
  std::vector<std::string> names;
  for (const MeasureSpec& m : draft.scene.measures) names.push_back(m.name);
  if (condition.measure.empty() || std::find(names.begin(), names.end(), condition.measure) != names.end()) return;
  draft.reading.error(
      place, "unknown measure '" + condition.measure + "' in " + label +
                 (names.empty() ? "; the scene has no [[measure]]" : suggestion(condition.measure, names, "measures")));
}

namespace {

StageSpec read_stage(Reading& reading, const Node& item, std::size_t number) {
  const std::string label = stage_label(item, number);
  StageSpec stage;
  stage.place = item.place;
  Node own;
  own.place = item.place;
  for (const Member& m : item.members)
    if (m.key == "name" || m.key == "duration" || m.key == "until") own.members.push_back(m);
  const std::size_t errors = reading.errors();
  const TableValues v = read_table(own, label, reading.schema.at("stage").fields, reading);
  if (v.has("name")) stage.name = v.text("name");
  stage.duration = v.number_or("duration", 1.0);
  if (v.written("duration") == v.written("until")) {
    if (reading.errors() == errors)
      reading.error(v.written("until") ? v.place_of("until") : item.place,
                    label + ": write how long it lasts, duration = ... or until = { measure = ..., at_most = ... }");
    return stage;
  }
  if (!v.written("until") || !v.has("until.at_most")) return stage;
  stage.duration = v.number("until.at_most");
  stage.until = read_condition(reading, v, "until.", label + " until");
  if (stage.until->duration >= stage.duration)
    reading.error(v.place_of("until"), label + " until: for is not shorter than at_most; it never holds so long");
  return stage;
}

}  // namespace

void read_stages(Draft& draft) {
  Reading& reading = draft.reading;
  auto& stages = draft.scene.stages;
  for (std::size_t k = 0; k < draft.stages->size(); ++k) {
    StageSpec stage = read_stage(reading, (*draft.stages)[k], k);
    for (const StageSpec& other : stages)
      if (!stage.name.empty() && other.name == stage.name)
        reading.error(stage.place, "the stage '" + stage.name + "' is given twice; first in line " +
                                       std::to_string(other.place.line));
    stages.push_back(std::move(stage));
  }
  if (stages.empty()) stages.push_back({"", draft.scene.run.duration.value, {}, {}});
  draft.scene.stage = draft.stage;
}

namespace {

/// True where no body of the name exists any more.
bool are_gone(const Scene& scene, const NamedBodies& named) {
  const auto removed = [](const BodyChange& change) { return change.remove && !change.one; };
  bool any = false;
  for (const auto& [first, count] : named.bodies)
    for (std::size_t k = first; k < first + count; ++k) any = any || !scene.bodies[k].absent;
  for (const auto& [fill, one] : named.fills) any = any || std::ranges::none_of(scene.fills[fill].changes, removed);
  return !any && !(named.bodies.empty() && named.fills.empty());
}

}  // namespace

void check_stage(Draft& draft) {
  const StageSpec& stage = draft.scene.stages[draft.stage];
  if (!stage.until) return;
  const std::string label = "[[stage]] '" + stage.name + "' until";
  check_condition(draft, *stage.until, stage.place, label);
  const auto& measures = draft.scene.measures;
  const auto watched = std::ranges::find(measures, stage.until->measure, &MeasureSpec::name);
  if (watched == measures.end()) return;
  if (watched->interval > stage.duration * (1.0 + 1e-9))
    draft.reading.error(stage.place, label + ": the measure '" + watched->name + "' has an interval of " +
                                         format_number(watched->interval) + " s, longer than at_most = " +
                                         format_number(stage.duration) + " s; the stage would never see its value");
  for (const NamedBodies& bodies : watched->bodies)
    if (are_gone(draft.scene, bodies))
      return draft.reading.error(stage.place, label + ": the bodies of the measure '" + watched->name +
                                                  "' are gone; this stage or an earlier one has taken them out");
}

namespace {

void check_change(Draft& draft, const ChangeOfBodies& change, const TableValues& v, const BodySpec& body) {
  Reading& reading = draft.reading;
  if (body.fixed && (body.motion || body.servo))
    reading.error(v.place, change.label + ": a fixed body has no motion; write fixed = false beside it");
  const std::string& form = draft.scene.shapes[body.shape].type;
  if (body.moves() && is_only_wall(form) && !body.absent)
    reading.error(v.place, change.label + ": a " + form + " cannot move freely; give it a motion or leave it fixed");
}

BodyChange read_change(Draft& draft, const ChangeOfBodies& change, const TableValues& v) {
  Reading& reading = draft.reading;
  const Since since{change.stage, 0.0};
  BodyChange out;
  if (v.has("fixed")) out.fixed = v.boolean("fixed");
  out.remove = v.has("remove") && v.boolean("remove");
  if (const Node* motion = change.table->find("motion")) {
    MotionsRead read = read_motions(reading, *motion, change.label);
    out.moves = true;
    if (!read.parts.empty()) out.motion = MotionSpec{std::move(read.parts), since};
    if (read.servo) out.servo = ServoSpec{*read.servo, since};
  }
  BodySpec loaded;
  read_body_loads(reading, *change.table, v, change.label, since, loaded);
  out.loads = v.written("force") || v.written("torque");
  if (loaded.force) out.force = *loaded.force;
  if (loaded.load) out.load = *loaded.load;
  return out;
}

}  // namespace

/// Reads the changes once for all bodies of the name: expressions of i, j, k refer to the body's own table.
void read_stage_bodies(Draft& draft) {
  Reading& reading = draft.reading;
  const auto& all = reading.schema.at("body").fields;
  std::vector<Field> fields;
  for (const Field& f : all)
    if (f.name == "motion" || f.name == "force" || f.name == "torque") fields.push_back(f);
  for (const char* name : {"fixed", "remove"}) {
    Field f;
    f.name = name;
    f.kind = Kind::boolean;
    f.optional = true;
    fields.push_back(f);
  }
  for (const ChangeOfBodies& change : draft.body_changes) {
    const std::size_t errors = reading.errors();
    const TableValues v = read_table(*change.table, change.label, fields, reading);
    const NamedBodies found = find_bodies(draft, change.name, change.table->place, change.label);
    if (reading.errors() != errors) continue;
    BodyChange one = read_change(draft, change, v);
    draft.scene.changes_bodies = draft.scene.changes_bodies || change.stage == draft.stage;
    for (const auto& [first, count] : found.bodies)
      for (std::size_t k = first; k < first + count; ++k) {
        BodySpec& body = draft.scene.bodies[k];
        if (body.absent) {
          reading.error(change.table->place, change.label + ": the body is gone; an earlier stage has taken it out");
        } else {
          apply(one, body);
          check_change(draft, change, v, body);
        }
        if (reading.errors() != errors) break;
        if (body.moves() && !body.absent) let_move(draft, body.shape);
      }
    for (const auto& [fill, number] : found.fills) {
      one.one = number;
      draft.scene.fills[fill].changes.push_back(one);
    }
  }
}

void apply(const BodyChange& change, BodySpec& body) {
  if (change.fixed) body.fixed = *change.fixed;
  if (change.remove) body.absent = true;
  if (change.moves) {
    body.motion = change.motion;
    body.servo = change.servo;
  }
  if (change.loads) {
    body.force = change.force;
    body.load = change.load;
  }
}

}  // namespace epafi
