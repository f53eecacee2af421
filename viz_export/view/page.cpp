#include "viz_export/view/page.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/error.h"
#include "viz_export/html_text.h"
#include "viz_export/side_file.h"
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

/// A run packed as a page holds it.
struct Packed {
  std::string manifest, bodies;
  std::vector<std::string> chunks;
  std::vector<std::size_t> sizes;  ///< of each column, summed over the chunks

  std::size_t page_bytes() const {
    std::size_t bytes = bodies.size();
    for (const std::string& chunk : chunks) bytes += chunk.size();
    return bytes / 3 * 4 + manifest.size();
  }
};

Packed pack(const ViewSource& source, const Overview& overview, const PackPlan& plan,
            const std::vector<std::string>& notes) {
  const Packer packer(source, overview, plan);
  Packed out{packer.manifest(notes), packer.bodies(), {}, std::vector<std::size_t>(packer.columns().size(), 0)};
  for (std::size_t k = 0; k < packer.chunks(); ++k) {
    std::vector<std::size_t> sizes;
    out.chunks.push_back(packer.chunk(k, &sizes));
    for (std::size_t c = 0; c < sizes.size(); ++c) out.sizes[c] += sizes[c];
  }
  return out;
}

/// The next thing to leave out, with its note; frames where nothing else is left.
std::string leave_out(PackPlan& plan, const Overview& overview, std::size_t bytes, std::size_t most) {
  if (plan.headings) {
    plan.headings = false;
    return "directions of velocities are left out to keep this page small";
  }
  if (plan.least_force == 0.0f && overview.strongest > 0) {
    plan.least_force = 0.1f * overview.strongest;
    return fmt::format("contacts below {:.3g} N are left out to keep this page small", plan.least_force);
  }
  if (plan.least_force > 0) {
    plan.least_force = -1;
    return "contacts are left out to keep this page small";
  }
  plan.least_force = -1;
  plan.stride *= std::max<std::size_t>(2, (bytes + most - 1) / most);
  return fmt::format("one frame of {} is shown, to keep this page small", plan.stride);
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
  PackPlan plan;
  Packed packed = pack(source, overview, plan, {});
  const std::size_t own = page_around(source.title(), "").size();
  const std::size_t most = most_bytes > 2 * own ? most_bytes - own : own;
  while (packed.page_bytes() > most && plan.stride < source.times().size()) {
    const std::string note = leave_out(plan, overview, packed.page_bytes(), most);
    if (note.starts_with("one frame") && !about.notes.empty() && about.notes.back().starts_with("one frame"))
      about.notes.pop_back();
    if (note.starts_with("contacts") && !about.notes.empty() && about.notes.back().starts_with("contacts"))
      about.notes.pop_back();
    about.notes.push_back(note);
    packed = pack(source, overview, plan, about.notes);
  }
  std::string data =
      "<script type=\"application/json\" id=\"manifest\">" + script_escaped(packed.manifest) + "</script>\n";
  const auto add = [&](const std::string& id, const std::string& bytes) {
    data += "<script type=\"text/plain\" id=\"" + id + "\">" + base64(bytes) + "</script>\n";
  };
  add("bodies", packed.bodies);
  for (std::size_t k = 0; k < packed.chunks.size(); ++k) add(fmt::format("chunk-{}", k), packed.chunks[k]);
  std::string page = page_around(source.title(), data);
  about.bytes = page.size();
  return page;
}

WrittenPage write_page(const ViewSource& source, const std::filesystem::path& target, std::size_t most_bytes) {
  WrittenPage about;
  write_whole_file(target, {complete_page(source, most_bytes, about)});
  return about;
}

}  // namespace epafi
