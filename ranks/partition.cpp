#include "ranks/partition.h"

#include <zoltan.h>

#include <algorithm>
#include <limits>

#include "engine/units/error.h"
#include "ranks/communicator.h"

namespace epafi {

namespace {
void expect(int code, const char* what) {
  if (code != ZOLTAN_OK && code != ZOLTAN_WARN)
    throw FileError(std::string("ranks: ") + what + " failed, Zoltan's code " + std::to_string(code));
}
}  // namespace

struct Partition::Cuts {
  Zoltan_Struct* zoltan = Zoltan_Create(MPI_COMM_WORLD);
  std::span<const Vec3> points;
  std::span<const float> weights;
  Vec3 scale = Vec3::Ones();  ///< of what Zoltan sees
  bool made = false;
  std::vector<int> processes, parts;
  struct Part {
    Vec3 low, high;
  };
  std::vector<Part> boxes;  ///< by rank

  Cuts();
  Cuts(const Cuts&) = delete;
  Cuts& operator=(const Cuts&) = delete;
  ~Cuts() { Zoltan_Destroy(&zoltan); }

  void find_boxes() {
    boxes.clear();
    const Vec3 far = Vec3::Constant(std::numeric_limits<double>::infinity());
    if (rank_count() == 1) return boxes.push_back({-far, far});  // Zoltan has no cuts then
    for (int rank = 0; rank < rank_count(); ++rank) {
      int axes = 0;
      Vec3 a, b;
      expect(Zoltan_RCB_Box(zoltan, rank, &axes, &a.x(), &a.y(), &a.z(), &b.x(), &b.y(), &b.z()), "the box of a part");
      boxes.push_back({a.cwiseQuotient(scale), b.cwiseQuotient(scale)});
    }
  }

  static Cuts& of(void* data) { return *static_cast<Cuts*>(data); }
  static int count(void* data, int* error) {
    *error = ZOLTAN_OK;
    return static_cast<int>(of(data).points.size());
  }
  static int dimensions(void*, int* error) {
    *error = ZOLTAN_OK;
    return 3;
  }
  static void list(void* data, int, int, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR local, int, float* weight, int* error) {
    *error = ZOLTAN_OK;
    const Cuts& cuts = of(data);
    for (unsigned i = 0; i < cuts.points.size(); ++i) {
      global[i] = local[i] = i;
      weight[i] = cuts.weights.empty() ? 1.0f : cuts.weights[i];
    }
  }
  static void places(void* data, int, int, int count, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR local, int, double* x, int* error) {
    *error = ZOLTAN_OK;
    for (int i = 0; i < count; ++i)
      Eigen::Map<Vec3>(x + 3 * i) = of(data).points[local[i]].cwiseProduct(of(data).scale);
  }
};

Partition::Cuts::Cuts() {
  const auto set = [&](const char* name, const char* value) { Zoltan_Set_Param(zoltan, name, value); };
  set("DEBUG_LEVEL", "0");
  set("LB_METHOD", "RCB");
  set("KEEP_CUTS", "1");
  set("RETURN_LISTS", "NONE");
  set("IMBALANCE_TOL", "1.02");
  set("NUM_GID_ENTRIES", "1");
  set("NUM_LID_ENTRIES", "1");
  set("OBJ_WEIGHT_DIM", "1");
  Zoltan_Set_Num_Obj_Fn(zoltan, count, this);
  Zoltan_Set_Num_Geom_Fn(zoltan, dimensions, this);
  Zoltan_Set_Obj_List_Fn(zoltan, list, this);
  Zoltan_Set_Geom_Multi_Fn(zoltan, places, this);
  processes.resize(static_cast<std::size_t>(rank_count()));
  parts.resize(processes.size());
}

Partition::Partition() : cuts_(std::make_unique<Cuts>()) {}
Partition::~Partition() = default;

void Partition::cut(std::span<const Vec3> points, std::span<const float> weights, const Vec3& scale) {
  EPAFI_REQUIRE(weights.empty() || weights.size() == points.size(), "a weight for each point");
  double all = static_cast<double>(points.size());
  sum_over_ranks({&all, 1});
  cuts_->made = all > 0.0;
  if (!cuts_->made) return;  // nothing to share out: all space is that of rank 0
  cuts_->points = points;
  cuts_->weights = weights;
  cuts_->scale = scale;
  int changed = 0, globals = 0, locals = 0, incoming = 0, outgoing = 0;
  ZOLTAN_ID_PTR in_global = nullptr, in_local = nullptr, out_global = nullptr, out_local = nullptr;
  int *in_process = nullptr, *in_part = nullptr, *out_process = nullptr, *out_part = nullptr;
  const int code =
      Zoltan_LB_Partition(cuts_->zoltan, &changed, &globals, &locals, &incoming, &in_global, &in_local, &in_process,
                          &in_part, &outgoing, &out_global, &out_local, &out_process, &out_part);
  Zoltan_LB_Free_Part(&in_global, &in_local, &in_process, &in_part);
  Zoltan_LB_Free_Part(&out_global, &out_local, &out_process, &out_part);
  cuts_->points = {};
  cuts_->weights = {};
  expect(code, "the partition");
  cuts_->find_boxes();
}

bool Partition::is_deep(const Vec3& x, double half, int rank) const {
  if (!cuts_->made) return rank == 0;
  const auto& [low, high] = cuts_->boxes[static_cast<std::size_t>(rank)];
  return ((x - low).array() > half).all() && ((high - x).array() > half).all();
}

Vec3 Partition::cut_axes() const {
  constexpr double far = 1e29;  // Zoltan's ends of all space are beyond
  Vec3 axes = Vec3::Zero();
  if (!cuts_->made) return axes;
  for (const auto& [low, high] : cuts_->boxes)
    axes = axes.cwiseMax(Vec3(((low.array() > -far) || (high.array() < far)).cast<double>()));
  return axes;
}

int Partition::owner(const Vec3& x) const {
  if (!cuts_->made) return 0;
  Vec3 at = x.cwiseProduct(cuts_->scale);
  int process = 0, part = 0;
  expect(Zoltan_LB_Point_PP_Assign(cuts_->zoltan, at.data(), &process, &part), "the owner of a point");
  return process;
}

void Partition::ranks_near(const Vec3& x, double half, std::vector<int>& ranks) const {
  if (!cuts_->made) return ranks.push_back(0);
  const Vec3 low = (x.array() - half) * cuts_->scale.array(), high = (x.array() + half) * cuts_->scale.array();
  int processes = 0, parts = 0;
  expect(Zoltan_LB_Box_PP_Assign(cuts_->zoltan, low.x(), low.y(), low.z(), high.x(), high.y(), high.z(),
                                 cuts_->processes.data(), &processes, cuts_->parts.data(), &parts),
         "the ranks of a box");
  ranks.insert(ranks.end(), cuts_->processes.begin(), cuts_->processes.begin() + processes);
}

}  // namespace epafi
