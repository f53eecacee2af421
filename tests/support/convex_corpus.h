/// @file convex_corpus.h  Pairs of convex polyhedra with exact signed distances, read from the CXP1 format (tests/data/README.md).
#pragma once
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "detection/shapes/convex_hull.h"

namespace epafi::support {

struct CorpusBody {
  Vec3 centre;                                     ///< [m]
  std::vector<Vec3> vertices;                      ///< relative to centre
  std::vector<std::vector<std::uint32_t>> faces;   ///< counter-clockwise triangles
};

struct CorpusPair {
  std::string category;
  CorpusBody a, b;
  double size = 0.0;      ///< bounding radius of the smaller body [m]
  double distance = 0.0;  ///< exact, < 0: penetration depth [m]
  Vec3 normal, witness_a, witness_b;

  /// Separation along n by brute force in extended precision: min over B of n.x minus max over A.
  long double separation(const Vec3& n) const {
    const auto along = [&](const Vec3& v) {
      return static_cast<long double>(n.x()) * v.x() + static_cast<long double>(n.y()) * v.y() + static_cast<long double>(n.z()) * v.z();
    };
    long double high = -std::numeric_limits<long double>::infinity(), low = -high;
    for (const Vec3& v : a.vertices) high = std::max(high, along(v));
    for (const Vec3& v : b.vertices) low = std::min(low, along(v));
    long double apart = 0.0L;
    for (int k = 0; k < 3; ++k) apart += static_cast<long double>(n[k]) * (static_cast<long double>(b.centre[k]) - a.centre[k]);
    return apart + low - high;
  }
};

class CorpusReader {
 public:
  explicit CorpusReader(const std::string& path) : in_(path, std::ios::binary) {}

  std::vector<CorpusPair> read() {
    std::vector<CorpusPair> pairs;
    char magic[4] = {};
    in_.read(magic, 4);
    if (!in_ || std::memcmp(magic, "CXP1", 4) != 0) return pairs;
    const auto count = get<std::uint32_t>(), kinds = get<std::uint32_t>();
    std::vector<std::string> names(kinds);
    for (auto& name : names) {
      name.resize(get<std::uint8_t>());
      in_.read(name.data(), static_cast<std::streamsize>(name.size()));
    }
    for (std::uint32_t p = 0; p < count && in_; ++p) pairs.push_back(read_pair(names));
    return pairs;
  }

 private:
  template <class T>
  T get() {
    T value{};
    in_.read(reinterpret_cast<char*>(&value), sizeof(T));
    return value;
  }
  Vec3 vec() {
    const double x = get<double>(), y = get<double>(), z = get<double>();
    return {x, y, z};
  }
  CorpusPair read_pair(const std::vector<std::string>& names) {
    CorpusPair p;
    p.category = names.at(get<std::uint16_t>());
    const std::size_t vertices_a = get<std::uint8_t>(), vertices_b = get<std::uint8_t>();
    const std::size_t triangles_a = get<std::uint8_t>(), triangles_b = get<std::uint8_t>();
    get<std::uint16_t>();
    p.a.centre = vec(), p.b.centre = vec();
    for (std::size_t k = 0; k < vertices_a; ++k) p.a.vertices.push_back(vec());
    for (std::size_t k = 0; k < vertices_b; ++k) p.b.vertices.push_back(vec());
    const auto triangle = [&] {
      const std::uint32_t i = get<std::uint8_t>(), j = get<std::uint8_t>(), k = get<std::uint8_t>();
      return std::vector{i, j, k};
    };
    for (std::size_t k = 0; k < triangles_a; ++k) p.a.faces.push_back(triangle());
    for (std::size_t k = 0; k < triangles_b; ++k) p.b.faces.push_back(triangle());
    p.size = get<double>(), p.distance = get<double>();
    p.normal = vec(), p.witness_a = vec(), p.witness_b = vec();
    return p;
  }
  std::ifstream in_;
};

inline std::vector<CorpusPair> read_corpus(const std::string& path) { return CorpusReader(path).read(); }

}  // namespace epafi::support
