#include "viz_export/frame_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "engine/error.h"
#include "engine/parallel.h"

namespace epafi {

namespace {

/// f(k) for every member, one column of T.
template <class T, class F>
VtpArray column(const char* name, std::size_t n, const F& f) {
  std::vector<T> values(n);
  parallel_for(n, [&](std::size_t k) { values[k] = static_cast<T>(f(k)); });
  return {name, 1, std::move(values)};
}

template <class F>
std::vector<float> triples(std::size_t n, const F& f) {
  std::vector<float> values(3 * n);
  parallel_for(n, [&](std::size_t k) {
    const Vec3 v = f(k);
    for (int c = 0; c < 3; ++c) values[3 * k + static_cast<std::size_t>(c)] = static_cast<float>(v[c]);
  });
  return values;
}

/// Columns that spheres and polygons share; body(k) is the body of point or polygon k.
template <class F>
std::vector<VtpArray> body_columns(std::size_t n, const F& body) {
  std::vector<VtpArray> out;
  out.push_back(column<std::uint32_t>("id", n, [&](std::size_t k) { return body(k).id; }));
  out.push_back(column<std::uint16_t>("material", n, [&](std::size_t k) { return body(k).material; }));
  out.push_back(column<float>("speed", n, [&](std::size_t k) { return body(k).velocity.norm(); }));
  out.push_back(column<float>("kinetic_energy", n, [&](std::size_t k) { return body(k).kinetic_energy; }));
  out.push_back({"velocity", 3, triples(n, [&](std::size_t k) { return body(k).velocity; })});
  return out;
}

/// VTK's cells count in 32 bits here; 2^31 corners are 8 GB of frame.
void require_countable(std::size_t corners) {
  if (corners >= std::size_t{1} << 31)
    throw FileError("a frame of " + std::to_string(corners) + " corners is too large for .vtp with 32-bit indices");
}

VtpCells rows_of(std::size_t cells, std::int32_t corners) {
  VtpCells out;
  require_countable(cells * static_cast<std::size_t>(corners));
  out.connectivity.resize(cells * static_cast<std::size_t>(corners)), out.offsets.resize(cells);
  std::iota(out.connectivity.begin(), out.connectivity.end(), 0);
  for (std::size_t c = 0; c < cells; ++c) out.offsets[c] = static_cast<std::int32_t>(c + 1) * corners;
  return out;
}

}  // namespace

PolyData draw_spheres(const std::vector<const BodyRecord*>& bodies, double time) {
  const auto body = [&](std::size_t k) -> const BodyRecord& { return *bodies[k]; };
  PolyData d;
  d.time = time;
  d.points = triples(bodies.size(), [&](std::size_t k) { return body(k).pose.position; });
  d.vertices = rows_of(bodies.size(), 1);
  d.point_data = body_columns(bodies.size(), body);
  d.point_data.push_back(column<float>("radius", bodies.size(), [&](std::size_t k) { return body(k).radius; }));
  d.point_data.push_back(
      {"angular_velocity", 3, triples(bodies.size(), [&](std::size_t k) { return body(k).angular_velocity; })});
  return d;
}

PolyData draw_surfaces(const std::vector<const BodyRecord*>& bodies, double time) {
  struct Start {
    std::size_t point, corner, polygon;
  };
  std::vector<Start> start(bodies.size() + 1, Start{0, 0, 0});
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const Surface& s = *bodies[k]->surface;
    start[k + 1] = {start[k].point + s.points.size(), start[k].corner + s.connectivity.size(),
                    start[k].polygon + s.offsets.size()};
  }
  require_countable(std::max(start.back().corner, start.back().point));
  PolyData d;
  d.time = time;
  d.points.resize(3 * start.back().point);
  d.polygons.connectivity.resize(start.back().corner), d.polygons.offsets.resize(start.back().polygon);
  std::vector<std::uint32_t> owner(start.back().polygon);
  parallel_for(
      bodies.size(),
      [&](std::size_t k) {
        const Surface& s = *bodies[k]->surface;
        const Mat3 turn = bodies[k]->pose.orientation.toRotationMatrix();
        for (std::size_t i = 0; i < s.points.size(); ++i) {
          const Eigen::Vector3f x = (bodies[k]->pose.position + turn * s.points[i]).cast<float>();
          std::copy_n(x.data(), 3, &d.points[3 * (start[k].point + i)]);
        }
        for (std::size_t i = 0; i < s.connectivity.size(); ++i)
          d.polygons.connectivity[start[k].corner + i] = s.connectivity[i] + static_cast<std::int32_t>(start[k].point);
        for (std::size_t i = 0; i < s.offsets.size(); ++i) {
          d.polygons.offsets[start[k].polygon + i] = s.offsets[i] + static_cast<std::int32_t>(start[k].corner);
          owner[start[k].polygon + i] = static_cast<std::uint32_t>(k);
        }
      },
      16);
  d.cell_data = body_columns(owner.size(), [&](std::size_t f) -> const BodyRecord& { return *bodies[owner[f]]; });
  return d;
}

PolyData draw_contacts(const std::vector<ContactRecord>& contacts, double time) {
  const std::size_t n = contacts.size();
  const auto at = [&](std::size_t k) -> const ContactRecord& { return contacts[k]; };
  PolyData d;
  d.time = time;
  d.points = triples(2 * n, [&](std::size_t k) { return k % 2 == 0 ? at(k / 2).from : at(k / 2).to; });
  d.lines = rows_of(n, 2);
  d.cell_data.push_back(column<float>("force_magnitude", n, [&](std::size_t k) { return at(k).force.norm(); }));
  d.cell_data.push_back(column<float>("normal_force", n, [&](std::size_t k) { return at(k).normal_force; }));
  d.cell_data.push_back(column<float>("overlap", n, [&](std::size_t k) { return at(k).overlap; }));
  d.cell_data.push_back(column<std::uint32_t>("id_a", n, [&](std::size_t k) { return at(k).id_a; }));
  d.cell_data.push_back(column<std::uint32_t>("id_b", n, [&](std::size_t k) { return at(k).id_b; }));
  d.cell_data.push_back({"force", 3, triples(n, [&](std::size_t k) { return at(k).force; })});
  return d;
}

FrameWriter::FrameWriter(std::filesystem::path folder) : folder_(std::move(folder)), list_(folder_ / "frames.pvd") {
  std::error_code cause;
  std::filesystem::create_directories(folder_ / "frames", cause);
  if (cause) throw FileError((folder_ / "frames").string() + ": cannot create: " + cause.message());
}

FrameWriter::FrameWriter(std::filesystem::path folder, double time) : FrameWriter(std::move(folder)) {
  if (!std::filesystem::exists(folder_ / "frames.pvd")) return;
  list_.keep_until(time);
  double last = 0.0;
  for (std::size_t k = 0; k < list_.entries().size(); ++k) {  // one frame per time
    if (k == 0 || list_.entries()[k].time > last) ++next_;
    last = list_.entries()[k].time;
  }
}

void FrameWriter::put(int part, const std::string& kind, const PolyData& data, VtpEncoding encoding) {
  const std::string file = fmt::format("frames/{}_{:06d}.vtp", kind, next_);
  write_vtp(folder_ / file, data, encoding);
  list_.add(data.time, part, file);
}

void FrameWriter::put_walls(const std::vector<const BodyRecord*>& walls, double time) {
  std::vector<double> poses;
  for (const BodyRecord* w : walls) {
    poses.push_back(w->id);
    poses.insert(poses.end(), w->pose.position.data(), w->pose.position.data() + 3);
    poses.insert(poses.end(), w->pose.orientation.coeffs().data(), w->pose.orientation.coeffs().data() + 4);
  }
  if (poses == wall_poses_ && !wall_file_.empty()) {
    list_.add(time, 3, wall_file_);
    return;
  }
  put(3, "walls", draw_surfaces(walls, time), VtpEncoding::compressed);
  wall_file_ = list_.entries().back().file;
  wall_poses_ = std::move(poses);
}

void FrameWriter::visit(StateVisitor& visitor) {
  std::vector<char> file(wall_file_.begin(), wall_file_.end());
  visitor.column("frames/walls", wall_poses_), visitor.column("frames/walls_file", file);
  wall_file_.assign(file.begin(), file.end());
  std::error_code none;
  if (!wall_file_.empty() && !std::filesystem::exists(folder_ / wall_file_, none)) wall_file_.clear();
}

void FrameWriter::write(double time, const std::vector<BodyRecord>& bodies,
                        const std::vector<ContactRecord>& contacts) {
  if (!list_.entries().empty() && list_.entries().back().time >= time) return;
  std::vector<const BodyRecord*> spheres, solids, walls;
  for (const BodyRecord& b : bodies) (b.surface == nullptr ? spheres : b.is_wall() ? walls : solids).push_back(&b);
  if (!spheres.empty()) put(0, "spheres", draw_spheres(spheres, time), VtpEncoding::plain);
  if (!solids.empty()) put(1, "bodies", draw_surfaces(solids, time), VtpEncoding::compressed);
  put(2, "contacts", draw_contacts(contacts, time), VtpEncoding::plain);  // also none: readers count the parts of a frame
  if (!walls.empty()) put_walls(walls, time);
  list_.write();
  ++next_;
}

}  // namespace epafi
