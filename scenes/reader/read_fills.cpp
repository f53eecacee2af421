/// @file read_fills.cpp  [[fill]]: many bodies placed in a region.
#include <algorithm>

#include "scenes/generators.h"
#include "scenes/reader/parts.h"
#include "scenes/start_run.h"

namespace epafi {
namespace {

void read_shapes_of(Draft& draft, const TableValues& values, const std::string& label, FillSpec& fill) {
  Reading& reading = draft.reading;
  const Place place = values.place_of("shape");
  for (const auto& name : values.has("shape") ? values.texts("shape") : std::vector<std::string>{}) {
    const auto shape = find_shape(draft, name, place, label);
    if (!shape) continue;
    let_move(draft, *shape);
    const std::string& form = draft.scene.shapes[*shape].type;
    if (is_only_wall(form)) reading.error(place, label + " shape: a " + form + " cannot move freely");
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
  const int written = values.meant("count") + values.meant("mass") + values.meant("until");
  if (written != 1) reading.error(values.place, label + ": write exactly one of count, mass, until");
}

/// Converts shares of mass to shares of number: mass is proportional to f^3 for a size factor f.
void shares_of_number(const TableValues& v, FillSpec::Size& size) {
  if (v.text("size.by") != "mass") return;
  for (std::size_t k = 0; k < size.shares.size(); ++k)
    size.shares[k] /= size.values[k] * size.values[k] * size.values[k];
}

void read_size(Reading& reading, const TableValues& v, const std::string& label, FillSpec& fill) {
  if (!v.has("size.distribution")) return;
  FillSpec::Size size;
  size.distribution = v.text("size.distribution");
  const auto wants = [&](std::initializer_list<const char*> keys) {
    bool all = true;
    for (const std::string key : keys) {
      if (v.has("size." + key)) continue;
      if (!v.meant("size." + key))
        reading.error(v.place_of("size"), label + " size: distribution '" + size.distribution + "' needs " + key);
      all = false;
    }
    return all;
  };
  const Place place = v.place_of("size");
  if (size.distribution == "table") {
    if (!wants({"values", "shares"})) return;
    size.values = v.numbers("size.values");
    size.shares = v.numbers("size.shares");
    if (size.values.empty() || size.values.size() != size.shares.size())
      return reading.error(place, label + " size: values and shares have the same length, at least 1");
    size.min = *std::min_element(size.values.begin(), size.values.end());
    size.max = *std::max_element(size.values.begin(), size.values.end());
    shares_of_number(v, size);
  } else if (size.distribution == "uniform") {
    if (!wants({"min", "max"})) return;
    size.min = v.number("size.min");
    size.max = v.number("size.max");
  } else {
    if (!wants({"deviation"})) return;
    size.mean = v.number_or("size.mean", 1.0);
    size.deviation = v.number("size.deviation");
    const SizeBounds bounds = natural_bounds(size);
    size.min = v.number_or("size.min", bounds.min);
    size.max = v.number_or("size.max", bounds.max);
    if (!(size.min > 0.0))
      return reading.error(place, label + " size: three deviations below the mean is no size; write min");
    if (size.min > size.mean || size.max < size.mean)
      return reading.error(place, label + " size: the mean lies between min and max");
  }
  if (size.min > size.max) reading.error(place, label + " size: min is larger than max");
  fill.size = std::move(size);
}

void read_pouring(Reading& reading, const TableValues& v, const std::string& label, FillSpec& fill) {
  const bool pours = fill.method == FillSpec::Method::pour;
  for (const char* key : {"rate", "mass_rate", "from"})
    if (!pours && v.written(key)) reading.warning(v.place_of(key), label + ": " + key + " is not used by this method");
  if (!pours) return;
  fill.rate = v.number_or("rate", 0.0);
  fill.mass_rate = v.number_or("mass_rate", 0.0);
  fill.from = v.number_or("from", 0.0);
  if (v.meant("rate") && v.meant("mass_rate"))
    reading.error(v.place, label + ": rate and mass_rate both say how fast bodies come; keep one");
  else if (!v.meant("rate") && !v.meant("mass_rate"))
    reading.error(v.place, label + ": method 'pour' needs rate (1/s) or mass_rate (kg/s)");
  if (fill.full) reading.error(v.place, label + ": method 'pour' needs count or mass, a region never gets full");
}

/// A fill of the run that the scene starts from adds no bodies; it says so where it is written with another amount.
void tell_overruled(Draft& draft, const FillSpec& fill) {
  const auto is_same = [&fill](const FillSpec& f) {
    return f.name == fill.name && f.method == fill.method && f.count == fill.count && f.mass == fill.mass &&
           f.full == fill.full && f.rate == fill.rate && f.mass_rate == fill.mass_rate &&
           f.region.min == fill.region.min && f.region.max == fill.region.max;
  };
  if (std::ranges::any_of(draft.scene.start->made->assembly->scene.fills, is_same)) return;
  draft.reading.warning(fill.place, "[[fill]] '" + fill.name +
                                        "' is one of the run that the scene starts from and adds no bodies; give it "
                                        "another name to add some");
}

void read_fill(Draft& draft, const Node& item) {
  Reading& reading = draft.reading;
  const std::string label = item_label("fill", item);
  const TableValues values = read_table(item, label, reading.schema.at("fill").fields, reading);
  FillSpec fill;
  fill.place = item.place;
  fill.stage = item.stage;
  fill.group = values.has("group") ? values.text("group") : "";
  fill.name = values.has("name")          ? values.text("name")
              : draft.scene.fills.empty() ? "fill"
                                          : "fill" + std::to_string(draft.scene.fills.size() + 1);
  const auto of_run = [&](const GroupSpec& g) { return g.from && g.name == fill.name; };
  const bool named = values.has("name"), imported = std::ranges::any_of(draft.scene.groups, of_run);
  const bool is_of_run = imported && (named || draft.scene.start->goes_on);
  if (!is_of_run) {
    for (std::size_t n = 2; std::ranges::any_of(draft.scene.groups, of_run); ++n)
      fill.name = "fill" + std::to_string(n);
    draft.scene.changes_bodies =
        draft.scene.changes_bodies || (fill.stage == draft.stage && (draft.scene.start || draft.stage > 0));
    check_group_name(draft, fill.name, values.written("name") ? values.place_of("name") : item.place);
  }
  read_shapes_of(draft, values, label, fill);
  read_amount(reading, values, label, fill);
  read_size(reading, values, label, fill);
  if (values.has("material"))
    fill.material = find_material(draft, values.text("material"), values.place_of("material"), label).value_or(0);
  if (values.has("region.box.min") && values.has("region.box.max")) {
    fill.region = {values.vec3("region.box.min"), values.vec3("region.box.max")};
    check_box(reading, fill.region.min, fill.region.max, values.place_of("region.box"), label + " region");
  }
  const std::string method = values.has("method") ? values.text("method") : "";
  fill.method = method == "random" ? FillSpec::Method::random
                : method == "pour" ? FillSpec::Method::pour
                                   : FillSpec::Method::lattice;
  read_pouring(reading, values, label, fill);
  fill.seed = static_cast<std::uint64_t>(values.number_or("seed", static_cast<double>(draft.scene.run.seed)));
  if (values.has("velocity")) fill.velocity = values.vec3("velocity");
  fill.velocity_deviation = values.number_or("velocity_deviation", 0.0);
  if (is_of_run) return tell_overruled(draft, fill);
  draft.scene.fills.push_back(std::move(fill));
}

}  // namespace

void read_fills(Draft& draft) {
  each_item(draft.reading, "fill", [&](const Node& item) { read_fill(draft, item); });
}

}  // namespace epafi
