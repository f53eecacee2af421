#include "laws/wheel_rail/rolling_contact.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "engine/step/contact_layer.h"
#include "engine/threads/parallel.h"
#include "engine/units/error.h"
#include "laws/material.h"
#include "laws/wheel_rail/normal/hertz_ellipse.h"
#include "laws/wheel_rail/normal_models.h"
#include "laws/wheel_rail/tangential_models.h"

namespace epafi {
namespace {

template <class List>
const typename List::value_type* model_named(const List& list, const std::string& name) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const auto& m) { return m.entry.name == name; });
  return found == list.end() ? nullptr : &*found;
}

/// Strips of one region at the last step, from which the next one starts.
struct StripRecord {
  Slot wheelset;
  std::uint32_t name;
  StripStart start;
};

/// Limits common to all models for motion: half-spaces on inclined surfaces, creep laws for ellipses on other patches.
/// No other choice avoids them, so a run does not warn of them; `epafi patch` reports them.
bool is_shared_limit(const std::string& reason) {
  constexpr std::string_view shared[] = {"conformal contact", "the patch is not an ellipse", "axis ratio a/b outside"};
  return std::ranges::any_of(shared, [&](std::string_view text) { return reason.starts_with(text); });
}

/// Load of one contact region on its wheelset.
struct RollingForce {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();  ///< on the wheelset, about its centre
  Vec3 point = Vec3::Zero();                         ///< of the contact, world axes [m]
  double elastic = 0.0, lost = 0.0;                  ///< [J], [W]
  bool touches = false;
  std::vector<std::string> reasons{};  ///< why the models are outside their range
};

/// The patch of a wheel that rolls the other way: rotated by 180 deg about its normal.
void turn_round(NormalPatch& p) {
  std::reverse(p.pressure.begin(), p.pressure.end());
  p.grid_x = -p.grid_x;
  p.grid_y = -p.grid_y;
  p.centre_x = -p.centre_x;
  p.centre_y = -p.centre_y;
}

class RollingContact final : public ContactLayer {
 public:
  RollingContact(const RollingSetup& setup, const RollingRegions& regions, std::unique_ptr<ContactModel> below)
      : ContactLayer(std::move(below)),
        setup_(setup),
        regions_(regions),
        normal_(*model_named(all_normal_models(), setup.normal)),
        tangential_(model_named(all_tangential_models(), setup.tangential)) {
    for (const MaterialPair& p : setup.materials.pairs)
      elastic_.push_back(p.occurs ? elastic_pair(p.a, p.b) : ElasticPair{});
  }
  void act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) override;
  void reorder(const Reordering& change) override;
  void visit(StateVisitor& visitor) override {
    ContactLayer::visit(visitor);
    visitor.column("rolling/strips", records_);
    visitor.value("rolling/lost_power", lost_power_);
  }
  void publish(const World& world, ContactSet& contacts) const override;
  std::size_t own_parts() const override { return ContactLayer::own_parts() + (published_ ? 0 : 1); }
  std::optional<std::size_t> own_count(std::size_t part) const override {
    if (part < ContactLayer::own_parts()) return ContactLayer::own_count(part);
    const auto touches = [](const RollingForce& f) { return f.touches; };
    return static_cast<std::size_t>(std::ranges::count_if(forces_, touches));
  }
  void append_gaps(const World& world, std::size_t part, ContactSet& gaps) const override {
    append_contacts(world, part, {}, gaps);  // one or two a wheel
  }
  void append_contacts(const World& world, std::size_t part, const Wanted& wanted, ContactSet& contacts) const override;

 private:
  const StripStart* start_of(const RollingRegion& r) const;
  NormalPatch patch_of(const RollingRegion& r, const ElasticPair& elastic, StripStart& start) const;
  RollingForce evaluate(const World& world, const RollingRegion& r, const BodyMotion& motion, StripStart& start) const;
  TangentialOutcome creep(const RollingRegion& r, NormalPatch& patch, const ElasticPair& elastic, double friction,
                          Creepage creepage, bool backwards) const;

  RollingSetup setup_;
  const RollingRegions& regions_;
  const NormalModel& normal_;
  const TangentialModel* tangential_;  ///< null: no friction
  std::vector<ElasticPair> elastic_;   ///< by pair of materials
  std::vector<StripRecord> records_;
  std::vector<RollingForce> forces_;
  std::vector<BodyMotion> motions_;
  double lost_power_ = 0.0;  ///< at the last detection [W]
  mutable bool published_ = false;
};

const StripStart* RollingContact::start_of(const RollingRegion& r) const {
  for (const StripRecord& known : records_)
    if (known.wheelset == r.wheelset && known.name == r.name) return &known.start;
  return nullptr;
}

NormalPatch RollingContact::patch_of(const RollingRegion& r, const ElasticPair& elastic, StripStart& start) const {
  std::vector<ContactRegion> one{r.region};
  double approach = r.approach;
  if (normal_.whole_gap) {  // gaps are zero where the deepest region touches; here they are larger by the offset
    approach += r.region.offset;
  } else {
    for (double& gap : one.front().profile.gap) gap -= r.region.offset;
    one.front().offset = 0.0;
  }
  NormalInput in{*r.source, one, elastic, {false, approach}};
  in.approach = approach;
  in.strips = setup_.across;
  in.along = setup_.along;
  in.start = &start;
  return std::move(normal_.solve(in).front().patch);
}

/// Position on the rail in the axes of the region; y as on the track.
TangentialOutcome RollingContact::creep(const RollingRegion& r, NormalPatch& patch, const ElasticPair& elastic,
                                        double friction, Creepage c, bool backwards) const {
  if (r.mirrored) {
    c.lateral = -c.lateral;
    c.spin = -c.spin;
  }
  if (backwards) {
    turn_round(patch);
    c.longitudinal = -c.longitudinal;
    c.lateral = -c.lateral;
  }
  const PatchGrid cells{static_cast<std::size_t>(setup_.along), static_cast<std::size_t>(setup_.across), 0.0, 0.0};
  TangentialOutcome out = tangential_->solve({patch, elastic, friction, c, cells});
  PatchForce& f = out.force;
  if (backwards) {
    turn_round(patch);
    f.fx = -f.fx;
    f.fy = -f.fy;
  }
  if (r.mirrored) {
    f.fy = -f.fy;
    f.mz = -f.mz;
  }
  return out;
}

RollingForce RollingContact::evaluate(const World& world, const RollingRegion& r, const BodyMotion& motion,
                                      StripStart& start) const {
  RollingForce out;
  if (!(r.approach > 0.0) || (r.within && normal_.whole_gap)) return out;
  const std::size_t materials = setup_.materials.materials, a = world.material[r.wheelset], b = world.material[r.track];
  const ElasticPair& elastic = elastic_[a * materials + b];
  const MaterialPair& pair = setup_.materials.pairs[a * materials + b];
  NormalPatch patch = patch_of(r, elastic, start);
  out.reasons = std::move(patch.reasons);
  if (!(patch.normal_force > 0.0)) return out;
  out.touches = true;
  // the patch may lie beside the rigid point: forces act where it is and along its own mean normal
  double angle = r.region.angle;
  if (normal_.whole_gap && r.region.profile.size() > 0)
    angle = place_of_patch(*r.source, r.region, r.approach + r.region.offset).angle;
  const double turn = angle - r.region.angle;
  const Vec3 x = r.axes.col(0), t = std::cos(turn) * r.axes.col(1) + std::sin(turn) * r.axes.col(2), n = x.cross(t);
  const double side = r.mirrored ? -1.0 : 1.0;
  const Vec3 centre = r.point + patch.centre_x * x + side * patch.centre_y * t;
  const Vec3 arm = r.point - world.position[r.wheelset];
  // the wheel's material at the origin of the tangent plane; the rail stands still
  const Vec3 slip = motion.velocity + motion.angular_velocity.cross(arm);
  const double forward = motion.velocity.dot(x), spin = motion.angular_velocity.dot(n);
  const double rolling = 0.5 * (forward + (forward - slip.dot(x)));
  const double speed = std::max(std::abs(rolling), setup_.slowest);
  Vec3 force = -patch.normal_force * n;
  out.moment = (centre - world.position[r.wheelset]).cross(force);
  if (tangential_ && pair.friction > 0.0) {
    const double w = std::hypot(slip.dot(x), slip.dot(t)), A = setup_.friction_limit;
    const double friction = pair.friction * ((1.0 - A) * std::exp(-setup_.friction_decay * w) + A);
    const TangentialOutcome rolled =
        creep(r, patch, elastic, friction, {-slip.dot(x) / speed, -slip.dot(t) / speed, -spin / speed}, rolling < 0.0);
    const PatchForce& f = rolled.force;
    out.reasons.insert(out.reasons.end(), rolled.reasons.begin(), rolled.reasons.end());
    // tractions of an ellipse refer to its centre, those of a grid to the centre of the grid
    const double px = patch.is_ellipse ? patch.centre_x : patch.grid_x,
                 py = side * (patch.is_ellipse ? patch.centre_y : patch.grid_y);
    const Vec3 at = arm + px * x + py * t, creep = -f.fx * x - f.fy * t;
    out.moment += at.cross(creep) - f.mz * n;
    force += creep;
    out.lost = -creep.dot(motion.velocity + motion.angular_velocity.cross(at)) + f.mz * spin;
  }
  out.force = force;
  out.point = centre;
  out.elastic = 0.4 * patch.normal_force * r.approach;
  return out;
}

void RollingContact::act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) {
  const std::vector<RollingRegion>& regions = regions_.all;
  const std::size_t n = regions.size();
  motions_.resize(n);
  forces_.assign(n, {});
  for (std::size_t k = 0; k < n; ++k) motions_[k] = motion_at_detection(world, regions[k].wheelset, clock);
  below_->act(world, contacts, clock, report);
  published_ = false;
  std::vector<StripRecord> next(n);
  for (std::size_t k = 0; k < n; ++k) {
    next[k] = {regions[k].wheelset, regions[k].name, {}};
    if (const StripStart* known = start_of(regions[k])) next[k].start = *known;
  }
  parallel_blocks(n, 1, [&](std::size_t k, std::size_t, std::size_t) {
    forces_[k] = evaluate(world, regions[k], motions_[k], next[k].start);
  });
  if (clock.dt > 0.0) records_.swap(next);  // an evaluation with dt = 0 changes no history
  double lost = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const RollingForce& f = forces_[k];
    if (clock.dt > 0.0)
      for (const std::string& reason : f.reasons)
        if (!is_shared_limit(reason)) report.doubts.push_back({reason, regions[k].wheelset, f.force.norm()});
    if (!f.touches) continue;
    world.force[regions[k].wheelset] += f.force;
    world.torque[regions[k].wheelset] += f.moment;
    if (world.columns().held_force) world.force[regions[k].track] -= f.force;
    report.elastic += f.elastic;
    lost += f.lost;
    ++report.contacts;
    ++report.touching;
  }
  if (clock.dt > 0.0) {
    report.dissipated += 0.5 * clock.dt * (lost_power_ + lost);
    report.losses.frictional += 0.5 * clock.dt * (lost_power_ + lost);
  }
  lost_power_ = lost;
}

void RollingContact::reorder(const Reordering& change) {
  ContactLayer::reorder(change);
  std::erase_if(records_, [&](const StripRecord& r) { return change.new_slot[r.wheelset] == no_slot; });
  for (StripRecord& r : records_) r.wheelset = change.new_slot[r.wheelset];
}

void RollingContact::publish(const World& world, ContactSet& contacts) const {
  ContactLayer::publish(world, contacts);
  if (published_) return;
  append_contacts(world, ContactLayer::own_parts(), {}, contacts);
  published_ = true;
  contacts.sort();
}

void RollingContact::append_contacts(const World& world, std::size_t part, const Wanted& wanted,
                                     ContactSet& contacts) const {
  if (part < ContactLayer::own_parts()) return ContactLayer::append_contacts(world, part, wanted, contacts);
  for (std::size_t k = 0; k < forces_.size(); ++k) {
    const RollingRegion& r = regions_.all[k];
    const RollingForce& f = forces_[k];
    if (!f.touches || (wanted && !wanted(r.wheelset, r.track))) continue;
    const bool first = world.id[r.wheelset] < world.id[r.track];
    const Slot a = first ? r.wheelset : r.track, b = first ? r.track : r.wheelset;
    const Vec3 n = r.axes.col(2);
    contacts.append(a, b,
                    {-r.approach, first ? n : Vec3(-n), f.point - world.position[a],
                     1.0 / (r.region.curvature_x + std::max(0.0, r.region.curvature_y)), r.name});
    contacts.force.push_back(first ? f.force : Vec3(-f.force));
    if (contacts.with_moment) contacts.moment.push_back(Vec3::Zero());
  }
}

}  // namespace

std::vector<Field> rolling_fields() {
  Field normal{"normal", "", "", Kind::text, Value(std::string("semi-hertz")), {}, "normal model"};
  for (const auto& m : all_normal_models()) normal.choices.push_back(m.entry.name);
  Field tangential{"tangential", "", "", Kind::text, Value(std::string("fastsim")), {}, "tangential model, or none"};
  tangential.choices = {"none"};
  for (const auto& m : all_tangential_models())
    if (m.steady) tangential.choices.push_back(m.entry.name);
  return {
      normal,
      tangential,
      {"along", "", "", Kind::integer, Value(24.0), {4, 400}, "cells along a patch"},
      {"across", "", "", Kind::integer, Value(16.0), {4, 200}, "strips across a patch"},
      {"friction_limit", "A", "", Kind::number, Value(1.0), unit_interval,
       "friction at high slip velocity over that at rest"},
      {"friction_decay", "B", "s/m", Kind::number, Value(0.0), not_negative, "decay of friction with slip velocity"},
      {"slowest", "", "m/s", Kind::number, Value(0.05), positive,
       "smallest rolling speed that creepages are divided by"}};
}

std::unique_ptr<ContactModel> make_rolling_contact(const RollingSetup& setup, const RollingRegions& regions,
                                                   std::unique_ptr<ContactModel> below) {
  EPAFI_REQUIRE(model_named(all_normal_models(), setup.normal), "a normal model of the list");
  return std::make_unique<RollingContact>(setup, regions, std::move(below));
}

RollingLimits rolling_limits(const RollingSetup& setup, const MaterialPair& pair, double load, double radius,
                             double speed) {
  const ElasticPair e = elastic_pair(pair.a, pair.b);
  // crown of 0.3 m; c11 and c22 are about 4 for equal axes
  const HertzContact c = hertz_of_force(0.5 / radius, 0.5 / 0.3, e.effective_modulus(), load);
  const bool creeps = setup.tangential != "none" && pair.friction > 0.0;
  return {c.stiffness,
          creeps ? 4.0 * e.shear_modulus * c.ellipse.a * c.ellipse.b / std::max(speed, setup.slowest) : 0.0};
}

}  // namespace epafi
