#include "scenes/shape_text.h"

#include <fmt/format.h>

#include <filesystem>

#include "scenes/reader/toml_text.h"

namespace epafi {

namespace {

std::string toml_number(double v) {
  const std::string text = fmt::format("{}", v);  // the shortest that gives the same number
  return text;
}

std::string toml_triple(const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

template <class T, class F>
std::string toml_list(const std::vector<T>& items, const F& one) {
  std::string all;
  for (const T& item : items) all += (all.empty() ? "" : ", ") + one(item);
  return "[" + all + "]";
}

/// Four numbers behind each other are one row: [[x, y, z, r], ...].
std::string rows_of_four(const std::vector<double>& v) {
  std::string all;
  for (std::size_t k = 0; k + 3 < v.size(); k += 4)
    all += fmt::format("{}[{}, {}, {}, {}]", k > 0 ? ", " : "", v[k], v[k + 1], v[k + 2], v[k + 3]);
  return "[" + all + "]";
}

struct ToToml {
  const std::string& key;
  std::string operator()(double v) const { return toml_number(v); }
  std::string operator()(bool v) const { return v ? "true" : "false"; }
  std::string operator()(const std::string& v) const {
    return quote_toml(key == "file" ? std::filesystem::absolute(v).string() : v);
  }
  std::string operator()(const Vec3& v) const { return toml_triple(v); }
  std::string operator()(const std::vector<double>& v) const {
    return key == "spheres" ? rows_of_four(v) : toml_list(v, toml_number);
  }
  std::string operator()(const std::vector<Vec3>& v) const { return toml_list(v, toml_triple); }
  std::string operator()(const std::vector<std::string>& v) const { return toml_list(v, quote_toml); }
};

}  // namespace

std::string shape_text(const ShapeSpec& shape) {
  if (!shape.name.empty()) return shape.name;
  std::string inner;
  for (const auto& [key, value] : shape.parameters.all()) {
    if (shape.type == "solid" && key == "tree") continue;  // of a mesh that was written where a body moves
    inner += (inner.empty() ? "" : ", ") + key + " = " + std::visit(ToToml{key}, value);
  }
  std::string out = "{ " + shape.type + " = { " + inner + " }";
  if (shape.scale_to_diameter) out += ", scale_to_diameter = " + toml_number(*shape.scale_to_diameter);
  if (shape.rounding > 0.0) out += ", rounding = " + toml_number(shape.rounding);
  return out + " }";
}

}  // namespace epafi
