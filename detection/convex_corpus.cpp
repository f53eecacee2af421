#include "detection/convex_corpus.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "engine/units/error.h"

namespace epafi {
namespace {

/// Reads a file in memory from front to back.
class CorpusReader {
 public:
  CorpusReader(std::string bytes, std::string path) : bytes_(std::move(bytes)), path_(std::move(path)) {}

  std::vector<CorpusPair> read() {
    if (bytes_.size() < 12 || bytes_.compare(0, 4, "CXP1") != 0)
      throw SceneError("no corpus of convex pairs: it begins with '" + bytes_.substr(0, 4) + "', expected 'CXP1'",
                       {path_, 0, 0});
    at_ = 4;
    const auto count = get<std::uint32_t>(), kinds = get<std::uint32_t>();
    std::vector<std::string> names;
    for (std::uint32_t k = 0; k < kinds; ++k) {
      const std::size_t length = get<std::uint8_t>();
      need(length);
      names.push_back(bytes_.substr(at_, length));
      at_ += length;
    }
    std::vector<CorpusPair> pairs;
    for (std::uint32_t p = 0; p < count; ++p) pairs.push_back(read_pair(names));
    return pairs;
  }

 private:
  void need(std::size_t more) const {
    if (bytes_.size() - at_ >= more) return;
    throw SceneError(fmt::format("the corpus breaks off at byte {}: {} more are needed, {} are left", at_, more,
                                 bytes_.size() - at_),
                     {path_, 0, 0});
  }
  template <class T>
  T get() {
    need(sizeof(T));
    T value{};
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  Vec3 vec() {
    const double x = get<double>(), y = get<double>(), z = get<double>();
    return {x, y, z};
  }
  void read_faces(std::size_t count, CorpusBody& body) {
    for (std::size_t f = 0; f < count; ++f) {
      const std::uint32_t i = get<std::uint8_t>(), j = get<std::uint8_t>(), k = get<std::uint8_t>();
      body.faces.push_back({i, j, k});
    }
  }
  CorpusPair read_pair(const std::vector<std::string>& names) {
    CorpusPair p;
    const std::size_t category = get<std::uint16_t>();
    if (category >= names.size())
      throw SceneError(fmt::format("a pair names category {}, there are {} (byte {})", category, names.size(), at_),
                       {path_, 0, 0});
    p.category = names[category];
    const std::size_t vertices_a = get<std::uint8_t>(), vertices_b = get<std::uint8_t>();
    const std::size_t triangles_a = get<std::uint8_t>(), triangles_b = get<std::uint8_t>();
    get<std::uint16_t>();  // padding
    p.a.centre = vec();
    p.b.centre = vec();
    for (std::size_t k = 0; k < vertices_a; ++k) p.a.vertices.push_back(vec());
    for (std::size_t k = 0; k < vertices_b; ++k) p.b.vertices.push_back(vec());
    read_faces(triangles_a, p.a);
    read_faces(triangles_b, p.b);
    p.size = get<double>();
    p.distance = get<double>();
    p.normal = vec();
    p.witness_a = vec();
    p.witness_b = vec();
    return p;
  }
  std::string bytes_, path_;
  std::size_t at_ = 0;
};

}  // namespace

std::vector<CorpusPair> read_corpus(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) throw FileError("there is no file '" + path + "'");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw FileError("cannot read '" + path + "'");
  return CorpusReader({std::istreambuf_iterator<char>(in), {}}, path).read();
}

long double CorpusPair::separation(const Vec3& n) const {
  const auto along = [&](const Vec3& v) {
    return static_cast<long double>(n.x()) * v.x() + static_cast<long double>(n.y()) * v.y() +
           static_cast<long double>(n.z()) * v.z();
  };
  long double high = -std::numeric_limits<long double>::infinity(), low = -high;
  for (const Vec3& v : a.vertices) high = std::max(high, along(v));
  for (const Vec3& v : b.vertices) low = std::min(low, along(v));
  long double apart = 0.0L;
  for (int k = 0; k < 3; ++k)
    apart += static_cast<long double>(n[k]) * (static_cast<long double>(b.centre[k]) - a.centre[k]);
  return apart + low - high;
}

double CorpusPair::resolution() const {
  double largest = std::max(a.centre.norm(), b.centre.norm());
  for (const auto* body : {&a, &b})
    for (const Vec3& v : body->vertices) largest = std::max(largest, v.norm());
  return 1e-12 * size + 1e-15 * largest;
}

std::vector<Pose> CorpusPair::moving_poses(std::size_t count, Random& random) const {
  double radius = 0.0;
  for (const Vec3& v : b.vertices) radius = std::max(radius, v.norm());
  const auto draw = [&] {  // one by one, or each compiler has an order of its own
    const double z = random.uniform(-1, 1), y = random.uniform(-1, 1), x = random.uniform(-1, 1);
    return Vec3(x, y, z);
  };
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 shift = draw(), axis = draw();
    poses.push_back({b.centre + 0.5e-3 * size * shift.normalized(),
                     Quat(Eigen::AngleAxisd(0.5e-3 * size / radius, axis.normalized()))});
  }
  return poses;
}

}  // namespace epafi
