/// @file read_fills.cpp  [[fill]]: many bodies placed in a region.
#include "scenes/reader/parts.h"

namespace epafi {
namespace {

void read_shapes_of(Draft& draft, const TableValues& values, const std::string& label, FillSpec& fill) {
  Reading& reading = draft.reading;
  const Place place = values.place_of("shape");
  for (const auto& name : values.has("shape") ? values.texts("shape") : std::vector<std::string>{}) {
    const auto shape = find_shape(draft, name, place, label);
    if (!shape) continue;
    const std::string& form = draft.scene.shapes[*shape].type;
    if (form == "half_space" || form == "mesh")
      reading.error(place, label + " shape: a " + form + " cannot move freely");
    fill.shapes.push_back(*shape);
  }
  fill.weights.assign(fill.shapes.size(), 1.0);
  if (!values.has("weights")) return;
  fill.weights = values.numbers("weights");
  if (fill.weights.size() == fill.shapes.size()) return;
  reading.error(values.place_of("weights"), label + " weights: expected one per shape (" +
                                                std::to_string(fill.shapes.size()) + "), found " +
                                                std::to_string(fill.weights.size()));
}

void read_amount(Reading& reading, const TableValues& values, const std::string& label, FillSpec& fill) {
  if (values.has("count")) fill.count = static_cast<std::uint64_t>(values.number("count"));
  fill.mass = values.optional_number("mass");
  fill.full = values.has("until");
  const int written = values.written("count") + values.written("mass") + values.written("until");
  if (written != 1) reading.error(values.place, label + ": write exactly one of count, mass, until");
}

void read_size(Reading& reading, const TableValues& values, const std::string& label, FillSpec& fill) {
  if (!values.has("size.distribution") || !values.has("size.min") || !values.has("size.max")) return;
  fill.size = FillSpec::Size{values.text("size.distribution"), values.number("size.min"), values.number("size.max")};
  if (fill.size->min > fill.size->max) reading.error(values.place_of("size"), label + " size: min is larger than max");
}

void read_fill(Draft& draft, const Node& item) {
  Reading& reading = draft.reading;
  const std::string label = item_label("fill", item);
  const TableValues values = read_table(item, label, reading.schema.at("fill").fields, reading);
  FillSpec fill;
  fill.place = item.place;
  fill.name = values.has("name")          ? values.text("name")
              : draft.scene.fills.empty() ? "fill"
                                          : "fill" + std::to_string(draft.scene.fills.size() + 1);
  check_group_name(draft, fill.name, values.written("name") ? values.place_of("name") : item.place);
  read_shapes_of(draft, values, label, fill);
  read_amount(reading, values, label, fill);
  read_size(reading, values, label, fill);
  if (values.has("material"))
    fill.material = find_material(draft, values.text("material"), values.place_of("material"), label).value_or(0);
  if (values.has("region.box.min") && values.has("region.box.max")) {
    fill.region = {values.vec3("region.box.min"), values.vec3("region.box.max")};
    check_box(reading, fill.region.min, fill.region.max, values.place_of("region.box"), label + " region");
  }
  fill.method =
      values.has("method") && values.text("method") == "random" ? FillSpec::Method::random : FillSpec::Method::lattice;
  fill.seed = static_cast<std::uint64_t>(values.number_or("seed", static_cast<double>(draft.scene.run.seed)));
  if (values.has("velocity")) fill.velocity = values.vec3("velocity");
  draft.scene.fills.push_back(std::move(fill));
}

}  // namespace

void read_fills(Draft& draft) {
  each_item(draft.reading, "fill", [&](const Node& item) { read_fill(draft, item); });
}

}  // namespace epafi
