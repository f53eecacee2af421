#include "viz_export/view/pack_columns.h"

#include <algorithm>
#include <cmath>

#include "viz_export/view/orientation_bits.h"
#include "viz_export/view/planes.h"

namespace epafi {
namespace {

constexpr int largest_16 = 65535;          // of fields
constexpr int no_number = 2 * largest_16;  // a field of this body is no finite number
constexpr double heading_steps = 127;

using Ints = std::vector<std::int32_t>;

std::int32_t steps_of(double value) {
  constexpr double most = 1e9;
  return static_cast<std::int32_t>(std::lround(std::clamp(std::isfinite(value) ? value : most, -most, most)));
}

/// Writes frames in sequence, each as the difference from the previous one.
class ColumnWriter {
 public:
  explicit ColumnWriter(int bytes) : bytes_(bytes) {}
  void add(Ints values) {
    put_differences(raw_, values, before_, bytes_);
    before_ = std::move(values);
  }
  std::string& raw() { return raw_; }

 private:
  int bytes_;
  Ints before_;
  std::string raw_;
};

class IdColumn final : public ChunkColumn {
 public:
  void add(const ViewFrame& frame, const FrameFields&) override {
    Ints id;
    for (const BodyRecord& b : frame.bodies) id.push_back(static_cast<std::int32_t>(b.id));
    put_number(ids_.raw(), static_cast<std::uint32_t>(frame.bodies.size()));
    ids_.add(std::move(id));
  }
  std::string raw(double&) override { return std::move(ids_.raw()); }

 private:
  ColumnWriter ids_{4};
};

std::int32_t place(double x, int axis, const ChunkGrid& grid) { return steps_of((x - grid.origin[axis]) / grid.step); }

class PositionColumn final : public ChunkColumn {
 public:
  explicit PositionColumn(const ChunkGrid& grid) : grid_(grid) {}
  void add(const ViewFrame& frame, const FrameFields&) override {
    Ints all;
    all.reserve(3 * frame.bodies.size());
    for (int axis = 0; axis < 3; ++axis)
      for (const BodyRecord& b : frame.bodies) all.push_back(place(b.pose.position[axis], axis, grid_));
    positions_.add(std::move(all));
  }
  std::string raw(double&) override { return std::move(positions_.raw()); }

 private:
  ChunkGrid grid_;
  ColumnWriter positions_{4};
};

/// The three smaller components of orientations, or the index of the largest one.
class OrientationColumn final : public ChunkColumn {
 public:
  explicit OrientationColumn(bool largest) : of_largest_(largest) {}
  void add(const ViewFrame& frame, const FrameFields&) override {
    std::vector<OrientationBits> bits;
    for (const BodyRecord& b : frame.bodies) bits.push_back(orientation_bits(b.pose.orientation));
    if (of_largest_) {
      for (const OrientationBits& b : bits) largest_ += static_cast<char>(b.largest);
      return;
    }
    Ints all;
    for (std::size_t part = 0; part < 3; ++part)
      for (const OrientationBits& b : bits) all.push_back(b.rest[part]);
    rest_.add(std::move(all));
  }
  std::string raw(double&) override { return of_largest_ ? std::move(largest_) : std::move(rest_.raw()); }

 private:
  bool of_largest_;
  std::string largest_;
  ColumnWriter rest_{2};
};

/// A unit vector as two numbers on an octahedron unfolded to a square (Meyer et al. 2010), +-127 each.
std::array<std::int32_t, 2> octahedron(const Vec3& v) {
  const double length = v.cwiseAbs().sum();
  if (!(length > 0)) return {0, 0};
  double x = v.x() / length, y = v.y() / length;
  if (v.z() < 0) {
    const double folded = (1 - std::abs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::abs(x)) * (y < 0 ? -1 : 1);
    x = folded;
  }
  return {steps_of(heading_steps * x), steps_of(heading_steps * y)};
}

class HeadingColumn final : public ChunkColumn {
 public:
  void add(const ViewFrame& frame, const FrameFields&) override {
    Ints all(2 * frame.bodies.size());
    for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
      const auto heading = octahedron(frame.bodies[k].velocity);
      all[k] = heading[0];
      all[frame.bodies.size() + k] = heading[1];
    }
    headings_.add(std::move(all));
  }
  std::string raw(double&) override { return std::move(headings_.raw()); }

 private:
  ColumnWriter headings_{2};
};

/// Values of a field in steps of 1/65535 of the largest one in the chunk.
class FieldColumn final : public ChunkColumn {
 public:
  explicit FieldColumn(std::string name) : name_(std::move(name)) {}
  void add(const ViewFrame&, const FrameFields& fields) override {
    frames_.push_back(fields(name_));
    for (const float v : frames_.back())
      if (std::isfinite(v)) largest_ = std::max(largest_, std::abs(static_cast<double>(v)));
  }
  std::string raw(double& scale) override {
    scale = largest_ / largest_16;
    ColumnWriter column(3);
    for (const auto& values : frames_) {
      Ints steps;
      steps.reserve(values.size());
      for (const float v : values) steps.push_back(std::isfinite(v) ? steps_of(v / scale) : no_number);
      column.add(std::move(steps));
    }
    return std::move(column.raw());
  }

 private:
  std::string name_;
  std::vector<std::vector<float>> frames_;
  double largest_ = 1e-300;
};

/// Steps of the square root of value / largest, for the precision of small values.
std::int32_t root_steps(double value, double largest) {
  return steps_of(largest_16 * std::sqrt(std::min(1.0, std::abs(value) / largest)));
}

/// Per frame: number of contacts, then ids a, ids b, forces, points on A, vectors to those on B, residuals if any.
class ContactColumn final : public ChunkColumn {
 public:
  ContactColumn(const ChunkGrid& grid, float least) : grid_(grid), least_(least) {}
  void add(const ViewFrame& frame, const FrameFields&) override {
    std::vector<const StoredContact*> kept;
    for (const StoredContact& c : frame.contacts)
      if (std::abs(c.normal_force) >= least_) kept.push_back(&c);
    put_number(raw_, static_cast<std::uint32_t>(kept.size()));
    const auto put = [&](int bytes, std::size_t columns, const auto& of) {
      Ints values;
      values.reserve(columns * kept.size());
      for (std::size_t column = 0; column < columns; ++column)
        for (const StoredContact* c : kept) values.push_back(of(*c, static_cast<int>(column)));
      put_differences(raw_, values, {}, bytes);
    };
    put(4, 1, [](const StoredContact& c, int) { return static_cast<std::int32_t>(c.a); });
    put(4, 1, [](const StoredContact& c, int) { return static_cast<std::int32_t>(c.b); });
    put(3, 1, [&](const StoredContact& c, int) { return root_steps(c.normal_force, grid_.strongest); });
    put(4, 6, [&](const StoredContact& c, int part) {
      const int axis = part % 3;
      return part < 3 ? place(c.from[axis], axis, grid_) : steps_of((c.to[axis] - c.from[axis]) / grid_.step);
    });
    if (grid_.worst > 0) put(3, 1, [&](const StoredContact& c, int) { return root_steps(c.residual, grid_.worst); });
  }
  std::string raw(double&) override { return std::move(raw_); }

 private:
  ChunkGrid grid_;
  float least_;
  std::string raw_;
};

}  // namespace

std::unique_ptr<ChunkColumn> make_column(const std::string& name, const ChunkGrid& grid) {
  if (name == "id") return std::make_unique<IdColumn>();
  if (name == "position") return std::make_unique<PositionColumn>(grid);
  if (name == "rest") return std::make_unique<OrientationColumn>(false);
  if (name == "largest") return std::make_unique<OrientationColumn>(true);
  if (name == "heading") return std::make_unique<HeadingColumn>();
  if (name == "contact") return std::make_unique<ContactColumn>(grid, 0.0f);
  if (name == "strong") return std::make_unique<ContactColumn>(grid, grid.least_force);
  return std::make_unique<FieldColumn>(name);
}

}  // namespace epafi
