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

Needs contact_needs(const Scene& scene) {
  if (scene.contact.method.value == Method::nonsmooth) return nonsmooth_needs(nonsmooth_setup(scene));
  const SmoothSetup setup = smooth_setup(scene);
  auto problems = check_smooth(setup);
  std::erase_if(problems, [](const Problem& p) { return p.level != Problem::Level::error; });
  const ContactSettings& c = scene.contact;
  for (Problem& p : problems) p.place = c.law.written() ? c.law.place : c.method.place;  // the default law has no line
  if (!problems.empty()) throw SceneError(problems);
  return smooth_needs(setup);
}

std::unique_ptr<ContactModel> make_contact_model(const Scene& scene) {
  if (scene.contact.method.value == Method::nonsmooth) return make_nonsmooth_contact(nonsmooth_setup(scene));
  return make_smooth_contact(smooth_setup(scene));
}

}  // namespace epafi
