/// @file render_labels.cpp  What is written on a picture: title, time, and what the colours mean.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "viz_export/view/render_run.h"

namespace epafi {
namespace {

/// The text, truncated with dots where it is too wide.
std::string fitting(std::string text, double size, double width) {
  if (text_width(text, size) <= width) return text;
  while (!text.empty() && text_width(text + "...", size) > width) {
    while (text.size() > 1 && (static_cast<unsigned char>(text.back()) & 0xC0) == 0x80) text.pop_back();  // of UTF-8
    text.pop_back();
  }
  return text + "...";
}

constexpr double see_through = 0.8;  ///< of plates: letters stay apart from any body behind them

struct PlatePlace {
  double left, top, width, height;  ///< [pixels]
};

/// Background of a label.
void add_plate(Image& image, const PlatePlace& place, double opacity) {
  const int left = static_cast<int>(place.left), top = static_cast<int>(place.top);
  for (int y = top; y < top + static_cast<int>(place.height); ++y)
    for (int x = left; x < left + static_cast<int>(place.width); ++x) image.blend(x, y, paper, opacity);
}

/// Label of an end of the colour bar; ">= 5" where values beyond it differ in the digits shown.
std::string end_text(const BarValues& bar, std::size_t end, int most_digits) {
  const std::string text = short_number(bar.range[end], most_digits);
  const bool is_beyond = end == 0 ? bar.extremes[0] < bar.range[0] : bar.extremes[1] > bar.range[1];
  if (!is_beyond || short_number(bar.extremes[end]) == short_number(bar.range[end])) return text;
  return (end == 0 ? "<= " : ">= ") + text;
}

std::vector<PlacedText> placed(const std::vector<std::string>& ticks, double width, double size) {
  std::vector<PlacedText> out;
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    const double place = ticks.size() > 1 ? static_cast<double>(k) / static_cast<double>(ticks.size() - 1) : 0.0;
    out.push_back({ticks[k], place * (width - text_width(ticks[k], size))});
  }
  return out;
}

bool run_together(const std::vector<PlacedText>& ticks, double size) {
  for (std::size_t k = 0; k + 1 < ticks.size(); ++k)
    if (ticks[k].left + text_width(ticks[k].text, size) + 0.8 * size > ticks[k + 1].left) return true;
  return false;
}

}  // namespace

std::vector<std::string> range_ticks(const BarValues& bar, int most_digits) {
  const std::string low = end_text(bar, 0, most_digits), high = end_text(bar, 1, most_digits);
  if (bar.range[0] == bar.range[1]) {
    const std::string only = short_number(bar.range[0], most_digits);
    return {(low == only && high == only ? "all " : "most ") + only};
  }
  const double middle = 0.5 * (bar.range[0] + bar.range[1]);
  if (bar.whole && middle != std::round(middle)) return {low, high};
  return {low, short_number(middle, most_digits), high};
}

std::vector<PlacedText> placed_ticks(const BarValues& bar, double width, double size) {
  std::vector<PlacedText> out;
  for (const bool with_middle : {true, false})
    for (const int digits : {4, 3}) {
      out = placed(range_ticks(bar, digits), width, size);
      if (!with_middle && out.size() > 2) out.erase(out.begin() + 1);
      if (!run_together(out, size)) return out;
    }
  return out;
}

void RunPainter::label(Image& image, const ViewFrame& frame) const {
  const double size = std::max(10.0, options_.letters * options_.height);
  const double left = 0.9 * size;
  const std::string title = options_.title ? fitting(source_.title(), 1.25 * size, image.width - 2 * left) : "";
  std::string below = "t = " + time_text(source_.times(), frame.time) + " s";
  if (const std::string strays = outside_text(outside(frame)); !strays.empty()) below += ", " + strays;
  if (const std::string stop = source_.stop_text(); !stop.empty()) below += ", " + stop;
  below = fitting(below, size, image.width - 2 * left);
  const double widest = std::max(text_width(title, 1.25 * size), text_width(below, size)),
               rows = options_.title ? 3.1 : 1.7;
  add_plate(image, {0.4 * size, 0.4 * size, widest + size, rows * size}, see_through);
  draw_text(image, left, 1.7 * size, title, 1.25 * size, ink);
  draw_text(image, left, rows * size, below, size, ink);
  if (field_.kind == ViewField::Kind::category && !options_.contacts)
    kinds(image, size);
  else
    colour_bar(image, size);
}

/// Legend: colour and name of each kind of body, from the top.
void RunPainter::kinds(Image& image, double size) const {
  constexpr std::size_t most = 8;
  const std::vector<std::size_t> all = kinds_shown();
  const std::size_t named = all.size() > most ? most - 1 : all.size();
  const int side = static_cast<int>(0.8 * size), x = static_cast<int>(0.9 * size);
  const double room = 0.4 * image.width;
  std::vector<std::string> names;
  for (std::size_t k = 0; k < named; ++k) names.push_back(fitting(kind_name(all[k]), size, room));
  if (named < all.size()) names.push_back(fmt::format("and {} more", all.size() - named));
  if (all.size() > kinds_apart) names.push_back(fmt::format("({} colours, which repeat)", kinds_apart));
  double widest = text_width(field_.label, size);
  for (const std::string& name : names) widest = std::max(widest, 1.4 * side + text_width(name, size));
  const double rows = 1.0 + static_cast<double>(names.size());
  const int high = static_cast<int>(1.3 * size * rows + 0.6 * size), edge = static_cast<int>(0.4 * size);
  fill_box(image, x - edge, image.height - high - edge, static_cast<int>(widest) + 2 * edge, high, paper);
  double y = image.height - 1.2 * size - 1.3 * size * (rows - 1);
  draw_text(image, x, y, field_.label, size, ink);
  for (std::size_t k = 0; k < names.size(); ++k) {
    y += 1.3 * size;
    if (k < named) fill_box(image, x, static_cast<int>(y) - side, side, side, kind_colour(all[k]));
    draw_text(image, x + 1.4 * side, y, names[k], size, ink);
  }
}

std::vector<std::size_t> RunPainter::kinds_shown() const {
  std::set<std::size_t> seen;
  for (const BodyRecord& b : source_.bodies())
    seen.insert(field_.name == "material" ? b.material : group_of(source_.about(), b.id));
  return {seen.begin(), seen.end()};
}

std::string RunPainter::unwritable() const {
  if (!options_.labels) return {};
  std::string text = options_.title ? source_.title() : "";
  if (field_.kind == ViewField::Kind::category)
    for (const std::size_t kind : kinds_shown()) text += kind_name(kind);
  return without_outline(text);
}

std::string RunPainter::kind_name(std::size_t kind) const {
  const RunAbout& about = source_.about();
  if (field_.name == "material")
    return kind < about.materials.size() ? about.materials[kind] : "material " + std::to_string(kind);
  if (kind >= about.groups.size()) return "others";
  const auto& group = about.groups[kind];
  return group.name.empty() ? fmt::format("bodies from {} on", group.first) : group.name;
}

/// Colour bar at the lower left; text only where nothing is coloured.
void RunPainter::colour_bar(Image& image, double size) const {
  const bool forces = options_.contacts;
  const std::string unit = forces ? "N" : field_.unit, quantity = forces ? "contact force" : field_.label;
  const std::string name = unit.empty() ? quantity : quantity + " [" + unit + "]";
  const int width = static_cast<int>(13 * size), height = static_cast<int>(0.8 * size);
  const int x = static_cast<int>(0.9 * size), y = image.height - static_cast<int>(2.6 * size);
  const bool some = forces ? overview_.strongest > 0 : range_.has_value();
  if (!some) {
    const std::string text = quantity + (forces ? ": no contacts" : ": no free bodies");
    add_plate(image, {x - 0.5 * size, y - 0.6 * size, text_width(text, size) + size, 1.8 * size}, see_through);
    draw_text(image, x, y + height, text, size, ink);
    return;
  }
  std::vector<PlacedText> ticks = placed_ticks(bar_values(), width, 0.9 * size);
  if (resting_ && !forces)
    ticks = {
        {(field_.name == "residual" ? "rounding" : "at rest") + (": 98 % below " + short_number(range_->back())), 0.0}};
  const double widest = std::max({1.0 * width, text_width(name, size), text_width(ticks.front().text, 0.9 * size)});
  add_plate(image, {x - 0.5 * size, y - 1.6 * size, widest + size, image.height - 0.3 * size - (y - 1.6 * size)},
            see_through);
  draw_text(image, x, y - 0.5 * size, name, size, ink);
  for (int k = 0; k < width; ++k) {
    const double share = ticks.size() > 1 ? (k + 0.5) / width : only_share;
    fill_box(image, x + k, y, 1, height, forces ? inferno(0.15 + 0.75 * share) : viridis(share));
  }
  for (const PlacedText& tick : ticks)
    draw_text(image, x + tick.left, y + height + 1.1 * size, tick.text, 0.9 * size, ink);
}

BarValues RunPainter::bar_values() const {
  if (options_.contacts) return {{0, overview_.strongest}, {0, overview_.strongest_of_all}, false};
  const auto extremes = overview_.extremes.find(field_.name);
  return {*range_, extremes == overview_.extremes.end() ? *range_ : extremes->second, field_.whole};
}

}  // namespace epafi
