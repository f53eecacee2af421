#include "scenes/railway/rolling.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string_view>
#include <utility>

#include "detection/profiles/rolling_search.h"
#include "scenes/contact_setup.h"

namespace epafi {
namespace {

/// The track of a fixed body, in world axes.
class LaidTrack final : public Guideway {
 public:
  LaidTrack(std::shared_ptr<const Track> track, const Pose& body) : track_(std::move(track)), body_(body) {}
  Pose frame(double s) const override {
    const Pose local = track_->frame(s);
    return {body_.to_world(local.position), body_.orientation * local.orientation};
  }
  double distance_of(const Vec3& point) const override { return track_->distance_of(body_.to_local(point)); }

 private:
  std::shared_ptr<const Track> track_;
  Pose body_;
};

std::shared_ptr<const Guideway> way_of(const Assembly& a) {
  const World& w = a.simulation->world;
  std::shared_ptr<const Guideway> way = std::make_shared<StraightWay>();
  int tracks = 0;
  for (Slot s = 0; s < w.size(); ++s) {
    const ShapeRef ref{w.shape[s]};
    if (ref.type() != ShapeStore::type_of<RailProfile>() || ++tracks > 1) continue;
    way = std::make_shared<LaidTrack>(a.shapes->of<RailProfile>()[ref.index()].track, w.pose(s));
  }
  return tracks > 1 ? std::make_shared<StraightWay>() : way;
}

}  // namespace

std::vector<SpringElement> springs_of(const Assembly& a) {
  std::vector<SpringElement> out;
  for (const SpringSpec& s : a.scene.springs) {
    const World& world = a.simulation->world;
    const ShapeOrigin* origin = a.origins.of(world.shape[world.slot_of(a.id_of(s.body))]);
    const bool turned = origin != nullptr && origin->is_turned();  // the engine's axes are the principal ones
    const Vec3 attachment = turned ? Vec3(origin->to_author.conjugate() * s.attachment) : s.attachment;
    SpringElement e{s.name, a.id_of(s.body), attachment, {}, s.speed, s.stiffness, s.damping, s.preload};
    if (s.to) e.to = a.id_of(*s.to);
    out.push_back(e);
  }
  return out;
}

namespace {

/// State of springs: relaxed positions and the start of their frames.
class SpringState final : public StateVisitor {
 public:
  std::vector<Vec3> relaxed;
  std::vector<double> start;

 private:
  std::size_t bytes_of(std::string_view, std::size_t, std::size_t current) override { return current; }
  void exchange(std::string_view name, std::size_t, std::byte* data, std::size_t bytes) override {
    if (name == "springs/relaxed") fill(relaxed, data, bytes);
    if (name == "springs/start") fill(start, data, bytes);
  }
  template <class T>
  static void fill(std::vector<T>& to, const std::byte* data, std::size_t bytes) {
    to.resize(bytes / sizeof(T));
    if (bytes > 0) std::memcpy(static_cast<void*>(to.data()), data, bytes);
  }
};

}  // namespace

std::vector<Vec3> spring_loads(const Assembly& a) {
  const std::vector<SpringElement> springs = springs_of(a);
  std::vector<Vec3> out(springs.size(), Vec3::Zero());
  SpringState state;
  a.simulation->visit(state);
  if (state.relaxed.size() != springs.size()) return out;
  const World& world = a.simulation->world;
  const auto way = way_of(a);
  for (std::size_t k = 0; k < springs.size(); ++k) {
    const SpringElement& s = springs[k];
    const Slot body = world.slot_of(s.body), far = s.to ? world.slot_of(*s.to) : no_slot;
    if (body == no_slot || (s.to && far == no_slot)) continue;
    const Pose frame = s.to ? unwrapped_pose(world, far) : way->frame(state.start[k] + s.speed * world.clock);
    const Vec3 stretch = state.relaxed[k] - frame.to_local(unwrapped_pose(world, body).to_world(s.attachment));
    out[k] = s.stiffness.cwiseProduct(stretch);
  }
  return out;
}

RollingSetup rolling_setup(const Scene& scene) {
  const Parameters& p = scene.contact.wheel_rail;
  RollingSetup setup;
  setup.normal = p.text("normal");
  setup.tangential = p.text("tangential");
  setup.along = static_cast<int>(p.integer("along"));
  setup.across = static_cast<int>(p.integer("across"));
  setup.friction_limit = p.number("friction_limit");
  setup.friction_decay = p.number("friction_decay");
  setup.slowest = p.number("slowest");
  setup.materials = material_table(scene);
  return setup;
}

void add_rolling(Assembly& a) {
  if (!a.plan.rolling) return;
  a.rolling = std::make_unique<RollingRegions>();
  Pipeline& p = a.simulation->pipeline;
  p.narrow_phase = std::make_unique<RollingSearch>(*a.shapes, std::move(p.narrow_phase), *a.rolling);
  p.contact_model = make_rolling_contact(rolling_setup(a.scene), *a.rolling, std::move(p.contact_model));
}

void add_springs(Assembly& a) {
  if (a.scene.springs.empty()) return;
  Pipeline& p = a.simulation->pipeline;
  p.contact_model = make_spring_forces(springs_of(a), way_of(a), a.scene.contact.method.value == Method::smooth,
                                       std::move(p.contact_model));
}

namespace {

/// Half the load of a wheelset: its own loads and the forces of springs [N].
double wheel_load(const World& w, Slot s, const std::vector<SpringElement>& springs) {
  Vec3 force = w.free_acceleration(s) / w.inverse_mass[s];
  for (const SpringElement& e : springs) {
    if (e.body == w.id[s]) force += e.preload;
    if (e.to == w.id[s]) force -= e.preload;
  }
  return std::max(1.0, 0.5 * force.norm());
}

/// Largest velocity of the contacts per unit of creep force at both wheels: along the track by mass and rotation of the
/// axle, across it by mass and roll, in yaw by the moment of inertia.
double creep_mobility(double inverse_mass, const Vec3& inverse_inertia, double radius, double half) {
  const double turn = radius * radius * std::max(inverse_inertia.x(), inverse_inertia.y());
  return std::max(inverse_mass + turn, half * half * inverse_inertia.z());
}

}  // namespace

double swing_on_springs(const Assembly& a) {
  if (a.scene.springs.empty()) return 0.0;
  const double dt = a.time_step.value;
  return 0.25 * dt * dt * spring_rates(springs_of(a), a.simulation->world, *way_of(a)).square;
}

TimeStep railway_step(const Assembly& a) {
  TimeStep out{infinity, infinity, ""};
  const World& w = a.simulation->world;
  const std::vector<SpringElement> elements = springs_of(a);
  const SpringRates springs = spring_rates(elements, w, *way_of(a));
  double square = springs.square, damping = springs.damping;
  std::string what = "springs";
  if (a.plan.rolling) {
    const RollingSetup setup = rolling_setup(a.scene);
    for (Slot s = 0; s < w.size(); ++s) {
      const ShapeRef ref{w.shape[s]};
      if (ref.type() != ShapeStore::type_of<WheelProfile>() || !w.is_movable(s)) continue;
      const Wheelset& set = *a.shapes->of<WheelProfile>()[ref.index()].wheelset;
      const double half = 0.5 * set.geometry.flange_back + set.geometry.tape_circle, r = set.geometry.radius;
      const double load = wheel_load(w, s, elements);
      for (Slot t = 0; t < w.size(); ++t) {
        if (ShapeRef{w.shape[t]}.type() != ShapeStore::type_of<RailProfile>()) continue;
        const MaterialPair& pair = setup.materials.of(w.material[s], w.material[t]);
        const RollingLimits l = rolling_limits(setup, pair, load, r, w.velocity[s].norm());
        const Vec3 i = w.inverse_inertia_of(s);
        const double up = 2.0 * l.stiffness * std::max(w.inverse_mass[s], half * half * i.x());
        const double creep = 2.0 * l.damping * creep_mobility(w.inverse_mass[s], i, r, half);
        if (up > square || creep > damping) what = "wheel on rail";
        square = std::max(square, up + springs.square);
        damping = std::max(damping, creep + springs.damping);
      }
    }
  }
  if (square == 0.0 && damping == 0.0) return out;
  const double omega = std::sqrt(square);
  out.reason = fmt::format("{}: omega = {:.4g} /s, damping {:.4g} /s", what, omega, damping);
  // the energy of velocity Verlet oscillates by (omega dt)^2 / 4: by 0.6 % of all energy where springs alone decide
  const double share = what == "springs" ? 2.0 * std::numbers::pi / 40.0 : 0.3;
  out.value = std::min(omega > 0.0 ? share / omega : infinity, damping > 0.0 ? 0.5 / damping : infinity);
  if (a.scene.contact.method.value != Method::smooth) {
    out.limit = impulse_limit({square, damping});
    return out;
  }
  // velocity Verlet with velocities predicted over half a step: unstable beyond dt = 1/rate of a damper (roots of
  // z^2 - (1 - 3h/2) z - h/2), 2/omega of a spring
  out.limit = std::min(omega > 0.0 ? 2.0 / omega : infinity, damping > 0.0 ? 1.0 / damping : infinity);
  return out;
}

std::string model_remedy(const std::string& reason) {
  using Remedy = std::pair<std::string_view, std::string_view>;
  constexpr std::string_view gap = "normal = \"semi-hertz\" takes the whole gap";
  constexpr std::string_view cells = "tangential = \"fastsim\" knows it";
  constexpr Remedy remedies[] = {
      {"the curvature changes over the patch", gap},
      {"a second region would touch", gap},
      {"the gap is not closed at the contact point", gap},
      {"two ellipses overlap", gap},
      {"two regions near enough", gap},
      {"the overlap leaves the ellipse", gap},
      {"the pressures of the strips do not close", gap},
      {"spin, which the law does not know", cells},
      {"spin: ", cells},
      {"part of the patch sticks", cells},
      {"creepage too large for the linear theory", cells},
      {"spin beside longitudinal creepage", cells},
      {"strips are plane only", cells},
      {"large spin: on the parabolic bound", "tangential = \"fastsim-elliptic\" holds there"},
      {"spin against lateral creepage", "tangential = \"fastrip\" errs by a third of it"},
      {"coarse grid: fewer than 10 cells along", "along = 10 or more resolves it"},
  };
  for (const auto& [start, remedy] : remedies)
    if (reason.starts_with(start)) return "; contact.wheel_rail." + std::string(remedy);
  return {};
}

}  // namespace epafi
