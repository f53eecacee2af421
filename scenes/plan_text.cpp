// The text of `epafi explain`: a table of costs that fits 80 columns, then one line per other fact.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "scenes/plan.h"
#include "scenes/wrapped_text.h"

namespace epafi {

namespace {

constexpr std::size_t why_width = 40;  ///< beside a cost of 20 characters and the name of a file with a line

/// A place in the scene's own file without the folder, which the first line names.
std::string place_text(const Scene& scene, const Place& place) {
  if (place.line <= 0) return "default";
  const std::string file =
      place.file == scene.file ? std::filesystem::path(place.file).filename().string() : place.file;
  return fmt::format("{}:{}", file, place.line);
}

/// A row of the table; what is too long for the middle column continues below it.
std::string cost_row(const std::string& cost, const std::string& why, const std::string& where) {
  const std::vector<std::string> lines = wrapped(why, why_width);
  std::string out = fmt::format(" {:<20} {:<{}} {}\n", cost, lines.front(), why_width, where);
  for (std::size_t i = 1; i < lines.size(); ++i) out += fmt::format(" {:<20} {}\n", "", lines[i]);
  return out;
}

std::string cost_table(const Scene& scene, const StepPlan& plan) {
  std::string out = cost_row("cost", "why", "where");
  for (const Cost& c : plan.costs) out += cost_row(c.name, c.why, place_text(scene, c.where));
  return out + cost_row(plan.broad_phase, "broad phase: " + plan.broad_phase_reason,
                        place_text(scene, scene.detection.broad_phase.place));
}

/// Pairs that the loop of spheres leaves to the generic one, and why.
std::string left_out_text(const Scene& scene, const StepPlan& plan) {
  const auto is_round = [](const std::string& type) { return type == "sphere" || type == "clump"; };
  std::string walls;
  for (const ReachableCell& p : plan.pair_cells) {
    const bool wall = is_round(p.a) != is_round(p.b);
    const std::string& other = is_round(p.a) ? p.b : p.a;
    if (wall && other != "half_space") walls += fmt::format("{}{}-{}", walls.empty() ? "" : ", ", p.a, p.b);
  }
  if (!walls.empty()) walls += ": a body of other shape than a fixed half-space; ";
  const bool driven = std::ranges::any_of(scene.bodies, [&](const BodySpec& b) {
    return !b.fixed && !b.absent && scene.shapes[b.shape].type == "half_space";
  });
  return walls + (driven ? "half-spaces that are driven; " : "");
}

std::string sphere_loop_text(const Scene& scene, const StepPlan& plan) {
  if (!plan.fused_spheres)
    return plan.without_fused_spheres.empty()
               ? ""
               : " loop of spheres: not used, as there are " + plan.without_fused_spheres + "\n";
  const bool has_clumps =
      std::ranges::any_of(scene.shapes, [](const ShapeSpec& shape) { return balls_of_clump(shape) > 0; });
  return fmt::format(
      " loop of spheres: contacts among {}spheres{} and with fixed half-spaces; generic loop: {}all other pairs\n",
      plan.fused_held ? "" : "free ", has_clumps ? ", balls of clumps" : "", left_out_text(scene, plan));
}

std::string memory_text(const MemoryPlan& m, const ShapeStore& shapes) {
  std::string out = fmt::format(
      " per body {} B, per contact {} B\n beside these {} B per body and {} B per listed pair for the search of "
      "neighbours",
      m.body, m.contact, m.list, m.pair);
  if (const std::size_t hulls = shapes.of<ConvexHull>().size(); hulls > 0)
    out += fmt::format(", {} B for each of {} polyhedra", polyhedra_bytes(shapes) / hulls, hulls);
  return out + "\n";
}

}  // namespace

std::string explain(const Scene& scene, const StepPlan& plan, const ShapeStore& shapes) {
  std::string out =
      fmt::format("{}: {} contact, {} bodies{}\n", scene.file,
                  scene.contact.method.value == Method::smooth ? "smooth" : "non-smooth", scene.bodies.size(),
                  scene.fills.empty() ? "" : fmt::format(" and those of {} [[fill]]", scene.fills.size()));
  out += cost_table(scene, plan);
  out += " NOT paid: ";
  for (std::size_t i = 0; i < plan.not_paid.size(); ++i) out += (i > 0 ? ", " : "") + plan.not_paid[i];
  out += "\n pairs:";
  for (const ReachableCell& p : plan.pair_cells) out += fmt::format(" {}-{} ({})", p.a, p.b, p.method);
  return out + "\n" + sphere_loop_text(scene, plan) + memory_text(plan.memory, shapes);
}

}  // namespace epafi
