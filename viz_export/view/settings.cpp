#include "viz_export/view/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace epafi {
namespace {

/// A name without line breaks; names come last in their line and may hold blanks.
std::string one_line(std::string name) {
  std::replace(name.begin(), name.end(), '\n', ' ');
  return name;
}

std::string three_numbers(const Vec3& v) { return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z()); }

Vec3 read_three(std::istream& in) {
  Vec3 v = Vec3::Zero();
  in >> v.x() >> v.y() >> v.z();
  return v;
}

std::string rest_of(std::istream& in) {
  std::string text;
  std::getline(in >> std::ws, text);
  return text;
}

std::string view_lines(const ViewSettings& v) {
  std::string out;
  if (!v.preset.empty()) out += "preset " + v.preset + "\n";
  if (v.from) out += "from " + three_numbers(*v.from) + "\n";
  if (v.to) out += "to " + three_numbers(*v.to) + "\n";
  if (!v.up.isZero(0.0)) out += "up " + three_numbers(v.up) + "\n";
  out += fmt::format("angle {:.17g}\n", v.angle);
  if (!v.field.empty()) out += "field " + v.field + "\n";
  if (v.range) out += fmt::format("range {:.17g} {:.17g}\n", (*v.range)[0], (*v.range)[1]);
  return out;
}

void read_spring(std::istream& in, RunAbout& out) {
  RunAbout::Spring spring;
  std::int64_t to = -1;
  in >> spring.body >> to;
  if (to >= 0) spring.to = static_cast<std::uint32_t>(to);
  spring.attachment = read_three(in);
  spring.name = rest_of(in);
  out.springs.push_back(std::move(spring));
}

void read_entry(const std::string& key, std::istream& in, RunAbout& out) {
  ViewSettings& view = out.view;
  if (key == "material") {
    out.materials.push_back(rest_of(in));
  } else if (key == "group") {
    RunAbout::Group group;
    in >> group.first >> group.count;
    group.name = rest_of(in);
    out.groups.push_back(std::move(group));
  } else if (key == "spring") {
    read_spring(in, out);
  } else if (key == "gravity") {
    out.gravity = read_three(in);
  } else if (key == "duration") {
    in >> out.duration;
  } else if (key == "preset") {
    view.preset = rest_of(in);
  } else if (key == "from") {
    view.from = read_three(in);
  } else if (key == "to") {
    view.to = read_three(in);
  } else if (key == "up") {
    view.up = read_three(in);
  } else if (key == "angle") {
    in >> view.angle;
  } else if (key == "field") {
    view.field = rest_of(in);
  } else if (key == "range") {
    std::array<double, 2> range{};
    in >> range[0] >> range[1];
    view.range = range;
  }
}

}  // namespace

std::string to_text(const RunAbout& about) {
  std::string out;
  for (const std::string& name : about.materials) out += "material " + one_line(name) + "\n";
  for (const auto& g : about.groups) out += fmt::format("group {} {} {}\n", g.first, g.count, one_line(g.name));
  for (const auto& s : about.springs) {
    const std::int64_t to = s.to ? static_cast<std::int64_t>(*s.to) : -1;
    out += fmt::format("spring {} {} {} {}\n", s.body, to, three_numbers(s.attachment), one_line(s.name));
  }
  out += "gravity " + three_numbers(about.gravity) + "\n";
  if (about.duration > 0) out += fmt::format("duration {:.17g}\n", about.duration);
  return out + view_lines(about.view);
}

RunAbout about_from_text(const std::string& text) {
  RunAbout out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line);
    std::string key;
    in >> key;
    read_entry(key, in, out);
  }
  return out;
}

}  // namespace epafi
