#include "scenes/patch/seated_wheel.h"

#include <algorithm>
#include <cmath>

namespace epafi {
namespace {

constexpr double reach = 1e-3;    // vertical gap beyond which no load of a railway closes a second region [m]
constexpr double deepest = 1e-3;  // gap beyond the reach of all models and loads of a railway [m]
constexpr double profile_step = 0.2e-3, half_profile = 16e-3, farthest_joined = 40e-3;  // [m]
constexpr double together = 14e-3, alike = 0.3;  // regions within one profile: distance [m], difference of angle [rad]

bool within(const ContactRegion& a, const ContactRegion& b) {
  return std::abs(a.y_rail - b.y_rail) < together && std::abs(a.angle - b.angle) < alike;
}

double smallest_gap(const ContactRegion& r) {
  return r.profile.gap.empty() ? r.offset : *std::min_element(r.profile.gap.begin(), r.profile.gap.end());
}

const NormalModel& strips_model() {
  const auto& all = all_normal_models();
  return *std::find_if(all.begin(), all.end(), [](const NormalModel& m) { return m.entry.name == "semi-hertz"; });
}

}  // namespace

void SeatedWheel::place(const WheelsetPosition& position) {
  reach_ = half_profile;
  pair.sample_profiles({profile_step, reach_, deepest});
  pair.place(position);
  pair.touch();
  rigid = pair.find_regions(reach);
  seated.clear();
}

double SeatedWheel::estimate(const std::vector<ContactRegion>& on, const NormalTarget& target, double value,
                             double known) {
  NormalInput in{pair, on, elastic_, {target.by_force, value}};
  in.influence = influence_;
  in.approach = known;
  in.start = &strips.front();
  return estimate_approach(in);
}

void SeatedWheel::settle(const NormalTarget& target) {
  if (rigid.empty()) return;
  settle_deepest(target);
  // a wheel on the deepest region alone lies lower than on several: regions without contact then have none at all
  std::vector<ContactRegion> others;
  for (std::size_t k = 1; k < rigid.size(); ++k) {
    ContactRegion& r = rigid[k];
    pair.add_profile(r);
    constexpr double margin = 1.2;  // friction on a flank lets it sink farther
    if (within(r, rigid.front()) || !(r.offset < margin * depth * steepness(r)) || joins_deepest(r)) continue;
    if (std::none_of(others.begin(), others.end(), [&](const ContactRegion& o) { return within(r, o); }))
      others.push_back(r);
  }
  if (reach_ > half_profile) {  // what has joined shares the load
    settle_again(target);
  }
  if (others.empty()) return;
  seated.insert(seated.end(), others.begin(), others.end());
  strips.assign(seated.size(), {});
  sampled_at_.assign(seated.size(), -1.0);
  if (target.by_force)
    settle_all(target.value);
  else
    seat(depth);
}

bool SeatedWheel::joins_deepest(const ContactRegion& r) {
  // extent along the rail in which regions influence each other
  ContactRegion& first = seated.front();
  if (!(std::abs(r.angle - first.angle) < alike)) return false;
  const double apart = std::abs(r.y_rail - first.y_rail), reach_before = reach_;
  if (!(apart < farthest_joined)) return false;
  reach_ = std::max(reach_, apart + 10e-3);
  pair.sample_profiles({profile_step, reach_, deepest});
  pair.add_profile(first);
  const std::vector<OverlapRange> overlaps = overlaps_of(first.profile, depth * steepness(first));
  // the profile's coordinate runs from the gauge side outwards
  constexpr double about = 3e-3;
  const double there = first.y_rail - r.y_rail, low = std::min(0.0, there) - about, high = std::max(0.0, there) + about;
  double widest = 0.0;
  std::size_t met = 0;
  for (std::size_t k = 0; k < overlaps.size(); ++k) {
    if (overlaps[k].high < low || overlaps[k].low > high) continue;
    if (++met > 1) widest = std::max(widest, overlaps[k].low - overlaps[k - 1].high);
  }
  if (r.offset < depth * steepness(r) && met > 0 && widest < influence_.none) return true;
  reach_ = reach_before;
  pair.sample_profiles({profile_step, reach_, deepest});
  pair.add_profile(first);
  return false;
}

void SeatedWheel::settle_deepest(const NormalTarget& target) {
  const double N = target.by_force ? target.value / std::cos(rigid.front().angle) : target.value;
  depth = estimate(rigid, target, N, 0.0) / steepness(rigid.front());
  pair.lower(depth);
  pair.add_profile(rigid.front());
  seated.assign(1, rigid.front());
  sampled_at_.assign(1, depth);
  settle_again(target);
}

void SeatedWheel::settle_again(const NormalTarget& target) {
  for (int round = 0; round < 2; ++round) {  // as deep as its load brings it, in the plane of its own patch
    seat(depth);
    const double here = target.by_force ? target.value / std::cos(seated.front().angle) : target.value;
    const double last = depth * steepness(seated.front());
    approach = estimate(seated, target, here, last);
    depth = approach / steepness(seated.front());
    if (std::abs(approach - last) < 0.01 * last) break;  // the model itself brings it nearer, if it can
  }
  seat(depth);
}

double SeatedWheel::vertical_force() {
  const std::vector<ContactRegion> none;
  double sum = 0.0;
  NormalInput in{pair, none, elastic_, {}};
  in.influence = influence_;
  for (const RegionPatch& p : solve(strips_model(), in))
    sum += vertical_part(p.patch.normal_force, seated[p.region].angle);
  return sum;
}

void SeatedWheel::settle_all(double load) {
  // forces grow about as depth^(3/2); bracket: 0 and the depth of the deepest region alone
  double low = 0.0, high = depth;
  for (int k = 0; k < 40 && high - low > 1e-4 * high; ++k) {
    seat(depth);
    const double ratio = vertical_force() / load;
    if (std::abs(ratio - 1.0) < 1e-3) break;
    (ratio < 1.0 ? low : high) = depth;
    if (ratio < 1.0 && high <= low) high = 2.0 * low;
    const double next = ratio > 0.0 ? depth * std::pow(ratio, -2.0 / 3.0) : 0.0;
    depth = next > low && next < high ? next : 0.5 * (low + high);
  }
  seat(depth);
  approach = depth * steepness(seated.front());
}

void SeatedWheel::sample(std::size_t k) {
  for (std::size_t other = 0; other < seated.size(); ++other)
    if (other != k) pair.part(seated[k], seated[other]);
  sampled_at_[k] = lowered;
}

void SeatedWheel::seat(double down) {
  // a wheel lowered along z also moves along the plane: sampled gaps stay valid up to 1e-3 of 20 um
  constexpr double sideways = 2e-8;
  pair.lower(down);
  lowered = down;
  for (std::size_t k = 0; k < seated.size(); ++k) {
    ContactRegion& r = seated[k];
    if (sampled_at_[k] < 0.0 || std::abs((down - sampled_at_[k]) * std::sin(r.angle)) > sideways) {
      pair.add_profile(r);
      sample(k);
    }
    const PatchPlace at = place_of_patch(pair, r, down * steepness(r));
    if (std::abs(at.y) <= 2e-6 && std::abs(at.angle - r.angle) <= 1e-5) continue;
    r = pair.moved(r, at.y, at.angle);
    sample(k);
  }
}

std::vector<RegionPatch> SeatedWheel::solve(const NormalModel& model, NormalInput in) {
  std::vector<RegionPatch> all;
  for (std::size_t k = 0; k < seated.size(); ++k) {
    const double here = lowered * steepness(seated[k]);
    if (!(smallest_gap(seated[k]) < here)) continue;
    const std::vector<ContactRegion> one{seated[k]};
    NormalInput part{in.source, one, in.elastic, {false, here}, in.dx, in.dy, here};
    part.influence = in.influence;
    part.settle = in.settle;
    part.stresses = in.stresses;
    part.penalty = in.penalty;
    part.start = &strips[k];
    for (RegionPatch& p : model.solve(part)) {
      p.region = k;
      all.push_back(std::move(p));
    }
  }
  return all;
}

double SeatedWheel::rolling_radius() {
  if (!apart()) return seated.front().rolling_radius;
  const std::vector<ContactRegion> none;
  NormalInput in{pair, none, elastic_, {}};
  in.influence = influence_;
  double sum = 0.0, force = 0.0;
  for (const RegionPatch& p : solve(strips_model(), in)) {
    sum += p.patch.normal_force * seated[p.region].rolling_radius;
    force += p.patch.normal_force;
  }
  return force > 0.0 ? sum / force : seated.front().rolling_radius;
}

}  // namespace epafi
