/// @file read_view.cpp  [view]
#include "scenes/reader/parts.h"

namespace epafi {

void read_view(Draft& draft) {
  Reading& reading = draft.reading;
  const Node* table = find_table(reading, "view");
  if (table == nullptr) return;
  const TableValues v = read_table(*table, "[view]", reading.schema.at("view").fields, reading);
  ViewSettings& view = draft.scene.view;
  if (v.has("field")) view.field = v.text("field");
  if (v.has("camera")) view.preset = v.text("camera");
  if (v.has("camera.from")) view.from = v.vec3("camera.from");
  if (v.has("camera.to")) view.to = v.vec3("camera.to");
  if (v.has("camera.up")) {
    const auto up = unit_vector(reading, v.vec3("camera.up"), v.place_of("camera.up"), "[view] camera up");
    if (up) view.up = *up;
  }
  if (v.has("camera.angle_deg")) view.angle = v.number("camera.angle_deg");
  if (view.from && view.to && (*view.from - *view.to).norm() == 0.0)
    reading.error(v.place_of("camera"), "[view] camera: `from` and `to` are the same point; nothing can be seen");
  if (!v.has("range")) return;
  const auto& range = v.numbers("range");
  if (range.size() == 2 && range[0] < range[1])
    view.range = {range[0], range[1]};
  else
    reading.error(v.place_of("range"), "[view] range: expected [least, largest], the first one smaller");
}

}  // namespace epafi
