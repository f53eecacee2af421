#include "scenes/stability_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "laws/smooth/contact_links.h"
#include "laws/springs/spring_links.h"
#include "scenes/contact_setup.h"
#include "scenes/railway/rolling.h"

namespace epafi {

namespace {

// Bounds of the largest eigenvalue, which is (step/limit)^2 without dampers: unstable beyond 1.
constexpr double most_chosen = 0.5;  // for a step chosen by the program: beyond, it is divided
constexpr double aim_chosen = 0.3;   // to about half the limit, with an energy error of 1 % of one oscillation
constexpr double grown = 1.15;      // growth of the largest overlap: changes Hertz stiffness by 7 %, the limit by 3.5 %
constexpr std::uint64_t soon = 10;  // steps to the second check of a written step that is unstable
constexpr int most_parts = 10000;

/// Contacts and springs of a state.
class LinkSource {
 public:
  explicit LinkSource(const Assembly& a) : contacts_(smooth_setup(a.scene)), springs_(springs_of(a)) {
    for (std::size_t k = 0; k < a.scene.bodies.size(); ++k)
      if (const auto& pressing = a.scene.bodies[k].servo; pressing && !pressing->servo.has_gains())
        walls_.push_back({a.id_of(k), pressing->servo});  // the scene lets its bodies go
  }

  void read(const World& world, const ContactPieces& pieces, double dt, std::vector<StiffLink>& links) const {
    links.clear();
    for (std::size_t k = 0; k < pieces.size(); ++k)
      pieces.read(k, [&](const ContactSet& c, std::size_t begin, std::size_t end) {
        contacts_.append(world, c, begin, end, dt, links);
      });
    append_spring_links(springs_, world, dt, links);
  }
  bool has_walls() const { return !walls_.empty(); }
  std::vector<PressedBody> pressed(double dt) const {
    std::vector<PressedBody> out;
    for (const Wall& w : walls_) out.push_back({w.body, w.servo.direction, w.servo.mass_in_step(dt)});
    return out;
  }

 private:
  struct Wall {
    BodyId body;
    Servo servo;
  };
  ContactLinks contacts_;
  std::vector<SpringElement> springs_;
  std::vector<Wall> walls_;
};

class StabilityWatch final : public StepWatch {
 public:
  explicit StabilityWatch(const Assembly& a)
      : source_(a),
        names_(a),
        written_(a.scene.run.time_step.value.has_value()),
        interval_(a.plan.fused_spheres ? 1000 : 100) {}

  bool is_due(std::uint64_t step) const override { return step >= state_.next_look; }
  void note(std::uint64_t step, double deepest) override {
    if (deepest > grown * state_.known) state_.next_look = std::min(state_.next_look, step + 1);
    state_.deepest = deepest;
  }
  bool passes(std::uint64_t step, double bound) override;
  std::optional<Failure> look(const StepView& view) override;
  int parts() const override { return state_.parts; }
  void visit(StateVisitor& visitor) override { visitor.value("stability_watch", state_); }

 private:
  struct State {  // plain: one value of the checkpoint
    std::uint64_t next_look = 0;
    double known = 0.0;    ///< largest overlap at a check [m]
    double deepest = 0.0;  ///< of the last step [m]
    int parts = 1;
    int unstable = 0;  ///< consecutive checks above the limit
  };
  StiffestMode mode(const StepView& view, int parts, double enough) {
    source_.read(view.world, view.pieces(), view.dt / parts, links_);
    return stiffest_mode(view.world, links_, enough, source_.pressed(view.dt / parts));
  }
  void divide(const StepView& view, double value);
  Failure failure(const StepView& view, const StiffestMode& mode) const;

  LinkSource source_;
  const Assembly& names_;
  bool written_;
  std::uint64_t interval_;
  State state_;
  std::vector<StiffLink> links_;
};

/// True where a bound of the eigenvalue shows that the undivided step is stable.
bool StabilityWatch::passes(std::uint64_t step, double bound) {
  if (state_.parts > 1 || !(bound < (written_ ? 1.0 : most_chosen))) return false;
  state_.next_look = step + interval_;
  state_.known = std::max(state_.known, state_.deepest);
  state_.unstable = 0;
  return true;
}

std::optional<Failure> StabilityWatch::look(const StepView& view) {
  const double most = written_ ? 1.0 : most_chosen;
  const StiffestMode now = mode(view, state_.parts, most);
  state_.next_look = view.step + interval_;
  state_.known = std::max(state_.known, state_.deepest);
  if (!written_) {
    divide(view, now.value);
    return std::nullopt;
  }
  state_.unstable = now.value > 1.0 ? state_.unstable + 1 : 0;
  if (state_.unstable == 0) return std::nullopt;
  if (state_.unstable > 1) return failure(view, now);
  state_.next_look = view.step + soon;
  return std::nullopt;
}

/// Sets the number of substeps; value: eigenvalue at the present number. Increases at once, decreases only where the
/// state is much softer.
void StabilityWatch::divide(const StepView& view, double value) {
  const int before = state_.parts;
  if (value <= most_chosen) {
    // the eigenvalue changes at most with the square of the number
    const int fewer = static_cast<int>(std::ceil(before * std::sqrt(std::max(value, 1e-12) / aim_chosen)));
    if (fewer >= before) return;
    state_.parts = std::max(1, fewer);
    state_.known = state_.deepest;
    return;
  }
  int parts = before;
  for (int k = 0; k < 4 && value > aim_chosen && parts < most_parts; ++k) {
    parts = std::min(most_parts, static_cast<int>(std::ceil(parts * std::sqrt(value / aim_chosen))));
    value = mode(view, parts, 0.0).value;
  }
  state_.parts = parts;
}

Failure StabilityWatch::failure(const StepView& view, const StiffestMode& mode) const {
  const StiffLink& l = links_[mode.link];
  const Slot other = l.a == mode.body ? l.b : l.a;
  const BodyId body = view.world.id[mode.body];
  const std::string with = other == no_slot ? "a spring" : "'" + body_name(names_, view.world.id[other]) + "'";
  const double force_side = std::max(l.along, l.across);
  std::string text = fmt::format(
      "the time step of {:.4g} s became unstable in step {}: the {} contacts of '{}' (the stiffest with {}, spring "
      "and damper {:.3g} kg) reach {:.3g} of the stable limit; a stable step is {:.4g} s or less; use time_step = "
      "\"auto\"",
      view.dt, view.step, mode.links, body_name(names_, body), with, force_side, mode.value,
      view.dt / std::max(1.0, std::sqrt(mode.value)));
  return {"unstable time step", view.step, body, std::move(text)};
}

}  // namespace

std::unique_ptr<StepWatch> make_stability_watch(const Assembly& a) {
  if (a.scene.contact.method.value != Method::smooth || a.scene.run.allow_unstable) return nullptr;
  if (a.plan.rolling) return nullptr;  // contacts of wheels on rails are not among those that it knows
  return std::make_unique<StabilityWatch>(a);
}

std::function<double(const World&, const ContactPieces&, double)> stiffness_of_parts(const Assembly& a) {
  const auto source = std::make_shared<const LinkSource>(a);
  if (source->has_walls()) return {};
  return [source](const World& world, const ContactPieces& pieces, double dt) {
    std::vector<StiffLink> links;
    source->read(world, pieces, dt, links);
    return stiffness_bound(world, links);
  };
}

double stable_step_now(const Assembly& a) {
  const LinkSource source(a);
  const Simulation& sim = *a.simulation;
  const ContactPieces pieces(sim.world, sim.work.contacts, sim.pipeline.contact_model.get());
  std::vector<StiffLink> links;
  double dt = sim.time_step;
  for (int k = 0; k < 60; ++k) {  // strong dampers: the value hardly falls with the step
    source.read(sim.world, pieces, dt, links);
    const double value = stiffest_mode(sim.world, links, 0.0, source.pressed(dt)).value;
    if (!(value > 0.0)) return infinity;
    if (std::abs(value - 1.0) < 1e-3) break;
    dt /= std::sqrt(value);
  }
  return dt;
}

}  // namespace epafi
