#include "scenes/full_registry.h"

#include "detection/broad/all_broad_phases.h"
#include "detection/shape_store.h"
#include "engine/schemes/all_schemes.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/smooth/make_smooth_contact.h"
#include "laws/wheel_rail/normal_models.h"
#include "laws/wheel_rail/rolling_contact.h"
#include "laws/wheel_rail/tangential_models.h"
#include "viz_export/measures/all_measures.h"

namespace epafi {

namespace {

template <class List>
std::vector<Entry> entries_of(const List& list) {
  std::vector<Entry> out;
  for (const auto& item : list) out.push_back(item.entry);
  return out;
}

Registry make_registry() {
  Registry r;
  r.shapes = shape_entries(AllShapes{});
  r.normal_laws = all_smooth_laws();
  r.tangential_laws = all_tangential_laws();
  r.rolling_laws = all_rolling_laws();
  r.solvers = entries_of(all_solvers());
  r.broad_phases = entries_of(all_broad_phases());
  r.schemes = entries_of(all_schemes());
  for (const auto& s : all_schemes()) (s.smooth ? r.smooth_schemes : r.nonsmooth_schemes).push_back(s.entry.name);
  r.measures = entries_of(all_measures());
  r.rolling_fields = rolling_fields();
  r.patch_normal_models = entries_of(all_normal_models());
  r.patch_tangential_models = entries_of(all_tangential_models());
  return r;
}

}  // namespace

const Registry& full_registry() {
  static const Registry registry = make_registry();
  return registry;
}

}  // namespace epafi
