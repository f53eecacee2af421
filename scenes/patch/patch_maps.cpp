#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "laws/wheel_rail/fem/elastic_block.h"
#include "scenes/patch/evaluate_patch.h"
#include "viz_export/files/side_file.h"
#include "viz_export/report/html_text.h"

namespace epafi {
namespace {

constexpr double least_width = 240.0, letter = 7.5;  // of a picture, and of a letter in it at most, in the mean

/// Stick 1, slip 2, outside 0.
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

/// Lines of so many characters at most, where words let it.
std::vector<std::string> broken(const std::string& text, std::size_t most) {
  std::vector<std::string> out;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (out.empty() || out.back().size() + 1 + word.size() > most)
      out.push_back(word);
    else
      out.back() += " " + word;
  }
  return out;
}

/// Where the patch sticks (dark) and slips (light), the tractions as lines from dots, at most 24 in a row; x to the
/// right is forwards, y down to the right of the track.
std::string svg_of(const TractionMap& m, const std::string& title) {
  const Image g = image_of(m);
  const double wide = static_cast<double>(g.nx) * g.dx, high = static_cast<double>(g.ny) * g.dy;
  const double scale = 640.0 / std::max(wide, high), cw = g.dx * scale, ch = g.dy * scale, margin = 24.0;
  double most = 0.0;
  for (std::size_t k = 0; k < m.x.size(); ++k) most = std::max(most, std::hypot(m.traction_x[k], m.traction_y[k]));
  std::string cells, arrows;
  const std::size_t each = std::max<std::size_t>(1, std::max(g.nx, g.ny) / 24);
  for (std::size_t c = 0; c < g.source.size(); ++c) {
    if (g.source[c] < 0) continue;
    const auto k = static_cast<std::size_t>(g.source[c]);
    const std::size_t i = c % g.nx, j = c / g.nx;
    const double x = margin + static_cast<double>(i) * cw, y = margin + static_cast<double>(j) * ch;
    cells += fmt::format("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" class=\"{}\"/>\n", x, y,
                         cw + 0.3, ch + 0.3, state_of(m, k) == 1 ? "stick" : "slip");
    if (i % each || j % each || !(most > 0.0)) continue;
    const double length = 0.9 * static_cast<double>(each) * std::max(cw, ch) / most;
    arrows += fmt::format(
        "<circle cx=\"{0:.2f}\" cy=\"{1:.2f}\" r=\"1.5\"/><line x1=\"{0:.2f}\" y1=\"{1:.2f}\" x2=\"{2:.2f}\" "
        "y2=\"{3:.2f}\"/>\n",
        x + 0.5 * cw, y + 0.5 * ch, x + 0.5 * cw + length * m.traction_x[k], y + 0.5 * ch + length * m.traction_y[k]);
  }
  const std::string caption =
      fmt::format("x (forwards) to the right; stick dark, slip light; longest traction {:.3g} MPa; {:.3g} by {:.3g} mm",
                  1e-6 * most, 1e3 * wide, 1e3 * high);
  const double width = std::max(least_width, wide * scale + 2.0 * margin);
  const std::vector<std::string> lines = broken(caption, static_cast<std::size_t>((width - 2.0 * margin) / letter));
  std::string text;
  for (std::size_t k = 0; k < lines.size(); ++k)
    text += fmt::format("<text x=\"{}\" y=\"{:.0f}\">{}</text>\n", margin,
                        high * scale + 2.0 * margin + 10.0 + 17.0 * static_cast<double>(k), lines[k]);
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
             "font-family=\"sans-serif\" "
             "font-size=\"13\">\n<title>{2}</"
             "title>\n<style>.stick{{fill:#30638e}}.slip{{fill:#f4c98a}}line{{stroke:#111;stroke-width:1.2}}"
             "</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
             width, high * scale + 2.0 * margin + 7.0 + 17.0 * static_cast<double>(lines.size()), html_escaped(title)) +
         cells + arrows + text + "</svg>\n";
}

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
  write_whole_file(std::filesystem::path(folder) / "patch.csv", {patch_csv(results)});
  for (const auto& r : results) {
    for (std::size_t k = 0; k < r.contacts.size(); ++k) {
      if (const auto& inside = r.contacts[k].stress)
        write_whole_file(std::filesystem::path(folder) / (r.normal + "_stress.vtr"), {vtr_of(*inside)});
      const TractionMap& m = r.contacts[k].map;
      if (m.x.empty()) continue;  // a closed form has no map
      const std::string name = r.normal + "_" + r.tangential + (r.contacts.size() > 1 ? "_" + std::to_string(k) : "");
      write_whole_file(std::filesystem::path(folder) / (name + ".csv"), {csv_of(m)});
      write_whole_file(std::filesystem::path(folder) / (name + ".vti"), {vti_of(m)});
      write_whole_file(std::filesystem::path(folder) / (name + ".svg"), {svg_of(m, title)});
    }
  }
}

}  // namespace epafi
