#include "viz_export/view/pack.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/error.h"
#include "viz_export/deflate.h"
#include "viz_export/view/orientation_bits.h"
#include "viz_export/view/planes.h"

namespace epafi {
namespace {

constexpr double finest = 1e-5;    // step of positions over the diagonal of the box
constexpr int largest_16 = 65535;  // of fields
constexpr double heading_steps = 127;

using Ints = std::vector<std::int32_t>;

std::int32_t steps_of(double value) {
  constexpr double most = 1e9;
  return static_cast<std::int32_t>(std::lround(std::clamp(std::isfinite(value) ? value : most, -most, most)));
}

/// One column of a chunk: frames one behind the other, each as its difference from the one before.
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

double largest_of(const std::vector<std::vector<float>>& frames) {
  double out = 1e-300;
  for (const auto& values : frames)
    for (const float v : values)
      if (std::isfinite(v)) out = std::max(out, std::abs(static_cast<double>(v)));
  return out;
}

std::string in_steps(const std::vector<std::vector<float>>& frames, double scale) {
  ColumnWriter column(3);
  for (const auto& values : frames) {
    Ints steps;
    for (const float v : values) steps.push_back(std::isfinite(v) ? steps_of(v / scale) : 0);
    column.add(std::move(steps));
  }
  return std::move(column.raw());
}

std::string compressed(const std::string& raw) {
  if (raw.empty()) return {};
  std::string out = deflated(raw, 6);
  if (out.empty()) throw FileError("zlib ran out of memory");
  return out;
}

/// Units of a chunk's whole numbers.
struct ChunkGrid {
  Vec3 origin;       ///< [m]
  double step;       ///< of positions [m]
  double strongest;  ///< force of a contact that has the largest number [N]
};

/// What a chunk is made of, column by column.
struct ChunkColumns {
  ChunkColumns(std::size_t number_of_fields, const ChunkGrid& units) : grid(units), fields(number_of_fields) {}
  ChunkGrid grid;
  ColumnWriter ids{4}, positions{4}, rest{2}, headings{2};
  std::string largest{}, contacts{};
  std::vector<std::vector<std::vector<float>>> fields;  ///< by field and frame

  std::int32_t place(double x, int axis) const { return steps_of((x - grid.origin[axis]) / grid.step); }

  void add_orientation(const ViewFrame& frame) {
    Ints all;
    for (int axis = 0; axis < 3; ++axis)
      for (const BodyRecord& b : frame.bodies)
        all.push_back(orientation_bits(b.pose.orientation).rest[static_cast<std::size_t>(axis)]);
    for (const BodyRecord& b : frame.bodies) largest += static_cast<char>(orientation_bits(b.pose.orientation).largest);
    rest.add(std::move(all));
  }

  void add_positions(const ViewFrame& frame) {
    Ints id, all;
    for (const BodyRecord& b : frame.bodies) id.push_back(static_cast<std::int32_t>(b.id));
    put_number(ids.raw(), static_cast<std::uint32_t>(frame.bodies.size()));
    ids.add(std::move(id));
    for (int axis = 0; axis < 3; ++axis)
      for (const BodyRecord& b : frame.bodies) all.push_back(place(b.pose.position[axis], axis));
    positions.add(std::move(all));
  }

  void add_headings(const ViewFrame& frame) {
    Ints all;
    for (std::size_t part = 0; part < 2; ++part)
      for (const BodyRecord& b : frame.bodies) all.push_back(octahedron(b.velocity)[part]);
    headings.add(std::move(all));
  }

  /// Per frame: their number, then ids a, ids b, forces (square root of the share), the ends at A, the ways to those at
  /// B.
  void add_contacts(const ViewFrame& frame, float least) {
    std::vector<const StoredContact*> kept;
    for (const StoredContact& c : frame.contacts)
      if (std::abs(c.normal_force) >= least) kept.push_back(&c);
    put_number(contacts, static_cast<std::uint32_t>(kept.size()));
    Ints a, b, force, ends;
    for (const StoredContact* c : kept) {
      a.push_back(static_cast<std::int32_t>(c->a));
      b.push_back(static_cast<std::int32_t>(c->b));
      force.push_back(steps_of(largest_16 * std::sqrt(std::min(1.0, std::abs(c->normal_force) / grid.strongest))));
    }
    for (int axis = 0; axis < 3; ++axis)
      for (const StoredContact* c : kept) ends.push_back(place(c->from[axis], axis));
    for (int axis = 0; axis < 3; ++axis)
      for (const StoredContact* c : kept) ends.push_back(steps_of((c->to[axis] - c->from[axis]) / grid.step));
    put_differences(contacts, a, {}, 4);
    put_differences(contacts, b, {}, 4);
    put_differences(contacts, force, {}, 3);
    put_differences(contacts, ends, {}, 4);
  }
};

}  // namespace

Packer::Packer(const ViewSource& source, const Overview& overview, const PackPlan& plan)
    : source_(source), overview_(overview), plan_(plan), fields_(view_fields(source)) {
  const std::size_t n = source.times().size();
  for (std::size_t k = 0; k < n; k += plan.stride) shown_.push_back(k);
  if (n > 0 && shown_.back() != n - 1) shown_.push_back(n - 1);
  has_orientation_ = n > 0 && source.frame(0).has_orientation;
  columns_ = {"id", "position"};
  if (has_orientation_) columns_.insert(columns_.end(), {"rest", "largest"});
  for (const ViewField& field : fields_)
    if (field.kind == ViewField::Kind::moving) columns_.push_back(field.name);
  if (plan.headings) columns_.push_back("heading");
  if (source.has_contacts() && plan.least_force >= 0) columns_.push_back("contact");
}

double Packer::step() const { return finest * overview_.box.diagonal(); }

std::string Packer::chunk(std::size_t k, std::vector<std::size_t>* sizes) const {
  std::vector<std::string> moving;
  for (const ViewField& field : fields_)
    if (field.kind == ViewField::Kind::moving) moving.push_back(field.name);
  const bool contacts = columns_.back() == "contact";
  ChunkColumns c(moving.size(), {overview_.box.centre(), step(), std::max(1e-300, 16.0 * overview_.strongest)});
  const std::size_t end = std::min((k + 1) * chunk_frames, shown_.size());
  for (std::size_t at = k * chunk_frames; at < end; ++at) {
    const ViewFrame frame = source_.frame(shown_[at]);
    c.add_positions(frame);
    if (has_orientation_) c.add_orientation(frame);
    for (std::size_t f = 0; f < moving.size(); ++f)
      c.fields[f].push_back(field_values(moving[f], frame, source_.about()));
    if (plan_.headings) c.add_headings(frame);
    if (contacts) c.add_contacts(frame, plan_.least_force);
  }
  std::vector<std::string> parts{compressed(c.ids.raw()), compressed(c.positions.raw())};
  if (has_orientation_) {
    parts.push_back(compressed(c.rest.raw()));
    parts.push_back(compressed(c.largest));
  }
  std::vector<double> scales{c.grid.origin.x(), c.grid.origin.y(), c.grid.origin.z(), c.grid.step, c.grid.strongest};
  for (const auto& frames : c.fields) {
    scales.push_back(largest_of(frames) / largest_16);
    parts.push_back(compressed(in_steps(frames, scales.back())));
  }
  if (plan_.headings) parts.push_back(compressed(c.headings.raw()));
  if (contacts) parts.push_back(compressed(c.contacts));
  std::string out;
  for (const std::string& part : parts) put_number(out, static_cast<std::uint32_t>(part.size()));
  out.append(reinterpret_cast<const char*>(scales.data()), scales.size() * sizeof(double));
  for (const std::string& part : parts) out += part;
  if (sizes != nullptr)
    for (const std::string& part : parts) sizes->push_back(part.size());
  return out;
}

}  // namespace epafi
