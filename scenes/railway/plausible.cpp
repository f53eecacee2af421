#include "scenes/railway/plausible.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace epafi {
namespace {

constexpr double flange = 15e-3;       // what rises more over the tread is one: they are 26 to 36 mm high
constexpr double shortest = 5e-3;      // of all wheels and rails, models of 1:20 included [m]
constexpr double longest = 0.4;        // [m]
constexpr double deep_groove = 14e-3;  // the ends of a rail this far above its middle, both upright: it hangs
constexpr double upright = 3.0;        // slope

double width_of(const ProfilePoints& p) { return p.y.back() - p.y.front(); }

std::size_t at_least(const std::vector<double>& y, double place) {
  return static_cast<std::size_t>(std::lower_bound(y.begin(), y.end() - 1, place) - y.begin());
}

/// Text on a width that no wheel or rail has, as by a wrong unit; empty where it is plausible.
std::string wrong_unit(const ProfilePoints& p) {
  const double width = width_of(p);
  if (width >= shortest && width <= longest) return "";
  return fmt::format("the points span {:.4g} m in y: is the unit of the first line right? ({})", width,
                     width > longest ? "millimetres called m, or an index in the first column" : "metres called mm");
}

/// Slope of the profile's end pieces over 5 % of its width, positive where z grows outwards.
double slope_of_end(const ProfilePoints& p, bool last) {
  const double part = 0.05 * width_of(p);
  const std::size_t n = p.y.size();
  const std::size_t inner = last ? std::min(at_least(p.y, p.y.back() - part), n - 2)
                                 : std::max<std::size_t>(at_least(p.y, p.y.front() + part), 1);
  const std::size_t outer = last ? n - 1 : 0;
  return (p.z[outer] - p.z[inner]) / std::abs(p.y[outer] - p.y[inner]);
}

/// The flange, searched upwards (sign 1) or downwards (-1): its tip [m] and its height over the middle.
struct Flange {
  double tip = 0.0, height = 0.0;
  bool tread_right = true;  ///< more of the profile lies at larger y
};
Flange flange_of(const ProfilePoints& p, double sign) {
  const double middle = sign * p.z[at_least(p.y, 0.5 * (p.y.front() + p.y.back()))];
  Flange out;
  for (std::size_t k = 0; k < p.y.size(); ++k) {
    if (sign * p.z[k] - middle <= out.height) continue;
    out.height = sign * p.z[k] - middle;
    out.tip = p.y[k];
  }
  out.tread_right = p.y.back() - out.tip > out.tip - p.y.front();
  return out;
}

/// Height of the broken line through the points at y = 0.
double height_at_zero(const ProfilePoints& p) {
  const std::size_t k = std::max<std::size_t>(1, at_least(p.y, 0.0));
  const double t = (0.0 - p.y[k - 1]) / (p.y[k] - p.y[k - 1]);
  return p.z[k - 1] + t * (p.z[k] - p.z[k - 1]);
}

/// True where both ends fall off alike, as of a ball or a disc with a round rim.
bool is_round(const ProfilePoints& p, double sign) {
  const double middle = sign * p.z[at_least(p.y, 0.5 * (p.y.front() + p.y.back()))];
  const double left = sign * p.z.front() - middle, right = sign * p.z.back() - middle;
  return std::min(left, right) > 0.5 * std::max(left, right);
}

}  // namespace

ProfileRemarks remarks_on_wheel(const ProfilePoints& p) {
  ProfileRemarks out;
  out.problem = wrong_unit(p);
  if (!out.problem.empty()) return out;
  const Flange up = flange_of(p, 1.0), down = flange_of(p, -1.0);
  if (up.height >= flange) {
    if (!up.tread_right)
      out.problem = fmt::format(
          "the flange (tip at y = {:.4g} m) lies on the field side: y is negative towards the flange; mirror y",
          up.tip);
    else if (up.tip > -0.25 * flange)
      out.problem = fmt::format(
          "the flange's tip lies at y = {:.4g} m: y counts from the tape circle, flange side negative, and not from "
          "the flange's back (subtract the distance of the tape circle, 70 mm on most wheels)",
          up.tip);
  } else if (down.height >= flange && !is_round(p, -1.0)) {
    out.problem = fmt::format(
        "the flange (tip at y = {:.4g} m) points to smaller radii: z is the increase of the radius; change the sign of "
        "z{}",
        down.tip, down.tread_right ? "" : " and of y");
  }
  if (out.problem.empty() && (p.y.front() > 0.0 || p.y.back() < 0.0))
    out.problem = fmt::format(
        "the points lie from y = {:.4g} to {:.4g} m: y counts from the tape circle, which must "
        "be on the profile",
        p.y.front(), p.y.back());
  constexpr double most_wear = 10e-3;
  if (out.problem.empty() && std::abs(height_at_zero(p)) > most_wear)
    out.problem = fmt::format(
        "z is {0:.4g} m at the tape circle (y = 0): z is the increase of the radius from there; subtract {0:.4g} m",
        height_at_zero(p));
  return out;
}

ProfileRemarks remarks_on_rail(const ProfilePoints& p) {
  ProfileRemarks out;
  out.problem = wrong_unit(p);
  if (!out.problem.empty()) return out;
  const auto top = static_cast<std::size_t>(std::min_element(p.z.begin(), p.z.end()) - p.z.begin());
  const double lowest = *std::max_element(p.z.begin() + 1, p.z.end() - 1);
  const bool hangs = lowest - std::max(p.z.front(), p.z.back()) >= deep_groove;
  if (hangs && slope_of_end(p, false) < -upright && slope_of_end(p, true) < -upright) {
    out.problem = "both flanks rise from the middle: z counts downwards from the rail's top; change the sign of z";
    return out;
  }
  if (p.y.front() > 0.0 || p.y.back() < 0.0) {
    out.problem = fmt::format(
        "the points lie from y = {:.4g} to {:.4g} m: y counts from the rail's axis, which must "
        "be on the profile",
        p.y.front(), p.y.back());
    return out;
  }
  // heads lean inwards, so that the top lies on the field side of the middle between the flanks
  constexpr double depth = 10e-3, least_lean = 2e-3;
  std::size_t left = top, right = top;
  while (left > 0 && p.z[left] - p.z[top] < depth) --left;
  while (right + 1 < p.z.size() && p.z[right] - p.z[top] < depth) ++right;
  const bool flanks = p.z[left] - p.z[top] >= depth && p.z[right] - p.z[top] >= depth;
  const double lean = p.y[top] - 0.5 * (p.y[left] + p.y[right]);
  if (flanks && lean > least_lean)
    out.doubts.push_back(
        fmt::format("the rail leans outwards, its top is {:.2g} m on the gauge side of the head's middle: are the "
                    "profile's sides exchanged? y is positive towards the gauge side",
                    lean));
  return out;
}

namespace {

/// Fourth divided difference around point k, of weights whose squares sum up to 1.
struct FourthDifference {
  std::array<double, 5> weight{};  ///< of the points k - 2 to k + 2
  double value = 0.0;              ///< [m]
};
FourthDifference difference_at(const ProfilePoints& p, std::size_t k) {
  FourthDifference out;
  double squares = 0.0;
  for (std::size_t i = 0; i < 5; ++i) {
    double w = 1.0;
    for (std::size_t j = 0; j < 5; ++j)
      if (j != i) w /= p.y[k + i - 2] - p.y[k + j - 2];
    out.weight[i] = w;
    out.value += w * (p.z[k + i - 2] - p.z[k]);
    squares += w * w;
  }
  for (double& w : out.weight) w /= std::sqrt(squares);
  out.value /= std::sqrt(squares);
  return out;
}

/// Median distance of neighbours.
double middle_step(const ProfilePoints& p) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < p.y.size(); ++k) steps.push_back(p.y[k] - p.y[k - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// Curvature noise of a spline [1/m] by scatter of the points: second differences of white noise have the deviation
/// sqrt(6) s / h^2.
double bend_of(double scatter, double step) { return std::sqrt(6.0) * scatter / (step * step); }

/// Wheel and rail have a combined curvature of 5 /m, and the Hertz peak goes with the power 2/3 of about half of that:
/// it is 5 % off from 0.7 /m on.
constexpr double most_bend = 0.7;

}  // namespace

double noise_of(const ProfilePoints& p) {
  // of noise of one variance on equal steps a difference has that variance; the median of a normal distribution's
  // modulus is 0.6745 of its deviation
  std::vector<double> all;
  for (std::size_t k = 2; k + 2 < p.y.size(); ++k) all.push_back(std::abs(difference_at(p, k).value));
  if (all.empty()) return 0.0;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle / 0.6745;
}

std::string noise_remark(const ProfilePoints& p, double smoothing) {
  if (p.y.size() < 8) return "";
  const double noise = noise_of(p), bent = bend_of(noise, middle_step(p));
  if (bent < most_bend || smoothing >= 0.95 * noise) return "";
  return fmt::format(
      "the points scatter by {:.2g} m, which bends a curve through all of them by {:.2g} /m; smoothing = {:.2g} takes "
      "that away",
      noise, bent, 1.2 * noise);
}

std::string outlier_remark(const ProfilePoints& p) {
  if (p.y.size() < 20) return "";
  std::vector<FourthDifference> all(p.y.size());
  for (std::size_t k = 2; k + 2 < p.y.size(); ++k) all[k] = difference_at(p, k);
  const double noise = noise_of(p), step = middle_step(p);
  // the height e of a point over the curve of the others is a least-squares fit to the five differences that contain
  // it; a kink of a profile leaves 1/20 of their squares, a joint of two arcs more
  constexpr double alone = 100.0, over_noise = 10.0;
  double worst = 0.0;
  std::size_t where = 0;
  for (std::size_t k = 4; k + 4 < p.y.size(); ++k) {
    double squares = 0.0, own = 0.0, along = 0.0;
    for (std::size_t j = k - 2; j <= k + 2; ++j) {
      const double w = all[j].weight[k + 2 - j], d = all[j].value;
      squares += d * d;
      own += w * w;
      along += w * d;
    }
    const double height = std::abs(along / own), left = squares - along * along / own;
    if (height <= worst || height < over_noise * noise || bend_of(height, step) < most_bend) continue;
    if (squares < alone * left) continue;
    worst = height;
    where = k;
  }
  if (worst == 0.0) return "";
  return fmt::format("the point at y = {:.6g} m stands {:.2g} m off the curve of its neighbours: leave it out",
                     p.y[where], worst);
}

std::string hole_remark(const ProfilePoints& p) {
  constexpr double wide = 5.0, jump = 3.0;  // over the median, and over a neighbour: points that thin out are no hole
  if (p.y.size() < 8) return "";
  const double middle = middle_step(p);
  const auto step = [&](std::size_t k) { return p.y[k + 1] - p.y[k]; };
  std::size_t worst = 0;
  for (std::size_t k = 1; k + 2 < p.y.size(); ++k)
    if (step(k) > wide * middle && step(k) > jump * std::min(step(k - 1), step(k + 1)) &&
        (worst == 0 || step(k) > step(worst)))
      worst = k;
  if (worst == 0) return "";
  return fmt::format(
      "no points from y = {:.6g} to {:.6g} m: {:.3g} m wide, {:.2g} times the middle spacing; a curve is drawn through "
      "the hole",
      p.y[worst], p.y[worst + 1], step(worst), step(worst) / middle);
}

std::string smoothing_remark(const ProfilePoints& p, double smoothing) {
  constexpr double share = 1e-3;  // of the width: 1 % of the peak pressure of S1002 on 60E1
  const double noise = noise_of(p);
  if (!(smoothing > share * width_of(p) && smoothing > 2.0 * noise)) return "";
  return fmt::format(
      "smoothing = {:.2g} m takes away more than the {:.2g} m by which the points scatter: the curve leaves the "
      "profile",
      smoothing, noise);
}

std::string scale_remark(double width, double beside, double least_share) {
  if (width >= least_share * beside) return "";
  return fmt::format("the points span {:.3g} m in y beside {:.3g} m: is the unit of the first line right?", width,
                     beside);
}

}  // namespace epafi
