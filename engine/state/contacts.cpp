#include "engine/state/contacts.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>
#include <utility>

#include "engine/state/contact_order.h"
#include "engine/threads/parallel_order.h"

namespace epafi {

void ContactSet::clear() {
  a.clear();
  b.clear();
  feature.clear();
  gap.clear();
  normal.clear();
  arm.clear();
  effective_radius.clear();
  area.clear();
  force.clear();
  moment.clear();
}

/// Flattened: GCC leaves columns of names and numbers to calls, 2 % of a step of stones.
[[gnu::flatten]] void ContactSet::append(Slot slot_a, Slot slot_b, const ContactPoint& c) {
  a.push_back(slot_a);
  b.push_back(slot_b);
  feature.push_back(c.feature);
  gap.push_back(c.gap);
  normal.push_back(c.normal);
  arm.push_back(c.arm);
  if (with_curvature) effective_radius.push_back(c.effective_radius);
  if (with_area) area.push_back(c.area);
}

void ContactSet::append(const ContactSet& other) {
  const auto join = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  join(a, other.a);
  join(b, other.b);
  join(feature, other.feature);
  join(gap, other.gap);
  join(normal, other.normal);
  join(arm, other.arm);
  join(effective_radius, other.effective_radius);
  join(area, other.area);
}

void ContactSet::renew(std::size_t size) {
  const auto make = [size](auto& column, bool is_filled = true) { epafi::renew(column, is_filled ? size : 0); };
  make(a);
  make(b);
  make(feature);
  make(gap);
  make(normal);
  make(arm);
  make(force);
  make(effective_radius, with_curvature);
  make(area, with_area);
  make(moment, with_moment);
}

void ContactSet::put(std::size_t i, Slot slot_a, Slot slot_b, const ContactPoint& c, const Vec3& on_a,
                     const Vec3& moment_on_a) {
  a[i] = slot_a;
  b[i] = slot_b;
  feature[i] = c.feature;
  gap[i] = c.gap;
  normal[i] = c.normal;
  arm[i] = c.arm;
  force[i] = on_a;
  if (with_curvature) effective_radius[i] = c.effective_radius;
  if (with_area) area[i] = c.area;
  if (with_moment) moment[i] = moment_on_a;
}

void ContactSet::put(std::size_t i, const ContactSet& from, std::size_t k) {
  const ContactPoint c{from.gap[k],     from.normal[k],
                       from.arm[k],     with_curvature ? from.effective_radius[k] : 0.0,
                       from.feature[k], with_area ? from.area[k] : 0.0};
  put(i, from.a[k], from.b[k], c, from.force[k], with_moment ? from.moment[k] : Vec3(Vec3::Zero()));
}

void ContactSet::sort() {
  if (a.empty()) return;
  // by A first: slots are few and dense, so counting does it; what is left are runs of a handful
  std::vector<std::uint32_t> begin(std::size_t{*std::max_element(a.begin(), a.end())} + 2, 0), order(size());
  for (const Slot s : a) ++begin[s + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  for (std::uint32_t k = 0; k < order.size(); ++k) order[begin[a[k]]++] = k;
  const auto key = [&](std::uint32_t k) { return std::tuple(b[k], feature[k]); };
  for (auto run = order.begin(); run != order.end();) {
    const auto end = order.begin() + begin[a[*run]];
    std::sort(run, end, [&](std::uint32_t p, std::uint32_t q) { return key(p) < key(q); });
    run = end;
  }
  permute(order, a, b, feature, gap, normal, arm, effective_radius, area, force, moment);
}

std::span<const JoinedWalls> ContactSet::joined_to(Slot body, Slot wall) const {
  const auto is_before = [](const JoinedWalls& p, const JoinedWalls& q) {
    return std::tuple(p.body, p.wall) < std::tuple(q.body, q.wall);
  };
  const auto [begin, end] = std::equal_range(joined.begin(), joined.end(), JoinedWalls{body, wall, 0}, is_before);
  return {begin, end};
}

std::size_t ContactSet::bytes_per_contact() const {
  return 2 * sizeof(Slot) + sizeof(Feature) + sizeof(double) + 3 * sizeof(Vec3) +
         (with_curvature ? sizeof(double) : 0) + (with_area ? sizeof(double) : 0) + (with_moment ? sizeof(Vec3) : 0);
}

namespace {

/// Parts of a feature: the image in a periodic cell, and the name on the body (the name on the mesh is between them).
constexpr Feature image_bits = Feature{0xff} << 56, body_bits = 0xfffffff;

/// A corner has the same name for either order of the bodies: each body has its own bits, the other's are zero.
Feature name_on_body(Feature f, bool on_mesh) {
  constexpr Feature corner_bits = 0x3fffff;
  return on_mesh ? f & body_bits : (f | f >> 22) & corner_bits;
}

/// The contacts of one pair of bodies in a list in canonical order, in some of its images.
struct PairRange {
  const std::vector<Feature>& feature;
  std::size_t begin, end;

  PairRange(const std::vector<Slot>& a, const std::vector<Slot>& b, const std::vector<Feature>& features, Slot first,
            Slot second, Feature first_image, Feature last_image)
      : feature(features) {
    const auto bound = [&](Feature f) {  // the first entry that is not before it
      std::size_t low = 0, high = a.size();
      while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (std::tuple(a[middle], b[middle], features[middle]) < std::tuple(first, second, f))
          low = middle + 1;
        else
          high = middle;
      }
      return low;
    };
    begin = bound(first_image);
    end = begin;
    while (end < a.size() && a[end] == first && b[end] == second && (features[end] & image_bits) <= last_image) ++end;
  }
  /// Index of the entry of that feature; `end` where there is none.
  std::size_t find(Feature f) const {
    const auto last = feature.begin() + static_cast<std::ptrdiff_t>(end);
    const auto found = std::lower_bound(feature.begin() + static_cast<std::ptrdiff_t>(begin), last, f);
    return found != last && *found == f ? static_cast<std::size_t>(found - feature.begin()) : end;
  }
};

/// Counts of some entries of a list: all, those with one name on the body; and the last of them.
struct Chosen {
  Feature name;
  bool on_mesh;
  std::size_t all = 0, of_name = 0, last = 0, last_of_name = 0;

  void take(const PairRange& list, std::size_t k) {
    ++all;
    last = k;
    if (name_on_body(list.feature[k], on_mesh) != name) return;
    ++of_name;
    last_of_name = k;
  }
};

}  // namespace

std::uint32_t ContactMemory::left_for(const ContactSet& contacts, std::size_t i, const IsEmpty& is_empty) const {
  const Slot a = contacts.a[i], b = contacts.b[i];
  const Feature f = contacts.feature[i], image = f & image_bits;
  const auto is_mesh = [&](Slot s) { return std::binary_search(contacts.meshes.begin(), contacts.meshes.end(), s); };
  const bool on_mesh = is_mesh(a) || is_mesh(b);
  Chosen begun{name_on_body(f, on_mesh), on_mesh}, ended = begun;
  const auto look_at = [&](Slot first, Slot second, Feature first_image, Feature last_image) {
    const PairRange now(contacts.a, contacts.b, contacts.feature, first, second, first_image, last_image);
    const PairRange before(a_, b_, feature_, first, second, first_image, last_image);
    for (std::size_t k = before.begin; k < before.end; ++k)
      if (now.find(feature_[k]) == now.end && !(is_empty && is_empty(k))) ended.take(before, k);
    for (std::size_t k = now.begin; k < now.end; ++k) {
      const std::size_t was = before.find(contacts.feature[k]);
      if (was == before.end || (is_empty && is_empty(was))) begun.take(now, k);
    }
  };
  const std::array joined = {contacts.joined_to(a, b), contacts.joined_to(b, a)};
  const bool alone = joined[0].empty() && joined[1].empty();
  look_at(a, b, alone ? image : 0, alone ? image : image_bits);
  for (const auto& walls : joined)
    for (const JoinedWalls& w : walls) {
      if (w.other == w.wall) continue;
      look_at(w.body, w.other, 0, image_bits);  // one of both: the body of lower id comes first
      look_at(w.other, w.body, 0, image_bits);
    }
  if (begun.of_name == 1 && ended.of_name == 1) return static_cast<std::uint32_t>(ended.last_of_name);
  if (begun.all == 1 && ended.all == 1) return static_cast<std::uint32_t>(ended.last);
  return none;
}

/// The contact of the same two bodies, in the same image, that has ended within 1 % of the shorter arm of contact i,
/// which begins: the nearest one that has no nearer successor. k: where contact i would stand in the remembered list.
std::uint32_t ContactMemory::left_nearby(const World& world, const ContactSet& contacts, std::size_t i, std::size_t k,
                                         const IsEmpty& is_empty) const {
  constexpr double nearby = 1e-2;
  const Slot a = contacts.a[i], b = contacts.b[i];
  const Feature f = contacts.feature[i];
  const auto same_pair = [f, a, b](const std::vector<Slot>& of_a, const std::vector<Slot>& of_b,
                                   const std::vector<Feature>& of, std::size_t at) {
    return at < of_a.size() && of_a[at] == a && of_b[at] == b && ((of[at] ^ f) & image_bits) == 0;
  };
  const auto range = [&](const auto& is_in, std::size_t at) {
    std::size_t begin = at, end = at;
    while (begin > 0 && is_in(begin - 1)) --begin;
    while (is_in(end)) ++end;
    return std::pair(begin, end);
  };
  const auto was = range([&](std::size_t at) { return same_pair(a_, b_, feature_, at); }, k);
  if (was.first == was.second) return none;
  const auto is = range([&](std::size_t at) { return same_pair(contacts.a, contacts.b, contacts.feature, at); }, i);
  const auto place = [](const std::vector<Feature>& of, std::pair<std::size_t, std::size_t> in, Feature wanted) {
    const auto end = of.begin() + static_cast<std::ptrdiff_t>(in.second);
    const auto found = std::lower_bound(of.begin() + static_cast<std::ptrdiff_t>(in.first), end, wanted);
    return found != end && *found == wanted ? static_cast<std::size_t>(found - of.begin()) : in.second;
  };
  const auto holds = [&](std::size_t at) { return at != was.second && !(is_empty && is_empty(at)); };
  const auto has_ended = [&](std::size_t at) {
    return holds(at) && place(contacts.feature, is, feature_[at]) == is.second;
  };
  const auto begins = [&](std::size_t at) { return !holds(place(feature_, was, contacts.feature[at])); };
  const auto distance = [&](std::size_t before, std::size_t now) {
    return (arm_[before] - contacts.arm[now]).squaredNorm();
  };
  double least = nearby * nearby * std::min(contacts.arm[i].squaredNorm(), contacts.arm_b(i, world).squaredNorm());
  std::uint32_t nearest = none;
  for (std::size_t at = was.first; at < was.second; ++at)
    if (distance(at, i) < least && has_ended(at)) {
      least = distance(at, i);
      nearest = static_cast<std::uint32_t>(at);
    }
  for (std::size_t at = is.first; at < is.second && nearest != none; ++at)
    if (at != i && begins(at) && std::pair(distance(nearest, at), at) < std::pair(least, i)) nearest = none;
  return nearest;
}

/// If two contacts would continue the same one, the first does.
void ContactMemory::settle_joined(const ContactSet& contacts, std::vector<std::uint32_t>& previous,
                                  std::vector<std::uint32_t>* turned) {
  taken_.assign(a_.size(), 0);
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    std::uint32_t& k = previous[i];
    if (k == none) continue;
    if (std::exchange(taken_[k], 1) != 0) k = none;
    if (k != none && turned && (a_[k] == contacts.b[i] || b_[k] == contacts.a[i])) turned->push_back(i);
  }
}

void ContactMemory::match(const World& world, const ContactSet& contacts, std::vector<std::uint32_t>& previous,
                          const IsEmpty& is_empty, std::vector<std::uint32_t>* turned) {
  previous.resize(contacts.size());
  const auto is_mesh = [&](Slot s) { return std::binary_search(contacts.meshes.begin(), contacts.meshes.end(), s); };
  const auto may_go_on = [&](Slot a, Slot b) {
    return is_mesh(a) || is_mesh(b) || !contacts.joined_to(a, b).empty() || !contacts.joined_to(b, a).empty();
  };
  parallel_blocks(contacts.size(), 1024, [&](std::size_t begin, std::size_t end, std::size_t) {
    const auto key = [&](std::size_t i) { return std::tuple(contacts.a[i], contacts.b[i], contacts.feature[i]); };
    const auto old = [&](std::size_t k) { return std::tuple(a_[k], b_[k], feature_[k]); };
    const auto is_before = [&](const Slot& a) { return old(static_cast<std::size_t>(&a - a_.data())) < key(begin); };
    auto k = static_cast<std::size_t>(std::partition_point(a_.begin(), a_.end(), is_before) - a_.begin());
    for (std::size_t i = begin; i < end; ++i) {
      const auto wanted = key(i);
      while (k < a_.size() && old(k) < wanted) ++k;
      const bool found = k < a_.size() && old(k) == wanted;
      previous[i] = found ? static_cast<std::uint32_t>(k) : none;
      if (found && !(is_empty && is_empty(k))) continue;
      std::uint32_t left = none;
      if (may_go_on(contacts.a[i], contacts.b[i])) left = left_for(contacts, i, is_empty);
      if (left == none) left = left_nearby(world, contacts, i, k, is_empty);
      if (left != none) previous[i] = left;
    }
  });
  if (!contacts.joined.empty()) settle_joined(contacts, previous, turned);
  a_ = contacts.a;
  b_ = contacts.b;
  feature_ = contacts.feature;
  arm_ = contacts.arm;
}

std::vector<std::uint32_t> ContactMemory::reorder(const Reordering& change) {
  const std::vector<std::uint32_t> order = order_after(change, a_, b_, feature_);
  permute(order, a_, b_, feature_, arm_);
  return order;
}

void ContactMemory::visit(StateVisitor& visitor, const std::string& name) {
  visitor.rows(RowsOf::first_slots, name + "/a", a_);
  visitor.rows(RowsOf::second_slots, name + "/b", b_);
  visitor.rows(RowsOf::contacts, name + "/feature", feature_);
  visitor.rows(RowsOf::contacts, name + "/arm", arm_);
}

}  // namespace epafi
