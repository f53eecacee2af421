#include "scenes/reader/file_kind.h"

#include <string_view>

namespace epafi {

namespace {

struct KindText {
  FileKind kind;
  std::string_view name, taken_by;
  std::vector<std::string_view> marks;  ///< tables and keys that no other kind has
};

const std::vector<KindText>& all_kinds() {
  static const std::vector<KindText> all{
      {FileKind::scene, "a scene", "epafi run", {"run", "world", "body", "bodies", "fill", "detection", "measure"}},
      {FileKind::patch_case, "a patch case", "epafi patch", {"patch"}},
      {FileKind::study, "a study", "epafi chart or epafi limits", {"scene", "vary", "parameters", "fails_when"}}};
  return all;
}

const Member* first_mark(const Node& root, const KindText& kind) {
  for (const Member& member : root.members)
    for (const std::string_view mark : kind.marks)
      if (member.key == mark) return &member;
  return nullptr;
}

}  // namespace

bool report_other_kind(Reading& reading, FileKind expected) {
  const KindText& own = all_kinds()[static_cast<std::size_t>(expected)];
  if (first_mark(reading.root, own) != nullptr) return false;
  for (const KindText& other : all_kinds()) {
    const Member* mark = first_mark(reading.root, other);
    if (mark == nullptr) continue;
    const bool is_table = mark->value.type == Node::Type::table || mark->value.is_array_of_tables();
    reading.error(is_table ? mark->value.place : mark->place,
                  "'" + mark->key + "': this file is " + std::string(other.name) + ", not " + std::string(own.name) +
                      "; it is for " + std::string(other.taken_by));
    return true;
  }
  return false;
}

}  // namespace epafi
