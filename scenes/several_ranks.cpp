#include "scenes/several_ranks.h"

#include <fmt/format.h>

#include <algorithm>

#include "detection/narrow/on_surface.h"
#include "laws/nonsmooth/shared_sweeps.h"
#include "scenes/stability_watch.h"

namespace epafi {

namespace {

class Refusals {
 public:
  void add(bool wrong, const Place& place, const std::string& what, const std::string& instead) {
    if (wrong)
      problems_.push_back({Problem::Level::error, place,
                           fmt::format("{} cannot be shared out over several processes; {}", what, instead)});
  }
  void raise() const {
    if (!problems_.empty()) throw SceneError(problems_);
  }

 private:
  std::vector<Problem> problems_;
};

constexpr const char* run_alone = "take threads: run the scene without `mpi N`, with -t N";

void refuse_wheelsets(const Scene& scene, Refusals& refusals) {
  for (const BodySpec& b : scene.bodies)
    if (!b.absent && b.on_rails) return refusals.add(true, scene.groups[b.group].place, "a wheelset", run_alone);
}

void refuse(const Scene& scene, bool rolls, Refusals& refusals) {
  refusals.add(rolls, scene.contact.wheel_rail_place, "wheel on rail", run_alone);
  // non-smooth steps are made by process 0
  if (scene.contact.method.value == Method::smooth) refuse_wheelsets(scene, refusals);
}

}  // namespace

void check_shareable(const Assembly& a) {
  Refusals now;
  refuse(a.scene, a.rolling != nullptr, now);
  now.raise();
  for (std::size_t k = a.scene.stage + 1; k < a.scene.stages.size(); ++k) {
    Refusals later;
    refuse(a.scene.stage_of(k), false, later);  // wheels and rails are those of the first stage
    later.raise();
  }
}

namespace {

/// True where free bodies with flat faces may act as walls to each other (detection/narrow/seams.h).
bool has_flat_bodies(const Assembly& a) {
  const auto flat = [&](std::uint32_t shape) { return is_free_wall(*a.shapes, ShapeRef{shape}); };
  const World& world = a.simulation->world;
  for (Slot s = 0; s < world.size(); ++s)
    if (world.is_movable(s) && flat(world.shape[s])) return true;
  return std::ranges::any_of(a.sources, [&](const PourBodies* source) {
    return std::ranges::any_of(source->setup().bodies, [&](const WaitingBody& b) { return flat(b.body.shape); });
  });
}

bool has_only_spheres(const Assembly& a) {
  const World& world = a.simulation->world;
  const auto is = [&](std::uint32_t type, std::uint32_t shape) { return ShapeRef{shape}.type() == type; };
  for (Slot s = 0; s < world.size(); ++s)
    if (!is(world.is_movable(s) ? ShapeStore::type_of<Sphere>() : ShapeStore::type_of<HalfSpace>(), world.shape[s]))
      return false;
  return a.sources.empty() && a.scene.springs.empty() &&
         std::ranges::none_of(a.simulation->events, [](const auto& event) { return event->is_local(); });
}

std::vector<std::pair<BodyId, BodyId>> tied_bodies(const Assembly& a) {
  std::vector<std::pair<BodyId, BodyId>> tied;
  for (const SpringSpec& s : a.scene.springs)
    if (s.to) tied.emplace_back(a.id_of(s.body), a.id_of(*s.to));
  return tied;
}

}  // namespace

PartSetup part_setup(const Assembly& a) {
  const auto radius = [shapes = a.shapes](std::uint32_t shape) { return shapes->bounding_radius(ShapeRef{shape}); };
  const bool smooth = a.scene.contact.method.value == Method::smooth;
  const auto is_clump = [](std::uint32_t shape) { return ShapeRef{shape}.type() == ShapeStore::type_of<Clump>(); };
  return {smooth ? PartSetup::Shares::steps : PartSetup::Shares::contacts,
          a.plan.reach,
          radius,
          is_clump,
          smooth && has_flat_bodies(a) ? 3 : 1,
          smooth ? stiffness_of_parts(a) : decltype(PartSetup::stiffness){},
          a.scene.cell && a.scene.cell->deforms,
          tied_bodies(a),
          help_with_sweeps,
          has_only_spheres(a)};
}

void share_out(Assembly& whole, std::unique_ptr<Assembly> part, RankTeam& team) {
  const PartSetup setup = part_setup(*part);
  const std::shared_ptr<Assembly> kept = std::move(part);
  team.lead(*whole.simulation, {kept, kept->simulation.get()}, setup);
}

}  // namespace epafi
