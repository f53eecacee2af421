#include "viz_export/view/contact_file.h"

#include <charconv>
#include <cstring>
#include <string>

#include "engine/units/error.h"
#include "viz_export/files/side_file.h"

namespace epafi {
namespace {

/// The appended arrays of a .vtp by name.
class VtpArrays {
 public:
  explicit VtpArrays(const std::filesystem::path& path) : path_(path), text_(read_whole_file(path)) {
    const std::size_t tag = text_.find("<AppendedData");
    const std::size_t underscore = tag == text_.npos ? tag : text_.find('_', tag);
    if (underscore == text_.npos || text_.find("compressor=") < tag) refuse("has no plain appended data");
    head_ = text_.substr(0, tag);
    data_ = underscore + 1;
  }

  std::size_t lines() const { return number_behind(head_.find("<Piece "), "NumberOfLines=\""); }

  bool has(const std::string& name) const { return head_.find("Name=\"" + name + "\"") != head_.npos; }

  /// Exactly `count` values.
  template <class T>
  std::vector<T> read(const std::string& name, std::size_t count) const {
    const std::size_t tag = head_.find("Name=\"" + name + "\"");
    if (tag == head_.npos) refuse("has no array '" + name + "'");
    const std::size_t at = data_ + number_behind(tag, "offset=\"");
    std::uint64_t bytes = 0;
    if (at + sizeof bytes > text_.size()) refuse("is cut");
    std::memcpy(&bytes, text_.data() + at, sizeof bytes);
    if (bytes != count * sizeof(T) || bytes > text_.size() - at - sizeof bytes) refuse("is cut in '" + name + "'");
    std::vector<T> out(count);
    std::memcpy(out.data(), text_.data() + at + sizeof bytes, bytes);
    return out;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { throw FileError(path_.string() + ": " + what); }

  std::size_t number_behind(std::size_t from, const std::string& word) const {
    const std::size_t at = from == head_.npos ? from : head_.find(word, from);
    if (at == head_.npos) refuse("lacks " + word);
    std::size_t value = 0;
    const char* end = head_.data() + head_.size();
    if (std::from_chars(head_.data() + at + word.size(), end, value).ec != std::errc())
      refuse("has no number behind " + word);
    return value;
  }

  const std::filesystem::path& path_;
  std::string text_, head_;
  std::size_t data_ = 0;  ///< begin of the appended data
};

Eigen::Vector3f third(const std::vector<float>& values, std::size_t k) {
  return {values[3 * k], values[3 * k + 1], values[3 * k + 2]};
}

}  // namespace

ContactFile read_contacts(const std::filesystem::path& path) {
  const VtpArrays file(path);
  const std::size_t n = file.lines();
  if (n == 0) return {};
  const auto points = file.read<float>("Points", 6 * n);
  const auto force = file.read<float>("force", 3 * n);
  const auto normal = file.read<float>("normal_force", n);
  const auto overlap = file.read<float>("overlap", n);
  const auto a = file.read<std::uint32_t>("id_a", n);
  const auto b = file.read<std::uint32_t>("id_b", n);
  ContactFile out{std::vector<StoredContact>(n), file.has("residual")};
  const std::vector<float> residual = out.has_residual ? file.read<float>("residual", n) : std::vector<float>(n);
  for (std::size_t k = 0; k < n; ++k)
    out.contacts[k] = {a[k],      b[k],       third(points, 2 * k), third(points, 2 * k + 1), third(force, k),
                       normal[k], overlap[k], residual[k]};
  return out;
}

}  // namespace epafi
