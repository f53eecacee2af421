#include "viz_export/vtk/frame_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "engine/threads/parallel_order.h"
#include "engine/units/error.h"
#include "viz_export/files/write_at_once.h"

namespace epafi {

namespace {

/// Columns that spheres and polygons share; of(k) is the body of point or polygon k.
template <class F>
std::vector<VtpArray> body_columns(const BodyList& b, FrameColumns& rows, const F& of) {
  std::vector<VtpArray> out;
  out.push_back(rows.scalar<std::uint32_t>("id", [&b, of](std::size_t k) { return b.id(of(k)); }));
  out.push_back(rows.scalar<std::uint16_t>("material", [&b, of](std::size_t k) { return b.material(of(k)); }));
  out.push_back(rows.scalar<float>("speed", [&b, of](std::size_t k) { return b.velocity(of(k)).norm(); }));
  out.push_back(rows.scalar<float>("kinetic_energy", [&b, of](std::size_t k) { return b.kinetic_energy(of(k)); }));
  out.push_back({"velocity", 3, rows.vectors([&b, of](std::size_t k) { return b.velocity(of(k)); })});
  return out;
}

/// Cell offsets are 32-bit here; 2^31 corners are 8 GB per frame.
void require_countable(std::size_t corners) {
  if (corners >= std::size_t{1} << 31)
    throw FileError("a frame of " + std::to_string(corners) + " corners is too large for .vtp with 32-bit indices");
}

/// One cell per row, with `corners` points of its own.
VtpCells cells_of(FrameColumns& rows, std::int32_t corners) {
  const auto n = static_cast<std::size_t>(corners);
  VtpCells out;
  out.connectivity = rows.add<std::int32_t>(n, [corners](std::size_t k, std::int32_t* to) {
    for (std::int32_t c = 0; c < corners; ++c) to[c] = static_cast<std::int32_t>(k) * corners + c;
  });
  out.offsets = rows.add<std::int32_t>(
      1, [corners](std::size_t k, std::int32_t* to) { *to = static_cast<std::int32_t>(k + 1) * corners; });
  return out;
}

}  // namespace

PolyData draw_spheres(const BodyList& bodies, double time, FrameRows of) {
  FrameColumns rows(of);
  PolyData d;
  d.time = time;
  d.points = rows.vectors([&](std::size_t k) { return bodies.position(k); });
  d.vertices = cells_of(rows, 1);
  d.point_data = body_columns(bodies, rows, [](std::size_t k) { return k; });
  d.point_data.push_back(rows.scalar<float>("radius", [&](std::size_t k) { return bodies.radius(k); }));
  d.point_data.push_back(
      {"angular_velocity", 3, rows.vectors([&](std::size_t k) { return bodies.angular_velocity(k); })});
  rows.fill();
  return d;
}

PolyData draw_surfaces(const BodyList& bodies, double time) {
  std::vector<const Surface*> surface(bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) surface[k] = bodies.surface(k);
  struct Start {
    std::size_t point, corner, polygon;
  };
  std::vector<Start> start(bodies.size() + 1, Start{0, 0, 0});
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const Surface& s = *surface[k];
    start[k + 1] = {start[k].point + s.points.size(), start[k].corner + s.connectivity.size(),
                    start[k].polygon + s.offsets.size()};
  }
  require_countable(std::max(start.back().corner, start.back().point));
  PolyData d;
  d.time = time;
  d.points.resize(3 * start.back().point);
  d.polygons.connectivity.resize(start.back().corner);
  d.polygons.offsets.resize(start.back().polygon);
  std::vector<std::uint32_t> owner(start.back().polygon);
  parallel_for(
      bodies.size(),
      [&](std::size_t k) {
        const Surface& s = *surface[k];
        const Pose pose = bodies.pose(k);
        const Mat3 turn = pose.orientation.toRotationMatrix();
        for (std::size_t i = 0; i < s.points.size(); ++i) {
          const Eigen::Vector3f x = (pose.position + turn * s.points[i]).cast<float>();
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
  FrameColumns polygons({0, owner.size()});
  d.cell_data = body_columns(bodies, polygons, [&](std::size_t f) { return owner[f]; });
  polygons.fill_by_all();
  return d;
}

PolyData draw_contacts(const ContactRows& c, double time) {
  FrameColumns rows({c.begin(), c.end()});
  PolyData d;
  d.time = time;
  d.points = rows.add<float>(6, [&](std::size_t k, float* to) {
    FrameColumns::put(c.from(k), to);
    FrameColumns::put(c.to(k), to + 3);
  });
  d.lines = cells_of(rows, 2);
  d.cell_data.push_back(rows.scalar<float>("force_magnitude", [&](std::size_t k) { return c.force(k).norm(); }));
  d.cell_data.push_back(rows.scalar<float>("normal_force", [&](std::size_t k) { return c.normal_force(k); }));
  d.cell_data.push_back(rows.scalar<float>("overlap", [&](std::size_t k) { return c.overlap(k); }));
  d.cell_data.push_back(rows.scalar<std::uint32_t>("id_a", [&](std::size_t k) { return c.id_a(k); }));
  d.cell_data.push_back(rows.scalar<std::uint32_t>("id_b", [&](std::size_t k) { return c.id_b(k); }));
  d.cell_data.push_back({"force", 3, rows.vectors([&](std::size_t k) { return c.force(k); })});
  if (c.has_residual())
    d.cell_data.push_back(rows.scalar<float>("residual", [&](std::size_t k) { return c.residual(k); }));
  rows.fill();
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

/// One file of a frame: written, or only listed again.
struct FrameWriter::Entry {
  int part;
  std::string file;
  std::function<void(const std::filesystem::path&)> write = {};
  std::vector<double> poses = {};  ///< of walls
};

std::string FrameWriter::file_of(const char* kind) const { return fmt::format("frames/{}_{:06d}.vtp", kind, next_); }

FrameWriter::Entry FrameWriter::surfaces_entry(int part, const char* kind, const BodyList& bodies, double time) const {
  auto content = std::make_shared<const VtpFile>(draw_surfaces(bodies, time));
  return {part, file_of(kind), [content](const std::filesystem::path& path) { content->write(path); }};
}

FrameWriter::Entry FrameWriter::walls_entry(const BodyList& walls, double time) const {
  std::vector<double> poses;
  for (std::size_t k = 0; k < walls.size(); ++k) {
    const Pose pose = walls.pose(k);
    poses.push_back(walls.id(k));
    poses.insert(poses.end(), pose.position.data(), pose.position.data() + 3);
    poses.insert(poses.end(), pose.orientation.coeffs().data(), pose.orientation.coeffs().data() + 4);
  }
  if (poses == wall_poses_ && !wall_file_.empty()) return {3, wall_file_};
  Entry drawn = surfaces_entry(3, "walls", walls, time);
  drawn.poses = std::move(poses);
  return drawn;
}

std::vector<FrameWriter::Entry> FrameWriter::draw(double time, const BodyList& bodies,
                                                  const ContactList* contacts) const {
  UnwrittenColumn<Slot> solids, walls, others;
  parallel_select(
      bodies.size(), [&](std::size_t k) { return !bodies.is_sphere(k); },
      [](std::size_t k) { return static_cast<Slot>(k); }, others);
  for (const Slot k : others) (bodies.is_wall(k) ? walls : solids).push_back(k);
  std::vector<Entry> out;
  if (const std::size_t count = bodies.size() - others.size(); count > 0) {
    require_countable(count);
    out.push_back(
        {0, file_of("spheres"), [time, list = bodies.spheres(others)](const std::filesystem::path& path) {
           write_vtp_rows(path, list.size(), [&](auto from, auto to) { return draw_spheres(list, time, {from, to}); });
         }});
  }
  if (!solids.empty()) out.push_back(surfaces_entry(1, "bodies", bodies.only(std::move(solids)), time));
  if (contacts != nullptr) {
    require_countable(2 * contacts->size());
    // written also without contacts: readers count the parts of a frame
    out.push_back({2, file_of("contacts"), [time, contacts](const std::filesystem::path& path) {
                     write_vtp_pieces(path, contacts->begins(), [&](std::size_t piece) {
                       PolyData drawn;
                       contacts->read(piece, [&](const ContactRows& rows) { drawn = draw_contacts(rows, time); });
                       return drawn;
                     });
                   }});
  } else if (std::filesystem::exists(folder_ / file_of("contacts"))) {
    out.push_back({2, file_of("contacts")});
  }
  if (!walls.empty()) out.push_back(walls_entry(bodies.only(std::move(walls)), time));
  return out;
}

void FrameWriter::visit(StateVisitor& visitor) {
  std::vector<char> file(wall_file_.begin(), wall_file_.end());
  visitor.column("frames/walls", wall_poses_);
  visitor.column("frames/walls_file", file);
  wall_file_.assign(file.begin(), file.end());
  std::error_code none;
  if (!wall_file_.empty() && !std::filesystem::exists(folder_ / wall_file_, none)) wall_file_.clear();
}

void FrameWriter::write(double time, const BodyList& bodies, const ContactList& contacts,
                        const std::function<void()>& meanwhile) {
  const bool is_new = list_.entries().empty() || list_.entries().back().time < time;
  std::vector<Entry> files = is_new ? draw(time, bodies, &contacts) : std::vector<Entry>();
  write_at_once(files.size() + 1, [&](std::size_t k) {
    if (k == 0 && meanwhile) meanwhile();
    if (k > 0 && files[k - 1].write) files[k - 1].write(folder_ / files[k - 1].file);
  });
  if (is_new) list(time, files);
}

void FrameWriter::write_bodies(double time, const BodyList& bodies) {
  std::vector<Entry> files = draw(time, bodies, nullptr);
  for (const Entry& e : files)
    if (e.write) e.write(folder_ / e.file);
  list(time, files);
}

void FrameWriter::list(double time, std::vector<Entry>& files) {
  for (Entry& e : files) {
    list_.add(time, e.part, e.file);
    if (!e.poses.empty()) {
      wall_file_ = e.file;
      wall_poses_ = std::move(e.poses);
    }
  }
  list_.write();
  ++next_;
}

}  // namespace epafi
