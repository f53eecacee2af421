/// @file read_springs.cpp  [[spring]], with `repeat` unrolled.
#include "scenes/reader/parts.h"
#include "scenes/reader/repeat.h"

namespace epafi {
namespace {

/// One body by name; reports an unknown one and several.
std::optional<std::size_t> one_body(Draft& draft, const TableValues& v, const char* key, const std::string& label) {
  const NamedBodies found = find_bodies(draft, v.text(key), v.place_of(key), label);
  if (found.bodies.size() == 1 && found.bodies.front().count == 1 && found.fills.empty())
    return found.bodies.front().first;
  if (!found.bodies.empty() || !found.fills.empty())
    draft.reading.error(v.place_of(key), label + " " + key + ": '" + v.text(key) + "' are several bodies; name one");
  return std::nullopt;
}

void read_spring(Draft& draft, const Node& item) {
  Reading& reading = draft.reading;
  const std::string label = item_label("spring", item);
  const std::size_t errors = reading.errors();
  const TableValues v = read_table(item, label, reading.schema.at("spring").fields, reading);
  if (reading.errors() != errors) return;
  SpringSpec s;
  s.place = v.place;
  s.name = v.has("name") ? v.text("name") : "spring";
  const auto body = one_body(draft, v, "body", label);
  if (!body) return;
  s.body = *body;
  if (!draft.scene.bodies[s.body].moves())
    reading.error(v.place_of("body"), label + ": body '" + v.text("body") + "' does not move freely; name it in `to`");
  if (v.has("to")) {
    s.to = one_body(draft, v, "to", label);
    if (s.to && *s.to == s.body) reading.error(v.place_of("to"), label + ": both ends are on one body");
    if (v.written("speed"))
      reading.error(v.place_of("speed"), label + ": speed is that of a frame; leave out `to` or speed");
  }
  s.speed = v.number_or("speed", 0.0);
  s.attachment = v.vec3("attachment");
  s.stiffness = v.vec3("stiffness");
  s.damping = v.vec3("damping");
  s.preload = v.vec3("preload");
  for (int i = 0; i < 3; ++i) {
    if (s.stiffness[i] < 0.0 || s.damping[i] < 0.0)
      reading.error(v.place, label + ": stiffness and damping are not negative");
    if (s.preload[i] != 0.0 && s.stiffness[i] == 0.0)
      reading.error(v.place_of("preload"), label + ": a preload along an axis without stiffness");
  }
  if (s.stiffness.isZero() && s.damping.isZero())
    reading.warning(v.place, label + ": neither stiffness nor damping; it does nothing");
  draft.scene.changes_bodies = draft.scene.changes_bodies || (draft.stage > 0 && item.stage == draft.stage);
  draft.scene.springs.push_back(std::move(s));
}

}  // namespace

void read_springs(Draft& draft) {
  Reading& reading = draft.reading;
  each_item(reading, "spring", [&](const Node& item) {
    each_copy(reading, item, item_label("spring", item), reading.schema.at("spring").fields, "spring",
              [&](const Node& copy) { read_spring(draft, copy); });
  });
}

}  // namespace epafi
