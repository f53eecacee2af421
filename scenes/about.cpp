#include "scenes/about.h"

namespace epafi {

RunAbout about_of(const Assembly& assembly) {
  const Scene& scene = assembly.scene;
  RunAbout out;
  for (const MaterialSpec& m : scene.materials) out.materials.push_back(m.material.name);
  for (const GroupSpec& g : scene.groups)
    out.groups.push_back({g.name, static_cast<std::uint32_t>(g.first), static_cast<std::uint32_t>(g.count)});
  for (std::size_t f = 0; f < assembly.fill_ids.size(); ++f) {  // consecutive ids
    const auto& ids = assembly.fill_ids[f];
    if (ids.empty()) continue;
    out.groups.push_back(
        {scene.fills[f].name, static_cast<std::uint32_t>(ids.front()), static_cast<std::uint32_t>(ids.size())});
  }
  for (const SpringSpec& s : scene.springs) {
    RunAbout::Spring spring{s.name, static_cast<std::uint32_t>(s.body), {}, s.attachment};
    if (s.to) spring.to = static_cast<std::uint32_t>(*s.to);
    out.springs.push_back(std::move(spring));
  }
  out.gravity = assembly.simulation->world.gravity;
  for (const StageSpec& stage : scene.stages) out.duration += stage.duration;
  out.view = scene.view;
  return out;
}

}  // namespace epafi
