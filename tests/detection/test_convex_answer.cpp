#include "detection/narrow/gjk/convex_answer.h"

#include <fstream>

#include "engine/units/error.h"
#include "tests/support/catch.h"
#include "tests/support/convex_corpus.h"
#include "tests/support/polyhedra.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using testing::upright;

namespace {

ConvexHull corpus_hull(const CorpusBody& body) { return ConvexHull::from_faces(body.vertices, body.faces).hull; }

}  // namespace

TEST_CASE("support functions alone give the right class of every pair, and their interval holds the depth",
          "[detection][answer]") {
  int wrong = 0, outside = 0, intervals = 0;
  double worst = 0.0;
  for (const auto& p : support::read_corpus(EPAFI_SOURCE_DIR "/tests/data/convex_pairs.bin")) {
    const ConvexHull a = corpus_hull(p.a), b = corpus_hull(p.b);
    const auto d = ask(ConvexMethod::gjk_epa, a.view(), b.view(), {p.a.centre, upright}, {p.b.centre, upright});
    CHECK(std::isfinite(d.distance));
    CHECK(std::abs(d.normal.norm() - 1.0) < 1e-14);
    wrong += std::abs(p.distance) > p.resolution() && (d.distance < 0.0) != (p.distance < 0.0);
    outside += std::abs(d.distance - p.distance) > d.uncertainty + p.resolution();
    intervals += std::string(d.status) != "ok";
    worst = std::max(worst, std::abs(d.distance - p.distance) / p.size);
  }
  INFO("intervals " << intervals << ", worst distance " << worst);
  CHECK(wrong == 0);
  CHECK(outside == 0);
}

TEST_CASE("the axis test alone is exact while bodies overlap and a bound while they do not", "[detection][answer]") {
  int bounds = 0;
  for (const auto& p : support::read_corpus(EPAFI_SOURCE_DIR "/tests/data/convex_pairs.bin")) {
    const ConvexHull a = corpus_hull(p.a), b = corpus_hull(p.b);
    const auto d = ask(ConvexMethod::sat, a.view(), b.view(), {p.a.centre, upright}, {p.b.centre, upright});
    CHECK(d.distance <= p.distance + p.resolution());
    if (p.distance < -p.resolution()) CHECK(d.distance >= p.distance - p.resolution());
    if (p.distance > p.resolution()) CHECK(d.distance > 0.0);  // some feature axis separates whatever is separated
    bounds += std::string(d.status) == "lower-bound";
  }
  CHECK(bounds > 40);
}

TEST_CASE("witness points are relative to their own body wherever the pair stands and however it is turned",
          "[detection][answer]") {
  Random random(71, 0);
  for (int k = 0; k < 200; ++k) {
    const ConvexHull a = support::random_hull(random, 12), b = support::random_hull(random, 12);
    const Pose pa{testing::random_point(random, -5, 5), testing::random_turn(random)};
    const Pose pb{pa.position + random.uniform(0.5, 3) * testing::random_direction(random),
                  testing::random_turn(random)};
    for (const ConvexMethod method : {ConvexMethod::automatic, ConvexMethod::gjk_epa}) {
      const auto d = ask(method, a.view(), b.view(), pa, pb);
      const Vec3 between = pb.position + d.witness_b - pa.position - d.witness_a;
      CHECK((between - d.distance * d.normal).norm() < 1e-6);
      CHECK(between.dot(d.normal) == Approx(d.distance).margin(1e-11));
      // each lies in its body: no face is below it
      for (const auto& [hull, pose, x] : {std::tuple(&a, &pa, d.witness_a), std::tuple(&b, &pb, d.witness_b)}) {
        const Vec3 local = pose->orientation.conjugate() * x;
        for (std::size_t f = 0; f < hull->face_normals.size(); ++f)
          CHECK(hull->face_normals[f].dot(local) <= hull->face_offsets[f] + 1e-9);
      }
    }
  }
}

TEST_CASE("a corpus that breaks off is an error with its byte", "[detection][answer]") {
  std::ifstream in(EPAFI_SOURCE_DIR "/tests/data/convex_pairs.bin", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const std::string path = EPAFI_BINARY_DIR "/broken_corpus.bin";
  const auto write = [&](const std::string& text) { std::ofstream(path, std::ios::binary) << text; };
  write(bytes.substr(0, 1000));
  CHECK_THROWS_AS(read_corpus(path), SceneError);
  write("solid nothing at all");
  CHECK_THROWS_AS(read_corpus(path), SceneError);
  CHECK_THROWS_AS(read_corpus(path + ".missing"), FileError);
}
