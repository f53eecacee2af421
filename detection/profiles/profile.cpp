#include "detection/profiles/profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <sstream>

#include "engine/units/units.h"

namespace epafi {
namespace {

/// Symmetric band of half-width 2: solves by L D L^T without pivots (positive definite).
struct Pentadiagonal {
  std::vector<double> d, e, f;  ///< diagonal, first and second above it
  explicit Pentadiagonal(std::size_t n) : d(n, 0.0), e(n, 0.0), f(n, 0.0) {}
  std::vector<double> solve(std::vector<double> b) {
    const std::size_t n = d.size();
    std::vector<double> l1(n, 0.0), l2(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      // d_i holds the pivot; rows i + 1 and i + 2 are cleared
      l1[i] = i + 1 < n ? e[i] / d[i] : 0.0;
      l2[i] = i + 2 < n ? f[i] / d[i] : 0.0;
      if (i + 1 < n) {
        d[i + 1] -= l1[i] * e[i];
        e[i + 1] -= i + 2 < n ? l1[i] * f[i] : 0.0;
      }
      if (i + 2 < n) d[i + 2] -= l2[i] * f[i];
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (i + 1 < n) b[i + 1] -= l1[i] * b[i];
      if (i + 2 < n) b[i + 2] -= l2[i] * b[i];
    }
    for (std::size_t i = n; i-- > 0;) {
      b[i] /= d[i];
      if (i + 1 < n) b[i] -= l1[i] * b[i + 1];
      if (i + 2 < n) b[i] -= l2[i] * b[i + 2];
    }
    return b;
  }
};

/// Share of smoothing at each point: the bending that counts is curvature along the profile, z'' / (1 + z'^2)^(3/2), or
/// a flank of 1:20 would be bent aside before anything of the tread's noise is taken away.
std::vector<double> shares_of_smoothing(const ProfilePoints& p) {
  const std::size_t n = p.y.size();
  std::vector<double> out(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t a = k > 0 ? k - 1 : k, b = k + 1 < n ? k + 1 : k;
    const double slope = (p.z[b] - p.z[a]) / (p.y[b] - p.y[a]), square = 1.0 + slope * slope;
    out[k] = 1.0 / (square * square * square);
  }
  return out;
}

/// Second derivatives g at the inner knots and fitted values of the smoothing spline with shares s: (R + lambda Q^T S
/// Q) g = Q^T z, f = z - lambda S Q g.
struct Fit {
  std::vector<double> value, second;
  double rms = 0.0;
};
Fit fit(const ProfilePoints& p, double lambda, const std::vector<double>& share) {
  const std::size_t n = p.y.size(), m = n - 2;
  const auto h = [&](std::size_t k) { return p.y[k + 1] - p.y[k]; };
  Pentadiagonal A(m);
  std::vector<double> b(m);
  const auto q = [&](std::size_t j, int k) {  // column j of Q: rows j, j + 1, j + 2
    return k == 0 ? 1.0 / h(j) : k == 2 ? 1.0 / h(j + 1) : -1.0 / h(j) - 1.0 / h(j + 1);
  };
  for (std::size_t j = 0; j < m; ++j) {
    A.d[j] = (h(j) + h(j + 1)) / 3.0 + lambda * (share[j] * q(j, 0) * q(j, 0) + share[j + 1] * q(j, 1) * q(j, 1) +
                                                 share[j + 2] * q(j, 2) * q(j, 2));
    if (j + 1 < m)
      A.e[j] = h(j + 1) / 6.0 + lambda * (share[j + 1] * q(j, 1) * q(j + 1, 0) + share[j + 2] * q(j, 2) * q(j + 1, 1));
    if (j + 2 < m) A.f[j] = lambda * share[j + 2] * q(j, 2) * q(j + 2, 0);
    b[j] = q(j, 0) * p.z[j] + q(j, 1) * p.z[j + 1] + q(j, 2) * p.z[j + 2];
  }
  const std::vector<double> g = A.solve(b);
  Fit out{p.z, std::vector<double>(n, 0.0), 0.0};
  for (std::size_t j = 0; j < m; ++j) {
    out.second[j + 1] = g[j];
    for (int k = 0; k < 3; ++k) {
      const std::size_t i = j + static_cast<std::size_t>(k);
      out.value[i] -= lambda * share[i] * q(j, k) * g[j];
    }
  }
  for (std::size_t k = 0; k < n; ++k) out.rms += (out.value[k] - p.z[k]) * (out.value[k] - p.z[k]);
  out.rms = std::sqrt(out.rms / static_cast<double>(n));
  return out;
}

}  // namespace

Profile::Profile(const ProfilePoints& points, double tolerance) : y_(points.y) {
  const std::vector<double> share = shares_of_smoothing(points);
  Fit best = fit(points, 0.0, share);
  if (tolerance > 0.0) {
    // the distance grows with lambda: bisection in its logarithm; the mean spacing cubed is the natural scale
    const double spacing = (y_.back() - y_.front()) / static_cast<double>(y_.size());
    double low = std::log(1e-9 * spacing * spacing * spacing), high = low + 60.0;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      Fit trial = fit(points, std::exp(middle), share);
      if (trial.rms <= tolerance) {
        low = middle;
        best = std::move(trial);
      } else
        high = middle;
    }
  }
  z_ = std::move(best.value);
  second_ = std::move(best.second);
  make_index();
}

void Profile::make_index() {
  for (std::size_t k = 0; k + 1 < y_.size(); ++k) {
    const double h = y_[k + 1] - y_[k], s0 = second_[k], s1 = second_[k + 1];
    pieces_.push_back(
        {y_[k], {z_[k], (z_[k + 1] - z_[k]) / h - h / 6.0 * (2.0 * s0 + s1), 0.5 * s0, (s1 - s0) / (6.0 * h)}});
  }
  const std::size_t buckets = 2 * y_.size();
  const double width = (y_.back() - y_.front()) / static_cast<double>(buckets);
  per_bucket_ = 1.0 / width;
  first_.resize(buckets + 1);
  std::uint32_t k = 0;
  for (std::size_t b = 0; b <= buckets; ++b) {
    const double y = y_.front() + static_cast<double>(b) * width;
    while (k + 2 < y_.size() && y_[k + 1] <= y) ++k;
    first_[b] = k;
  }
}

Profile::Value Profile::at(double y) const {
  const double clamped = std::clamp(y, y_.front(), y_.back());
  const auto bucket = static_cast<std::size_t>((clamped - y_.front()) * per_bucket_);
  std::size_t k = first_[std::min(first_.size() - 1, bucket)];
  while (k + 1 < pieces_.size() && pieces_[k + 1].y < clamped) ++k;
  const Piece& p = pieces_[k];
  const double t = clamped - p.y;
  Value v{p.c[0] + t * (p.c[1] + t * (p.c[2] + t * p.c[3])), p.c[1] + t * (2.0 * p.c[2] + t * 3.0 * p.c[3]),
          2.0 * p.c[2] + 6.0 * t * p.c[3]};
  v.z += (y - clamped) * v.slope;
  return v;
}

namespace {

std::string shortened(const std::string& text) {
  constexpr std::size_t most = 40;
  return text.size() > most ? text.substr(0, most) + "..." : text;
}

/// Unit in metres that a comment states, 0 if it states none.
double unit_of_comment(const std::string& line, std::string& problem) {
  const std::size_t colon = line.find("unit:");
  if (colon == std::string::npos) return 0.0;
  const std::size_t word = line.find_first_not_of(" \t", colon + 5);
  const std::string name = word == std::string::npos ? "" : line.substr(word, line.find_last_not_of(" \t") + 1 - word);
  const QuantityResult q = read_quantity("1 " + name, "m");
  if (!q.value) problem = "unit '" + shortened(name) + "': " + q.problem;
  return q.value.value_or(0.0);
}

constexpr const char* between_cells = " \t,;";

/// The first three numbers of a line, separated by comma, semicolon or blanks; the third may be missing (not a number).
struct Row {
  double y = 0.0, z = 0.0, third = 0.0;
};
std::optional<Row> row_of(const std::string& line) {
  std::array<double, 3> value{NAN, NAN, NAN};
  const char* at = line.c_str();
  for (double& v : value) {
    at += std::strspn(at, between_cells);
    char* end = nullptr;
    const double read = std::strtod(at, &end);
    const bool whole = end != at && (*end == '\0' || std::strchr(between_cells, *end) != nullptr);
    if (!whole) break;
    v = read;
    at = end;
  }
  if (!std::isfinite(value[0]) || !std::isfinite(value[1])) return std::nullopt;
  return Row{value[0], value[1], value[2]};
}

/// "-69,9;11,54" and "-69,9 11,54": commas within numbers, which separate them here.
bool has_decimal_commas(const std::string& line) {
  const auto is_digit = [&](std::size_t k) { return k < line.size() && line[k] >= '0' && line[k] <= '9'; };
  bool within = false;
  for (std::size_t k = 1; k < line.size(); ++k) within |= line[k] == ',' && is_digit(k - 1) && is_digit(k + 1);
  const std::size_t first = line.find_first_not_of(" \t"), last = line.find_last_not_of(" \t;");
  if (!within || first == std::string::npos) return false;
  const std::string inner = line.substr(first, last - first + 1);
  return inner.find(';') != std::string::npos ||
         (inner.find_first_of(" \t") != std::string::npos && inner.find(", ") == std::string::npos);
}

/// A line of column names: it begins with no number.
bool is_header(const std::string& line) {
  const char* first = line.c_str() + std::strspn(line.c_str(), between_cells);
  char* end = nullptr;
  std::strtod(first, &end);
  return end == first;
}

/// A line that ends with LF, CR LF or CR, without blanks before it; of the first without a byte order mark.
bool next_profile_line(std::istream& in, std::string& line, int& number) {
  line.clear();
  int c = in.get();
  if (c == std::char_traits<char>::eof()) return false;
  for (; c != std::char_traits<char>::eof() && c != '\n' && c != '\r'; c = in.get()) line += static_cast<char>(c);
  if (c == '\r' && in.peek() == '\n') in.get();
  in.clear();
  if (++number == 1 && line.rfind("\xef\xbb\xbf", 0) == 0) line.erase(0, 3);
  line.erase(0, std::min(line.find_first_not_of(" \t"), line.size()));
  return true;
}

/// Rows are numbered by whole numbers one by one, and the second column goes one way: it is the lateral coordinate.
bool counts_rows(const std::vector<Row>& rows) {
  if (rows.size() < 4) return false;
  const bool up = rows[1].z > rows[0].z;
  for (std::size_t k = 1; k < rows.size(); ++k)
    if (rows[k].y != rows[k - 1].y + 1.0 || std::isnan(rows[k].third) || (rows[k].z > rows[k - 1].z) != up)
      return false;
  return rows[0].y == std::floor(rows[0].y);
}

struct WrittenPoint {
  double y, z;  ///< [m]
  int line;
};

constexpr double widest_profile = 0.13;  // of railway wheels and rails [m]

/// In the order of y, points that are one merged; what is wrong with them otherwise, at `line`.
std::string sort_out(std::vector<WrittenPoint>& points, int& line) {
  if (points.size() < 4) return "a profile has at least 4 points, found " + std::to_string(points.size());
  const bool falls = points.front().y > points.back().y;
  if (falls) std::reverse(points.begin(), points.end());
  // joints of zones are often written twice: points nearer than a micrometre in y are one; of a profile in a wrong unit
  // as much of its width, so that its unit is what is told
  const double micrometre = 1e-6 * std::max(1.0, std::abs(points.back().y - points.front().y) / widest_profile);
  const auto one = [&](const WrittenPoint& a, const WrittenPoint& b) {
    return std::abs(a.y - b.y) < micrometre && std::abs(a.z - b.z) < 2.0 * micrometre;
  };
  points.erase(std::unique(points.begin(), points.end(), one), points.end());
  std::vector<std::size_t> turns;  // of two neighbours the later one in the file
  for (std::size_t k = 1; k < points.size(); ++k)
    if (points[k].y <= points[k - 1].y + 1e-9) turns.push_back(falls ? k - 1 : k);
  if (turns.empty()) return "";
  line = points[falls ? turns.back() : turns.front()].line;
  return "y turns back here (" + std::to_string(turns.size()) + " of " + std::to_string(points.size()) +
         " points do): z is a function of y, so write the points in the order of y and leave out what is undercut or "
         "scatters on an upright face";
}

}  // namespace

ProfileFile read_profile(const std::string& text) {
  ProfileFile out;
  std::istringstream in(text);
  double unit = 0.0;
  std::vector<WrittenPoint> points;
  std::vector<Row> rows;
  bool header = true;
  for (std::string line; next_profile_line(in, line, out.line);) {
    if (line.empty()) continue;
    if (line[0] == '#') {
      const double stated = unit_of_comment(line, out.problem);
      if (stated > 0.0 && unit > 0.0 && stated != unit) out.problem = "a second unit, which is not the first";
      if (stated > 0.0) unit = stated;
      if (!out.problem.empty()) return out;
    } else if (unit == 0.0) {
      out.problem = "the first line must state the unit, as in '# unit: mm'";
      return out;
    } else if (has_decimal_commas(line)) {
      out.problem = "decimal commas: write points, as in 12.5, found '" + shortened(line) + "'";
      return out;
    } else if (const auto row = row_of(line)) {
      points.push_back({row->y * unit, row->z * unit, out.line});
      rows.push_back(*row);
    } else if (header && points.empty() && is_header(line)) {
      header = false;  // one line of column names
    } else {
      out.problem = "expected two numbers y, z, found '" + shortened(line) + "'";
      return out;
    }
  }
  if (counts_rows(rows)) {
    out.problem = "the first column numbers the points; the first two columns are y and z: leave the numbers out";
    return out;
  }
  out.problem = sort_out(points, out.line);
  if (!out.problem.empty()) return out;
  for (const WrittenPoint& p : points) {
    out.points.y.push_back(p.y);
    out.points.z.push_back(p.z);
  }
  out.line = 0;
  return out;
}

namespace {

/// Without what stands upright or hangs over: from the highest point outwards as far as the flank is a function of y.
ProfilePoints without_overhang(const ProfilePoints& p) {
  constexpr double upright = 100.0;  // slope: a flank of 0.6 degrees; a spline over steeper pieces swings beside them
  const auto holds = [&](std::size_t k) {
    const double dy = p.y[k + 1] - p.y[k];
    return dy > 0.0 && std::abs(p.z[k + 1] - p.z[k]) < upright * dy;
  };
  const auto top = static_cast<std::size_t>(std::min_element(p.z.begin(), p.z.end()) - p.z.begin());
  std::size_t first = top, last = top;
  while (first > 0 && holds(first - 1)) --first;
  while (last + 1 < p.y.size() && holds(last)) ++last;
  const auto part = [&](const std::vector<double>& v) {
    return std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(first),
                               v.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  };
  return {part(p.y), part(p.z)};
}

}  // namespace

ProfilePoints canted_rail(ProfilePoints p, double cant) {
  const double c = std::cos(cant), s = std::sin(cant);
  for (std::size_t k = 0; k < p.y.size(); ++k) {
    const double y = p.y[k], z = p.z[k];
    p.y[k] = c * y - s * z;
    p.z[k] = s * y + c * z;
  }
  if (cant != 0.0) p = without_overhang(p);
  if (p.y.size() < 4) return p;
  // the highest point of the spline, not of the points: a fine scan and a parabola
  const Profile spline(p);
  double top = *std::min_element(p.z.begin(), p.z.end());
  const double step = (p.y.back() - p.y.front()) / 20000.0;
  for (int k = 0; k <= 20000; ++k) top = std::min(top, spline.at(p.y.front() + k * step).z);
  for (double& z : p.z) z -= top;
  return p;
}

}  // namespace epafi
