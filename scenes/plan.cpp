#include "scenes/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "detection/broad/all_broad_phases.h"
#include "detection/narrow/pairs/pair_table.h"
#include "laws/smooth/smooth_law.h"
#include "scenes/contact_setup.h"
#include "scenes/start_run.h"

namespace epafi {

namespace {

/// Shapes of free and of other bodies, with the place of one body each.
struct ShapesInUse {
  std::set<std::size_t> free, held;
  double largest = 0.0;        ///< finite radius [m]
  double smallest = infinity;  ///< radius of a free one [m]

  void add(std::size_t shape, double radius, bool moves) {
    (moves ? free : held).insert(shape);
    if (std::isfinite(radius)) largest = std::max(largest, radius);
    if (moves) smallest = std::min(smallest, radius);
  }
};

ShapesInUse shapes_in_use(const Scene& scene, const std::vector<BuiltShape>& shapes) {
  ShapesInUse use;
  for (const auto& b : scene.bodies)
    if (!b.absent) use.add(b.shape, b.size * shapes[b.shape].radius, b.moves());
  for (const auto& f : scene.fills)
    for (std::size_t s : f.shapes) use.add(s, shapes[s].radius, true);
  return use;
}

bool is_isotropic(const Vec3& m) { return m.x() == m.y() && m.y() == m.z(); }

bool is_identity(const Quat& q) { return q.vec().squaredNorm() == 0.0; }

/// Reason why a body is not in its principal axes; null where it is.
const char* turned_by(const BodySpec& b, const BuiltShape& shape) {
  if (!is_identity(b.orientation)) return " is turned";
  return is_identity(shape.frame.orientation) ? nullptr : " is written in other axes than its principal ones";
}

/// True where the motion of the body rotates it.
bool turns(const BodySpec& b) {
  return b.motion && std::ranges::any_of(b.motion->parts, [](const Motion& m) { return m.rotation_rate != 0; });
}

/// The first spring whose ends rotate with their bodies; null: none.
const SpringSpec* spring_beside_centre(const Scene& scene) {
  for (const SpringSpec& s : scene.springs)
    if (s.to || !s.attachment.isZero()) return &s;
  return nullptr;
}

/// Collects the reasons for spins and orientations, the most informative first.
void plan_rotation(const Scene& scene, const std::vector<BuiltShape>& shapes, const ShapesInUse& use, StepPlan& plan) {
  const auto pay = [&](const std::string& why, const Place& where) {
    if (!plan.columns.rotation) plan.costs.push_back({"rotation", why, where});
    plan.columns.rotation = true;
  };
  plan.columns.orientation = plan.columns.free_turn = false;
  const auto stand = [&](const std::string& why, const Place& where) {
    if (!plan.columns.orientation) plan.costs.push_back({"orientation", why, where});
    plan.columns.orientation = true;
  };
  if (plan.needs.rotation) pay("friction exerts a torque", scene.contact.friction.place);
  for (std::size_t s : use.free) {
    if (!shapes[s].is_sphere) {
      const std::string why = "free bodies of shape '" + scene.shapes[s].type + "' turn";
      pay(why, scene.shapes[s].place);
      stand(why, scene.shapes[s].place);
      plan.columns.free_turn = true;
    }
    if (is_isotropic(shapes[s].frame.moments) || plan.columns.anisotropy) continue;
    plan.columns.anisotropy = true;
    plan.costs.push_back({"angular momentum", "unequal principal moments of shape '" + scene.shapes[s].type + "'",
                          scene.shapes[s].place});
  }
  for (const auto& b : scene.bodies) {
    if (b.absent) continue;
    const Place& where = b.spin_place ? *b.spin_place : scene.groups[b.group].place;
    const auto name = [&] {
      return "body '" + body_name(scene, static_cast<std::size_t>(&b - scene.bodies.data())) + "'";
    };
    if (b.angular_velocity.squaredNorm() > 0) pay(name() + " spins", where);
    const bool driven = turns(b);
    if (b.load && b.load->torque) pay(name() + " has a torque", where);
    if (driven) pay(name() + " is driven to rotate", where);
    if (b.servo && scene.contact.method.value == Method::nonsmooth) pay(name() + " is pressed by a servo", where);
    if (shapes[b.shape].is_sphere) continue;
    const char* turned = turned_by(b, shapes[b.shape]);
    if (turned != nullptr) pay(name() + turned, where);
    if (turned != nullptr || driven || b.angular_velocity.squaredNorm() > 0)
      stand(name() + (turned != nullptr ? turned : " turns"), where);
  }
  if (const SpringSpec* spring = spring_beside_centre(scene)) {
    const std::string why = "spring '" + spring->name + "' turns its bodies";
    pay(why, spring->place);
    stand(why, spring->place);
    plan.columns.free_turn = true;
  }
  if (!plan.columns.rotation || !scene.output.orientation.value) return;
  stand("[output] asks for it", scene.output.orientation.place);
  plan.columns.free_turn = true;
}

/// The law by overlap volume handles polyhedra, boxes and half-spaces with sharp edges only.
void refuse_volumeless(const Scene& scene, const ShapesInUse& use) {
  std::vector<Problem> problems;
  for (const auto* list : {&use.free, &use.held}) {
    for (std::size_t s : *list) {
      const ShapeSpec& shape = scene.shapes[s];
      const bool known =
          shape.type == "polyhedron" || shape.type == "solid" || shape.type == "box" || shape.type == "half_space";
      if (known && !(shape.rounding > 0.0)) continue;
      Problem p;
      p.place = shape.place;
      p.text = "law '" + scene.contact.law.value + "' needs sharp polyhedra, boxes and half-spaces, not " +
               (known ? "a rounded " : "a ") + shape.type;
      problems.push_back(p);
    }
  }
  if (!problems.empty()) throw SceneError(std::move(problems));
}

void plan_pairs(const Scene& scene, const std::vector<BuiltShape>& shapes, const ShapesInUse& use, StepPlan& plan) {
  // by type, with one shape of each: a scene may have a shape per body
  std::map<std::uint32_t, std::size_t> free, held;
  for (std::size_t s : use.free) free.emplace(shapes[s].ref.type(), s);
  for (std::size_t s : use.held) held.emplace(shapes[s].ref.type(), s);
  std::set<std::pair<std::uint32_t, std::uint32_t>> cells;
  const auto reach = [&](std::uint32_t a, std::size_t p, std::uint32_t b, std::size_t q) {
    if (!cells.insert(std::minmax(a, b)).second) return;
    const PairCell& cell = pair_table()[std::min(a, b)][std::max(a, b)];
    const std::string method = cell.method;
    if (method != "none")
      plan.pair_cells.push_back(
          {scene.shapes[a <= b ? p : q].type, scene.shapes[a <= b ? q : p].type, method, cell.parts});
  };
  for (const auto& [a, p] : free) {
    for (const auto& [b, q] : free) reach(a, p, b, q);
    for (const auto& [b, q] : held) reach(a, p, b, q);
  }
  if (plan.needs.area) refuse_volumeless(scene, use);
  for (const auto& cell : plan.pair_cells) {
    if (cell.method == "closed-form") continue;
    const auto asked =
        std::find_if(scene.shapes.begin(), scene.shapes.end(), [&](const auto& s) { return s.type == cell.b; });
    plan.costs.push_back({cell.method, "pair " + cell.a + " - " + cell.b + " has no closed form", asked->place});
  }
}

/// Decides on the loop over spheres: free spheres, balls of clumps, held spheres.
void plan_fused_spheres(const Scene& scene, const std::vector<BuiltShape>& shapes, StepPlan& plan) {
  if (scene.contact.method.value != Method::smooth) return;
  std::size_t balls = 0;
  const auto count = [&](std::size_t shape, std::size_t number) {
    balls += number * (shapes[shape].is_sphere ? 1 : balls_of_clump(scene.shapes[shape]));
  };
  for (const auto& b : scene.bodies)
    if (b.moves() && !b.absent) count(b.shape, 1);
  for (const auto& f : scene.fills)
    for (std::size_t s : f.shapes) count(s, 100);  // how many is known later; a fill is many
  if (balls == 0) return;
  constexpr std::size_t fewest = 100;  // below, the layout costs more than the loop gains
  plan.without_fused_spheres = without_tiles(smooth_setup(scene));
  plan.fused_held = !plan.columns.held_force;
  // a scene that starts from a run with this loop keeps it, and with it the friction springs
  const auto made = scene.start ? scene.start->made : nullptr;
  const bool begun = made && made->assembly->plan.fused_spheres;
  if (plan.without_fused_spheres.empty() && balls < fewest && !begun)
    plan.without_fused_spheres = fmt::format("{} free balls, fewer than {}", balls, fewest);
  plan.fused_spheres = plan.columns.states = plan.without_fused_spheres.empty();
}

/// Wheels on rails by laws of rolling contact, and springs: named only where a scene has them.
void plan_railway(const Scene& scene, const ShapesInUse& use, StepPlan& plan) {
  const auto has = [&](const std::set<std::size_t>& shapes, const char* type) {
    return std::any_of(shapes.begin(), shapes.end(), [&](std::size_t s) { return scene.shapes[s].type == type; });
  };
  const ContactSettings& c = scene.contact;
  const bool wheels = has(use.free, "wheel_profile") && has(use.held, "rail_profile");
  plan.rolling = wheels && c.method.value == Method::smooth;
  if (plan.rolling)
    plan.costs.push_back({"rolling contact",
                          "wheels on rails: " + c.wheel_rail.text("normal") + " and " + c.wheel_rail.text("tangential"),
                          c.wheel_rail_place.line > 0 ? c.wheel_rail_place : c.method.place});
  if (!scene.springs.empty())
    plan.costs.push_back(
        {"springs", fmt::format("{} between bodies and frames", scene.springs.size()), scene.springs.front().place});
}

}  // namespace

std::string StepPlan::reason(const std::string& cost) const {
  for (const auto& c : costs)
    if (c.name == cost) return fmt::format("{}:{}", c.where.file, c.where.line);
  return "not paid";
}

namespace {

/// Notes the costs that the scene has, and those that it does not have.
struct Bill {
  StepPlan& plan;
  void pay(bool needed, const char* name, const char* why, const Place& where) const {
    if (needed)
      plan.costs.push_back({name, why, where});
    else
      plan.not_paid.push_back(name);
  }
};

void plan_laws(const Scene& scene, const Bill& bill, bool smooth) {
  const StepPlan& plan = bill.plan;
  const ContactSettings& c = scene.contact;
  bill.pay(plan.needs.memory, smooth ? "contact history" : "warm start",
           smooth ? "friction springs, forces of dashpots and what else laws remember"
                  : "impulses of the last step start the solver",
           smooth ? c.law.place : c.method.place);
  bill.pay(plan.needs.curvature, "curvature", "the law needs the radius of the contact", c.law.place);
  bill.pay(plan.needs.area, "overlap volume", "the law takes the volume of the overlap", c.law.place);
  bill.pay(plan.needs.contact_moment, "contact moment", "rolling friction", c.rolling_friction.place);
}

/// Costs by properties of single bodies.
void plan_bodies(const Scene& scene, const Bill& bill, bool smooth) {
  StepPlan& plan = bill.plan;
  const auto find = [&](const auto& asks) -> const Place* {
    const auto b = std::find_if(scene.bodies.begin(), scene.bodies.end(), asks);
    return b == scene.bodies.end() ? nullptr : &scene.groups[b->group].place;
  };
  const auto pay = [&](const Place* where, const char* name, const char* why) {
    bill.pay(where != nullptr, name, why, where != nullptr ? *where : Place{});
    return where != nullptr;
  };
  plan.columns.external_force = pay(find([](const BodySpec& b) { return b.force || (b.load && b.load->force); }),
                                    "external force", "a body has an external force");
  const auto timed = [](const BodySpec& b) { return b.load.has_value(); };
  const Place none{};
  if (const Place* where = find(timed); where || scene.loose_gravity)
    bill.pay(true, "work of loads", "gravity, forces or torques that depend on time, or a torque",
             where ? *where : none);
  plan.columns.loose_force = find([](const BodySpec& b) { return b.load && b.load->force; }) != nullptr;
  plan.columns.external_torque = find([](const BodySpec& b) { return b.load && b.load->torque; }) != nullptr;
  plan.columns.periodic = pay(scene.cell ? &scene.cell->place : nullptr, "images",
                              "the domain repeats: images of bodies at its faces, cells crossed by each body");
  const Place* servo = find([](const BodySpec& b) { return b.servo.has_value(); });
  plan.columns.held_force = smooth && pay(servo, "force on walls", "a servo needs the force on its wall");
  const Place* turned = find([](const BodySpec& b) { return b.servo && turns(b); });
  if (!smooth && turned != nullptr)
    throw SceneError(
        "a servo presses beside a rotation in smooth contact only; take the rotation out or write contact.method = "
        "\"smooth\"",
        *turned);
  pay(scene.run.adaptive ? &scene.run.time_step.place : nullptr, "speed of all bodies",
      "time_step = \"adaptive\" needs it before every step");
  const Place* swift = find([](const BodySpec& b) { return b.continuous; });
  pay(swift, "continuous", "a body is watched along its path within a step");
  if (smooth && swift != nullptr)
    throw SceneError(
        "continuous = true holds bodies at impulses, a smooth law needs steps within its contact; leave it out with "
        "time_step = \"auto\", or take contact.method = \"nonsmooth\"",
        *swift);
}

void plan_reach(const Scene& scene, const ShapesInUse& use, bool smooth, StepPlan& plan) {
  if (smooth) {
    plan.reach = plan.resting_reach = smooth_reach(smooth_setup(scene), use.largest);
    return;
  }
  const double smallest = use.smallest;
  if (!std::isfinite(smallest)) return;
  // Contacts are predicted as far as bodies move in a step chosen by the program: by a quarter of the smallest diameter
  // each (time_step_nonsmooth.h). Bodies that move further in a longer written step are found overlapping. Slow pairs
  // have a smaller reach (follow_motion).
  plan.reach = 0.5 * smallest;
  plan.resting_reach = 0.005 * smallest;
}

}  // namespace

std::size_t balls_of_clump(const ShapeSpec& shape) {
  return shape.type == "clump" ? shape.parameters.numbers("spheres").size() / 4 : 0;
}

StepPlan plan(const Scene& scene, const std::vector<BuiltShape>& shapes, bool may_fuse) {
  StepPlan plan;
  const bool smooth = scene.contact.method.value == Method::smooth;
  const ShapesInUse use = shapes_in_use(scene, shapes);
  plan.needs = contact_needs(scene);
  plan.columns.force = smooth;
  plan_rotation(scene, shapes, use, plan);
  if (!plan.columns.rotation) plan.not_paid.push_back("rotation");
  if (!plan.columns.orientation) plan.not_paid.push_back("orientation");
  if (!plan.columns.anisotropy) plan.not_paid.push_back("angular momentum");
  plan_laws(scene, {plan}, smooth);
  plan_bodies(scene, {plan}, smooth);
  plan_pairs(scene, shapes, use, plan);
  plan_reach(scene, use, smooth, plan);
  if (may_fuse) plan_fused_spheres(scene, shapes, plan);
  plan_railway(scene, use, plan);
  plan.memory = plan_memory(scene, plan);
  return plan;
}

}  // namespace epafi
