#include "scenes/contact_setup.h"

#include "laws/nonsmooth/nonsmooth_contact.h"

namespace epafi {

SmoothSetup smooth_setup(const Scene& scene) {
  const ContactSettings& c = scene.contact;
  return {c.law.value, c.tangential.value, c.rolling.value, material_table(scene), c.locate_edges};
}

namespace {

NonsmoothSetup nonsmooth_setup(const Scene& scene) {
  return {scene.contact.solver.value, scene.contact.nonsmooth, material_table(scene)};
}

}  // namespace

std::vector<Problem> contact_problems(const Scene& scene) {
  const ContactSettings& c = scene.contact;
  if (c.method.value == Method::nonsmooth) return {};
  auto problems = check_smooth(smooth_setup(scene));
  for (Problem& p : problems) p.place = c.law.written() ? c.law.place : c.method.place;  // the default law has no line
  return problems;
}

Needs contact_needs(const Scene& scene) {
  if (scene.contact.method.value == Method::nonsmooth) return nonsmooth_needs(nonsmooth_setup(scene));
  auto problems = contact_problems(scene);
  std::erase_if(problems, [](const Problem& p) { return p.level != Problem::Level::error; });
  if (!problems.empty()) throw SceneError(problems);
  return smooth_needs(smooth_setup(scene));
}

std::unique_ptr<ContactModel> make_contact_model(const Scene& scene) {
  if (scene.contact.method.value == Method::nonsmooth) return make_nonsmooth_contact(nonsmooth_setup(scene));
  return make_smooth_contact(smooth_setup(scene));
}

}  // namespace epafi
