#include "laws/nonsmooth/impact.h"

#include <queue>

#include "engine/threads/parallel.h"
#include "laws/nonsmooth/solvers/nsgs.h"

namespace epafi {

namespace {
constexpr double rounding = 1e-12;  // relative to the fastest approach: slower ones are no impacts
constexpr std::size_t most_events =
    1000;  // per contact and step; 314 collisions of the billiard take 3 in its worst step
constexpr double closed_share = 1e-9;
constexpr int most_sweeps = 2000;
}  // namespace

ImpactLaw impact_law(const Parameters& parameters) {
  const std::string name = parameters.has("impact") ? parameters.text("impact") : "energetic";
  if (name == "newton") return ImpactLaw::newton;
  if (name == "poisson") return ImpactLaw::poisson;
  return name == "sequential" ? ImpactLaw::sequential : ImpactLaw::energetic;
}

/// Approaches at the middle, and whether there is an impact.
bool Impacts::find(const ContactProblem& problem, const Step& step) {
  const std::size_t n = problem.size();
  approach_.resize(n);
  pull_.resize(n);
  parallel_for(n, [&](std::size_t i) {
    const double last = -problem.relative_velocity(i, problem.free).x();
    approach_[i] = 0.5 * (last - problem.relative_velocity(i, step.before).x());
    pull_[i] = last - approach_[i];
  });
  bool any = false;
  fastest_ = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const bool closes = step.gap[i] <= 0.0 || step.gap[i] < step.dt * (approach_[i] + pull_[i]);
    if (problem.mobility[i] <= 0.0) continue;
    if (closes) fastest_ = std::max(fastest_, approach_[i]);
    any = any || step.restitution[i] > 0.0;
  }
  threshold_ = std::max(step.threshold, rounding * fastest_);
  return any && fastest_ > threshold_;
}

void Impacts::poisson(const Step& step, ContactSolver& solver) {
  // touching: gravity alone closes the gap within the step, or the fastest body within a billionth of it
  const double touching = step.dt * std::max(step.threshold, closed_share * fastest_);
  for (std::size_t i = 0; i < impact_.size(); ++i)
    if (step.gap[i] > touching && step.gap[i] >= step.dt * (approach_[i] + pull_[i])) impact_.leave_out(i);
  r_c_.assign(impact_.size(), Vec3::Zero());
  solver.solve(impact_, r_c_);
  r_ = r_c_;
  for (const Vec3& r : r_c_) events_ += r.x() > 0.0;
  expand(step);
}

/// r_ += the impulses of the expansion: sweeps of r_N = max(e r_cN, ...) and r_T on the disk of mu r_N.
void Impacts::expand(const Step& step) {
  const std::size_t n = impact_.size();
  BodyVelocities v;
  impact_.velocities(r_c_, v);
  Impulses e(n, Vec3::Zero());
  double total = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    e[i].x() = step.restitution[i] * r_c_[i].x();
    total += e[i].squaredNorm();
    impact_.push(v, i, e[i]);
  }
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double change = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const Mat3& w = impact_.diagonal[i];
      if (w(0, 0) <= 0.0) continue;
      const Vec3 u = impact_.relative_velocity(i, v);
      const double normal = std::max(step.restitution[i] * r_c_[i].x(), e[i].x() - u.x() / w(0, 0));
      const Vec3 slip = u + w.col(0) * (normal - e[i].x());
      const double largest = 0.5 * (w(1, 1) + w(2, 2)) + std::hypot(0.5 * (w(1, 1) - w(2, 2)), w(1, 2));
      const double mu = impact_.friction[i];
      const Vec3 next =
          project_disk({normal, e[i].y() - slip.y() / largest, e[i].z() - slip.z() / largest}, mu * normal);
      impact_.push(v, i, next - e[i]);
      change += (next - e[i]).squaredNorm();
      e[i] = next;
    }
    if (change <= 1e-28 * total) break;
  }
  for (std::size_t i = 0; i < n; ++i) r_[i] += e[i];
}

void Impacts::sequential(const Step& step) {
  struct Event {
    double time;
    std::uint32_t contact, stamp;
    bool operator>(const Event& o) const { return std::pair(time, contact) > std::pair(o.time, o.contact); }
  };
  const std::size_t n = impact_.size();
  BodyVelocities& v = impact_.free;
  std::vector<double> gap(step.gap.begin(), step.gap.end()), since(n, 0.0);
  std::vector<std::uint32_t> stamp(n, 0);
  std::priority_queue<Event, std::vector<Event>, std::greater<>> queue;
  const auto gravity = [&](std::size_t i) { return 2.0 * pull_[i] / step.dt; };  // closes the gap, [m/s^2]
  const auto expect = [&](std::uint32_t i, double now) {
    if (impact_.mobility[i] <= 0.0 || approach_[i] <= threshold_) return;
    const double g = std::max(0.0, gap[i]), root = approach_[i] * approach_[i] + 2.0 * gravity(i) * g;
    if (root < 0.0) return;  // reverses before it touches
    const double later = 2.0 * g / (approach_[i] + std::sqrt(root));
    if (now + later < step.dt) queue.push({now + later, i, stamp[i]});
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    if (gap[i] > 0.0) gap[i] -= 0.25 * step.dt * pull_[i];  // positions in the middle are those of v_k alone
    expect(i, 0.0);
  }
  std::uint64_t done = 0;
  while (!queue.empty() && done < most_events * n) {
    const Event event = queue.top();
    queue.pop();
    const std::uint32_t i = event.contact;
    if (event.stamp != stamp[i]) continue;
    Vec3 q = impact_.relative_velocity(i, v);
    q.x() = (1.0 + step.restitution[i]) * (q.x() - gravity(i) * event.time);
    const Vec3 r = NsgsRule::solve(NsgsRule::pack(impact_.diagonal[i]), impact_.friction[i], q);
    impact_.push(v, i, r);
    impact_.push(shift_, i, -event.time * r);
    r_[i] += r;
    ++done;
    for (const Slot s : {impact_.a[i], impact_.b[i]}) {
      if (!impact_.is_free(s)) continue;
      impact_.incidence.for_each(s, [&](std::uint32_t k, double) {
        const double passed = event.time - since[k];
        gap[k] -= (approach_[k] + 0.5 * gravity(k) * passed) * passed;
        since[k] = event.time;
        if (k == i) gap[k] = std::min(gap[k], 0.0);  // closed, whatever rounding says
        approach_[k] = -impact_.relative_velocity(k, v).x() + gravity(k) * event.time;
        ++stamp[k];
        expect(k, event.time);
      });
    }
  }
  events_ += done;
  for (; !queue.empty(); queue.pop()) left_ += queue.top().stamp == stamp[queue.top().contact];
}

bool Impacts::apply(ContactProblem& problem, const Step& step, ContactSolver& solver) {
  if (!find(problem, step)) return false;
  impact_ = problem;
  const auto middle = [](std::vector<Vec3>& free, const std::vector<Vec3>& before) {
    for (std::size_t s = 0; s < free.size(); ++s) free[s] = 0.5 * (free[s] + before[s]);
  };
  middle(impact_.free.linear, step.before.linear);
  middle(impact_.free.angular, step.before.angular);
  impact_.offset.assign(problem.size(), 0.0);
  r_.assign(problem.size(), Vec3::Zero());
  shift_.linear.assign(problem.free.linear.size(), Vec3::Zero());
  shift_.angular.assign(problem.free.angular.size(), Vec3::Zero());
  if (law_ == ImpactLaw::poisson)
    poisson(step, solver);
  else
    sequential(step);
  for (std::size_t i = 0; i < problem.size(); ++i) impact_.push(problem.free, i, r_[i]);
  return true;
}

}  // namespace epafi
