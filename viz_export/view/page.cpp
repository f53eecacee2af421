#include "viz_export/view/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "engine/units/error.h"
#include "viz_export/files/page_target.h"
#include "viz_export/files/side_file.h"
#include "viz_export/report/html_text.h"
#include "viz_export/view/pack.h"

namespace epafi {
namespace {

void replace_once(std::string& text, const std::string& mark, const std::string& by) {
  const std::size_t at = text.find(mark);
  if (at != text.npos) text.replace(at, mark.size(), by);
}

std::string page_around(const std::string& title, const std::string& data) {
  const PageParts& parts = page_parts();
  std::string page = parts.frame;
  replace_once(page, "{{title}}", html_escaped(title));
  replace_once(page, "{{style}}", parts.style);
  replace_once(page, "{{data}}", data);
  replace_once(page, "{{three}}", parts.three);
  replace_once(page, "{{controls}}", parts.controls);
  replace_once(page, "{{script}}", parts.script);
  return page;
}

/// A packed run, and the parts of it that the page keeps.
struct Packed {
  std::string bodies;
  std::vector<std::string> names;  ///< of the columns in the chunks
  std::vector<PackedChunk> chunks;
  std::vector<std::size_t> kept{};  ///< columns
  std::size_t stride = 1;

  std::size_t bytes() const {
    std::size_t sum = bodies.size();
    for (const PackedChunk& chunk : chunks) {
      sum += (4 * kept.size()) + 8 * chunk.scales.size();
      for (const std::size_t c : kept) sum += chunk.columns[c].size();
    }
    return sum / 3 * 4;
  }
  std::vector<std::string> kept_names() const {
    std::vector<std::string> out;
    for (const std::size_t c : kept) out.push_back(names[c]);
    return out;
  }
  bool drop(const std::string& name) {
    return std::erase_if(kept, [&](std::size_t c) { return names[c] == name; }) > 0;
  }
};

/// Packs the run in one pass. Besides all contacts it packs the strong ones alone, for a page without room for all.
Packed pack(const Packer& packer, std::vector<std::string> names, std::size_t stride) {
  Packed out{packer.bodies(), std::move(names), {}, {}, stride};
  for (std::size_t c = 0; c < out.names.size(); ++c) out.kept.push_back(c);
  if (!out.names.empty() && out.names.back() == "contact" && packer.least_force() > 0) out.names.emplace_back("strong");
  for (std::size_t k = 0; k < packer.chunks(); ++k) out.chunks.push_back(packer.chunk(k, out.names));
  return out;
}

/// Leaves out the next optional part, with a note; false where only frames are left.
bool leave_out(Packed& packed, double least_force, std::string& note) {
  if (packed.drop("heading")) {
    note = "directions of velocities are left out to keep this page small";
    return true;
  }
  if (packed.drop("contact")) {
    note = "contacts are left out to keep this page small";
    if (packed.names.back() != "strong") return true;
    packed.kept.push_back(packed.names.size() - 1);
    note = fmt::format("contacts below {:.3g} N are left out to keep this page small", least_force);
    return true;
  }
  if (!packed.drop("strong")) return false;
  note = "contacts are left out to keep this page small";
  return true;
}

/// Replaces an earlier note of the same kind.
void replace_note(std::vector<std::string>& notes, const std::string& note) {
  for (const char* kind : {"one frame", "contacts"})
    if (!notes.empty() && notes.back().starts_with(kind) && note.starts_with(kind)) notes.pop_back();
  notes.push_back(note);
}

}  // namespace

void require_page_library() {
  if (page_parts().three[0] != '\0') return;
  throw FileError(
      "this program was built without the library that draws in the browser: install it with "
      "`apt-get install libjs-three` (three.js, MIT licence) and build again");
}

std::string served_page(const std::string& title) { return page_around(title, ""); }

std::string complete_page(const ViewSource& source, std::size_t most_bytes, WrittenPage& about) {
  require_page_library();
  const Overview overview = look_over(source);
  auto packer = std::make_unique<Packer>(source, overview);
  Packed packed = pack(*packer, packer->columns(), 1);
  const std::size_t own = page_around(source.title(), packer->manifest(packer->columns(), {})).size();
  const std::size_t most = most_bytes > 2 * own ? most_bytes - own : own;
  while (packed.bytes() > most && packed.stride < source.times().size()) {
    std::string note;
    if (!leave_out(packed, packer->least_force(), note)) {
      const std::size_t stride = packed.stride * std::max<std::size_t>(2, (packed.bytes() + most - 1) / most);
      packer = std::make_unique<Packer>(source, overview, stride);
      packed = pack(*packer, packed.kept_names(), stride);
      note = fmt::format("one frame of {} is shown, to keep this page small", stride);
    }
    replace_note(about.notes, note);
  }
  const std::string manifest = packer->manifest(packed.kept_names(), about.notes);
  std::string data = "<script type=\"application/json\" id=\"manifest\">" + script_escaped(manifest) + "</script>\n";
  const auto add = [&](const std::string& id, const std::string& bytes) {
    data += "<script type=\"text/plain\" id=\"" + id + "\">" + base64(bytes) + "</script>\n";
  };
  add("bodies", packed.bodies);
  for (std::size_t k = 0; k < packed.chunks.size(); ++k)
    add(fmt::format("chunk-{}", k), bytes_of(packed.chunks[k], packed.kept));
  std::string page = page_around(source.title(), data);
  about.bytes = page.size();
  return page;
}

WrittenPage write_page(const ViewSource& source, const std::filesystem::path& target, std::size_t most_bytes) {
  require_page_target(target);
  WrittenPage about;
  write_whole_file(target, {complete_page(source, most_bytes, about)});
  return about;
}

}  // namespace epafi
