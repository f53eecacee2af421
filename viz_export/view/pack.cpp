#include "viz_export/view/pack.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/threads/parallel.h"
#include "engine/units/error.h"
#include "viz_export/hdf5/deflate.h"
#include "viz_export/view/pack_columns.h"
#include "viz_export/view/planes.h"

namespace epafi {
namespace {

constexpr double strong_share = 0.1;    // of the strongest force
constexpr double above_strongest = 16;  // 1 % of the contacts are stronger, and keep their force up to this

}  // namespace

Packer::Packer(const ViewSource& source, const Overview& overview, std::size_t stride)
    : source_(source), overview_(overview), fields_(view_fields(source)) {
  const std::size_t n = source.times().size();
  for (std::size_t k = 0; k < n; k += stride) shown_.push_back(k);
  if (n > 0 && shown_.back() != n - 1) shown_.push_back(n - 1);
  columns_ = {"id", "position"};
  if (n > 0 && source.frame(0).has_orientation) columns_.insert(columns_.end(), {"rest", "largest"});
  for (const ViewField& field : fields_)
    if (field.kind == ViewField::Kind::moving) columns_.push_back(field.name);
  columns_.emplace_back("heading");
  if (source.has_contacts()) columns_.emplace_back("contact");
}

double Packer::step() const { return finest_step * overview_.box.diagonal(); }

double Packer::least_force() const { return strong_share * static_cast<double>(overview_.strongest); }

bool Packer::is_moving(const std::string& column) const {
  return std::any_of(fields_.begin(), fields_.end(),
                     [&](const ViewField& f) { return f.kind == ViewField::Kind::moving && f.name == column; });
}

PackedChunk Packer::chunk(std::size_t k, const std::vector<std::string>& names) const {
  ChunkGrid grid{overview_.box.centre(), step(), std::max(1e-300, above_strongest * overview_.strongest), 0.0,
                 static_cast<float>(least_force())};
  if (source_.has_residuals()) grid.worst = std::max(1e-300, overview_.worst_residual);
  std::vector<std::unique_ptr<ChunkColumn>> columns;
  for (const std::string& name : names) columns.push_back(make_column(name, grid));
  const std::size_t end = std::min((k + 1) * chunk_frames, shown_.size());
  for (std::size_t at = k * chunk_frames; at < end; ++at) {
    const ViewFrame frame = source_.frame(shown_[at]);
    const FrameFields fields(frame, source_.about());
    if (source_.has_contacts()) (void)fields.sums();
    parallel_for(
        columns.size(), [&](std::size_t c) { columns[c]->add(frame, fields); }, 1);
  }
  PackedChunk out;
  out.columns.resize(names.size());
  std::vector<double> scales(names.size(), 0.0);
  parallel_for(
      columns.size(),
      [&](std::size_t c) {
        const std::string raw = columns[c]->raw(scales[c]);
        out.columns[c] = deflated_runs(raw);
      },
      1);
  for (std::size_t c = 0; c < names.size(); ++c)
    if (out.columns[c].empty()) throw FileError("zlib ran out of memory");
  out.scales = {grid.origin.x(), grid.origin.y(), grid.origin.z(), grid.step, grid.strongest, grid.worst};
  for (std::size_t c = 0; c < names.size(); ++c)
    if (is_moving(names[c])) out.scales.push_back(scales[c]);
  return out;
}

std::string bytes_of(const PackedChunk& chunk, const std::vector<std::size_t>& columns) {
  std::string out;
  for (const std::size_t c : columns) put_number(out, static_cast<std::uint32_t>(chunk.columns[c].size()));
  out.append(reinterpret_cast<const char*>(chunk.scales.data()), chunk.scales.size() * sizeof(double));
  for (const std::size_t c : columns) out += chunk.columns[c];
  return out;
}

std::string bytes_of(const PackedChunk& chunk) {
  std::vector<std::size_t> all(chunk.columns.size());
  for (std::size_t c = 0; c < all.size(); ++c) all[c] = c;
  return bytes_of(chunk, all);
}

}  // namespace epafi
