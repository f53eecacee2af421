#include "viz_export/vtk/pvd_file.h"

#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>

#include "engine/units/error.h"
#include "viz_export/files/side_file.h"

namespace epafi {

namespace {

/// Value of attribute `key` in a line of a .pvd by this program.
std::optional<std::string> attribute(const std::string& line, const std::string& key) {
  const std::string start = key + "=\"";
  const std::size_t begin = line.find(start);
  if (begin == std::string::npos) return std::nullopt;
  const std::size_t end = line.find('"', begin + start.size());
  if (end == std::string::npos) return std::nullopt;
  return line.substr(begin + start.size(), end - begin - start.size());
}

template <class T>
bool parse(const std::optional<std::string>& text, T& value) {
  if (!text) return false;
  const char* end = text->data() + text->size();
  const auto result = std::from_chars(text->data(), end, value);
  return result.ec == std::errc() && result.ptr == end;
}

/// Escapes a text for use in an attribute.
std::string attribute_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool plain = c != '"' && c != '&' && c != '<' && c != '>' && static_cast<unsigned char>(c) >= 0x20;
    out += plain ? std::string(1, c) : fmt::format("&#{};", static_cast<unsigned>(static_cast<unsigned char>(c)));
  }
  return out;
}

}  // namespace

void PvdFile::keep_until(double time) {
  entries_.clear();
  std::istringstream in(read_whole_file(path_));
  for (std::string line; std::getline(in, line);) {
    if (line.find("<DataSet") == std::string::npos) continue;
    Entry e{};
    const auto file = attribute(line, "file");
    const bool whole = parse(attribute(line, "timestep"), e.time) && parse(attribute(line, "part"), e.part) && file;
    if (!whole && in.eof()) break;  // the last line, cut by a crash
    if (!whole) throw FileError(path_.string() + ": is not a list of frames as Epafi writes it: '" + line + "'");
    e.file = *file;
    e.group = attribute(line, "group").value_or("");
    if (e.time <= time) entries_.push_back(e);
  }
}

void PvdFile::add(double time, int part, const std::string& file) {
  entries_.push_back({time, part, file, attribute_text(group_)});
}

namespace {
constexpr const char* pvd_closing = "</Collection>\n</VTKFile>\n";

std::string pvd_line(const PvdFile::Entry& e) {
  return fmt::format("<DataSet timestep=\"{:.17g}\"{} part=\"{}\" file=\"{}\"/>\n", e.time,
                     e.group.empty() ? "" : " group=\"" + e.group + "\"", e.part, e.file);
}
}  // namespace

void PvdFile::write() {
  std::string text;
  if (end_ == 0) {
    text =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
        "<Collection>\n";
    listed_ = 0;
  }
  for (; listed_ < entries_.size(); ++listed_) text += pvd_line(entries_[listed_]);
  if (end_ == 0) {
    write_whole_file(path_, {text, pvd_closing});
  } else {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(end_);
    file << text + pvd_closing << std::flush;
    if (!file) throw FileError(path_.string() + ": cannot write (is the disk full?)");
  }
  end_ += static_cast<std::streamoff>(text.size());
}

}  // namespace epafi
