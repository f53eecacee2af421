#include "scenes/scene_hash.h"

#include "engine/state/hash.h"
#include "viz_export/files/side_file.h"

namespace epafi {

namespace {

/// with_files: also hashes files that only stages and tables name; earlier versions did not.
std::string scene_hash(const Scene& scene, bool with_files) {
  Hash hash;
  hash.add(scene.text);
  for (const auto& shape : scene.shapes) {  // files that the text only names
    for (const char* key : {"file", "irregularity.file"})
      if (shape.parameters.has(key)) hash.add(read_whole_file(shape.parameters.text(key)));
    if (!shape.parameters.has("vertices")) continue;
    for (const Vec3& v : shape.parameters.vectors("vertices")) hash.add(v.data(), 3);
  }
  for (const auto& body : scene.bodies) {
    hash.add(body.position.data(), 3);
    hash.add(body.velocity.data(), 3);
  }
  for (std::size_t k = 0; with_files && k < scene.files.size(); ++k) hash.add(read_whole_file(scene.files[k]));
  return hash.hex();
}

}  // namespace

std::string scene_hash(const Scene& scene) { return scene_hash(scene, true); }

bool has_hash(const Scene& scene, const std::string& hash) {
  return scene_hash(scene) == hash || scene_hash(scene, false) == hash;
}

}  // namespace epafi
