#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <tuple>

#include "laws/wheel_rail/fem/elastic_block.h"
#include "scenes/patch/evaluate_patch.h"
#include "viz_export/files/side_file.h"
#include "viz_export/report/html_text.h"

namespace epafi {
namespace {

constexpr double least_width = 400.0;  // of a picture: its legend has room

/// 1: stick, 2: slip; 0 outside the patch.
int state_of(const TractionMap& m, std::size_t k) { return m.sticks[k] ? 1 : 2; }

std::string csv_of(const TractionMap& m) {
  std::string out = "x,y,pressure,traction_x,traction_y,";
  out += m.knows_slip() ? "slip_x,slip_y,state\n" : "state\n";
  for (std::size_t k = 0; k < m.x.size(); ++k) {
    out += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},", m.x[k], m.y[k], m.pressure[k], m.traction_x[k],
                       m.traction_y[k]);
    if (m.knows_slip()) out += fmt::format("{:.9g},{:.9g},", m.slip_x[k], m.slip_y[k]);
    out += fmt::format("{}\n", state_of(m, k));
  }
  return out;
}

/// Image of n by n cells over the box of the points; each cell shows the nearest point of its row, 0 outside the patch.
struct Image {
  std::size_t nx = 0, ny = 0;
  double x0 = 0, y0 = 0, dx = 0, dy = 0;
  std::vector<std::ptrdiff_t> source;  ///< point of each cell, < 0 outside
};

Image image_of(const TractionMap& m) {
  Image g;
  std::vector<double> rows = m.y;
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  g.ny = rows.size();
  const auto [left, right] = std::minmax_element(m.x.begin(), m.x.end());
  std::vector<std::vector<std::size_t>> by_row(g.ny);
  for (std::size_t k = 0; k < m.x.size(); ++k)
    by_row[static_cast<std::size_t>(std::lower_bound(rows.begin(), rows.end(), m.y[k]) - rows.begin())].push_back(k);
  for (auto& row : by_row) {
    std::sort(row.begin(), row.end(), [&](std::size_t a, std::size_t b) { return m.x[a] < m.x[b]; });
    g.nx = std::max(g.nx, row.size());
  }
  g.dx = g.nx > 1 ? (*right - *left) / static_cast<double>(g.nx - 1) : 1e-6;
  g.dy = g.ny > 1 ? (rows.back() - rows.front()) / static_cast<double>(g.ny - 1) : g.dx;
  g.x0 = *left - 0.5 * g.dx;
  g.y0 = rows.front() - 0.5 * g.dy;
  g.source.assign(g.nx * g.ny, -1);
  for (std::size_t j = 0; j < g.ny; ++j) {
    const auto& row = by_row[j];
    const double half =
        row.size() > 1 ? 0.5 * (m.x[row.back()] - m.x[row.front()]) / static_cast<double>(row.size() - 1) : 0.5 * g.dx;
    for (std::size_t i = 0; i < g.nx; ++i) {
      const double x = g.x0 + (static_cast<double>(i) + 0.5) * g.dx;
      const auto near = std::min_element(row.begin(), row.end(), [&](std::size_t a, std::size_t b) {
        return std::abs(m.x[a] - x) < std::abs(m.x[b] - x);
      });
      if (near != row.end() && std::abs(m.x[*near] - x) <= 1.001 * half)
        g.source[j * g.nx + i] = static_cast<std::ptrdiff_t>(*near);
    }
  }
  return g;
}

/// VTK XML ImageData, cell data, ASCII: a patch has some thousand cells.
std::string vti_of(const TractionMap& m) {
  const Image g = image_of(m);
  std::string out = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
      "<ImageData WholeExtent=\"0 {0} 0 {1} 0 0\" Origin=\"{2:.9g} {3:.9g} 0\" Spacing=\"{4:.9g} {5:.9g} 1\">\n"
      "<Piece Extent=\"0 {0} 0 {1} 0 0\">\n<CellData Scalars=\"pressure\" Vectors=\"traction\">\n",
      g.nx, g.ny, g.x0, g.y0, g.dx, g.dy);
  const auto array = [&](const char* type, const char* name, int components, auto&& value) {
    out += fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n", type, name,
                       components);
    for (const std::ptrdiff_t k : g.source) out += value(k);
    out += "\n</DataArray>\n";
  };
  const auto at = [](const std::vector<double>& v, std::ptrdiff_t k) {
    return k < 0 ? 0.0 : v[static_cast<std::size_t>(k)];
  };
  array("Float64", "pressure", 1, [&](std::ptrdiff_t k) { return fmt::format("{:.9g} ", at(m.pressure, k)); });
  array("Float64", "traction", 3,
        [&](std::ptrdiff_t k) { return fmt::format("{:.9g} {:.9g} 0 ", at(m.traction_x, k), at(m.traction_y, k)); });
  if (m.knows_slip())
    array("Float64", "slip", 3,
          [&](std::ptrdiff_t k) { return fmt::format("{:.9g} {:.9g} 0 ", at(m.slip_x, k), at(m.slip_y, k)); });
  array("Int32", "state", 1, [&](std::ptrdiff_t k) {
    return k < 0 ? std::string("0 ") : fmt::format("{} ", state_of(m, static_cast<std::size_t>(k)));
  });
  return out + "</CellData>\n</Piece>\n</ImageData>\n</VTKFile>\n";
}

/// 1/10, 1/5 or 1/2 of a power of ten, so that the length has about five ticks.
double tick_step(double length) {
  const double raw = length / 5.0, power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= raw) return factor * power;
  return 10.0 * power;
}

/// The picture of a patch: cells of an image, axes in millimetres, and what the colours and the lines mean.
class PatchPicture {
 public:
  PatchPicture(const TractionMap& m, const std::string& title) : m_(m), title_(title), g_(image_of(m)) {
    wide_ = static_cast<double>(g_.nx) * g_.dx;
    high_ = static_cast<double>(g_.ny) * g_.dy;
    scale_ = longest_side / std::max(wide_, high_);
    for (std::size_t k = 0; k < m.x.size(); ++k) most_ = std::max(most_, std::hypot(m.traction_x[k], m.traction_y[k]));
  }

  std::string svg() {
    cells();
    frame();
    axis(true);
    axis(false);
    legend();
    const double width = left + std::max(least_width, wide_ * scale_) + right,
                 height = top + high_ * scale_ + below + legend_row * static_cast<double>(rows_);
    return fmt::format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
               "{1:.0f}\" font-family=\"sans-serif\" font-size=\"15\">\n<title>{2}</title>\n<style>.stick{{fill:"
               "#30638e}}.slip{{fill:#f4c98a}}.traction line{{stroke:#111;stroke-width:1.2}}.axes line{{stroke:#444}}"
               "</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
               width, height, html_escaped(title_)) +
           body_ + "</svg>\n";
  }

 private:
  static constexpr double longest_side = 640.0, left = 76.0, right = 40.0, top = 18.0, below = 56.0, legend_row = 24.0;

  double px(double x) const { return left + (x - g_.x0) * scale_; }
  double py(double y) const { return top + (y - g_.y0) * scale_; }

  /// Draws stick (dark) and slip (light), and tractions as lines from dots, at most 24 in a row.
  void cells() {
    const double cw = g_.dx * scale_, ch = g_.dy * scale_;
    const std::size_t each = std::max<std::size_t>(1, std::max(g_.nx, g_.ny) / 24);
    longest_line_ = 0.9 * static_cast<double>(each) * std::max(cw, ch);
    std::string arrows;
    for (std::size_t c = 0; c < g_.source.size(); ++c) {
      if (g_.source[c] < 0) continue;
      const auto k = static_cast<std::size_t>(g_.source[c]);
      const std::size_t i = c % g_.nx, j = c / g_.nx;
      const double x = left + static_cast<double>(i) * cw, y = top + static_cast<double>(j) * ch;
      const bool sticks = state_of(m_, k) == 1;
      (sticks ? sticking_ : slipping_) += 1;
      body_ += fmt::format("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" class=\"{}\"/>\n", x, y,
                           cw + 0.3, ch + 0.3, sticks ? "stick" : "slip");
      if (i % each || j % each || !(most_ > 0.0)) continue;
      arrows += traction(x + 0.5 * cw, y + 0.5 * ch, m_.traction_x[k] / most_, m_.traction_y[k] / most_);
    }
    body_ += "<g class=\"traction\">\n" + arrows + "</g>\n";
  }

  /// share: relative to the largest traction.
  std::string traction(double x, double y, double share_x, double share_y) const {
    return fmt::format(
        "<circle cx=\"{0:.2f}\" cy=\"{1:.2f}\" r=\"1.5\"/><line x1=\"{0:.2f}\" y1=\"{1:.2f}\" x2=\"{2:.2f}\" "
        "y2=\"{3:.2f}\"/>\n",
        x, y, x + longest_line_ * share_x, y + longest_line_ * share_y);
  }

  void frame() {
    body_ += fmt::format(
        "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"none\" stroke=\"#444\"/>\n", left,
        top, wide_ * scale_, high_ * scale_);
  }

  /// x to the right is forwards, y down to the right of the track.
  void axis(bool is_x) {
    const double from = 1e3 * (is_x ? g_.x0 : g_.y0), to = from + 1e3 * (is_x ? wide_ : high_),
                 step = tick_step(1e3 * std::max(wide_, high_));
    const double bottom = top + high_ * scale_;
    body_ += "<g class=\"axes\">\n";
    for (double k = std::ceil(from / step); k * step <= to; ++k) {
      const double at = is_x ? px(1e-3 * k * step) : py(1e-3 * k * step);
      const std::string text = fmt::format("{:.6g}", k == 0.0 ? 0.0 : k * step);
      if (is_x)
        body_ += fmt::format(
            "<line x1=\"{0:.2f}\" y1=\"{1:.2f}\" x2=\"{0:.2f}\" y2=\"{2:.2f}\"/><text x=\"{0:.2f}\" y=\"{3:.2f}\" "
            "text-anchor=\"middle\">{4}</text>\n",
            at, bottom, bottom + 5, bottom + 21, text);
      else
        body_ += fmt::format(
            "<line x1=\"{1:.2f}\" y1=\"{0:.2f}\" x2=\"{2:.2f}\" y2=\"{0:.2f}\"/><text x=\"{3:.2f}\" y=\"{4:.2f}\" "
            "text-anchor=\"end\">{5}</text>\n",
            at, left - 5, left, left - 8, at + 5, text);
    }
    if (is_x)
      body_ += fmt::format("<text x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"middle\">x, forwards [mm]</text>\n",
                           left + 0.5 * wide_ * scale_, bottom + 42);
    else if (names_y())
      body_ += fmt::format(
          "<text transform=\"translate(18 {:.2f}) rotate(-90)\" text-anchor=\"middle\">y, to the right, down "
          "[mm]</text>\n",
          top + 0.5 * high_ * scale_);
    body_ += "</g>\n";
  }

  /// True where the axis has room for its name.
  bool names_y() const { return high_ * scale_ > 200.0; }

  void legend_line(const std::string& mark, const std::string& text) {
    const double y = top + high_ * scale_ + below + legend_row * static_cast<double>(rows_++);
    body_ += fmt::format("<g transform=\"translate({:.2f} {:.2f})\">{}<text x=\"40\" y=\"13\">{}</text></g>\n", left, y,
                         mark, text);
  }

  /// Legend of the items drawn.
  void legend() {
    if (!names_y()) legend_line("", "downwards: y, to the right [mm]");
    const double all = std::max(1.0, static_cast<double>(sticking_ + slipping_));
    for (const auto& [name, word, count] :
         {std::tuple{"stick", "sticks", sticking_}, std::tuple{"slip", "slips", slipping_}})
      if (count > 0)
        legend_line(fmt::format("<rect width=\"26\" height=\"16\" class=\"{}\"/>", name),
                    fmt::format("{}: {:.0f} % of the patch", word, 100.0 * static_cast<double>(count) / all));
    if (!(most_ > 0.0)) return legend_line("", "no traction");
    legend_line("<g class=\"traction\">" + traction(4, 8, 1, 0) + "</g>",
                fmt::format("largest traction on the rail: {:.3g} MPa", 1e-6 * most_));
  }

  const TractionMap& m_;
  const std::string& title_;
  Image g_;
  double wide_ = 0, high_ = 0, scale_ = 1, most_ = 0, longest_line_ = 0;
  std::size_t sticking_ = 0, slipping_ = 0, rows_ = 0;
  std::string body_;
};

/// VTK XML RectilinearGrid: the graded block with displacements at nodes, stresses and their equivalent in elements.
std::string vtr_of(const BlockStress& b) {
  const auto last = [](const std::vector<double>& v) { return v.size() - 1; };
  const std::string extent = fmt::format("0 {} 0 {} 0 {}", last(b.mesh.x), last(b.mesh.y), last(b.mesh.z));
  std::string out =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"RectilinearGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n";
  out += "<RectilinearGrid WholeExtent=\"" + extent + "\">\n<Piece Extent=\"" + extent + "\">\n";
  const auto open = [&](const char* name, int components) {
    out += fmt::format("<DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n", name,
                       components);
  };
  const char* close = "\n</DataArray>\n";
  out += "<PointData Vectors=\"displacement\">\n";
  open("displacement", 3);
  for (const auto& u : b.displacement) out += fmt::format("{:.6g} {:.6g} {:.6g} ", u[0], u[1], u[2]);
  out += close;
  out += "</PointData>\n<CellData Scalars=\"von_mises\">\n";
  open("von_mises", 1);
  for (std::size_t e = 0; e < b.stress.size(); ++e) out += fmt::format("{:.6g} ", b.von_mises(e));
  out += close;
  open("stress", 6);  // VTK's order of a symmetric tensor: xx yy zz xy yz xz
  for (const auto& t : b.stress)
    out += fmt::format("{:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} ", t[0], t[1], t[2], t[5], t[3], t[4]);
  out += close;
  out += "</CellData>\n<Coordinates>\n";
  for (const auto* axis : {&b.mesh.x, &b.mesh.y, &b.mesh.z}) {
    open("axis", 1);
    for (const double v : *axis) out += fmt::format("{:.9g} ", v);
    out += close;
  }
  return out + "</Coordinates>\n</Piece>\n</RectilinearGrid>\n</VTKFile>\n";
}

}  // namespace

void write_patch_maps(const std::string& folder, const std::vector<PatchResult>& results, const std::string& title) {
  std::filesystem::create_directories(folder);
  write_whole_file(std::filesystem::path(folder) / "patch.csv", {patch_csv(results, true)});
  for (const auto& r : results) {
    for (std::size_t k = 0; k < r.contacts.size(); ++k) {
      if (const auto& inside = r.contacts[k].stress)
        write_whole_file(std::filesystem::path(folder) / (r.normal + "_stress.vtr"), {vtr_of(*inside)});
      const TractionMap& m = r.contacts[k].map;
      if (m.x.empty()) continue;  // a closed form has no map
      const std::string name = r.normal + "_" + r.tangential + (r.contacts.size() > 1 ? "_" + std::to_string(k) : "");
      write_whole_file(std::filesystem::path(folder) / (name + ".csv"), {csv_of(m)});
      write_whole_file(std::filesystem::path(folder) / (name + ".vti"), {vti_of(m)});
      write_whole_file(std::filesystem::path(folder) / (name + ".svg"), {PatchPicture(m, title).svg()});
    }
  }
}

}  // namespace epafi
