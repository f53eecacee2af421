// The Stanford polygon format (Turk 1994): ASCII and both binary orders; vertices with x, y, z, faces with one list.
#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>

#include "detection/shapes/mesh_file.h"
#include "detection/shapes/mesh_text.h"
#include "detection/shapes/polygon_ears.h"

namespace epafi {
namespace {

enum class Order { text, little, big };

struct Property {
  std::string name;
  std::size_t bytes = 0;  ///< of one value
  bool real = false, is_signed = false;
  std::size_t count_bytes = 0;  ///< of a list: of its length; 0: a single value
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

/// Size and kind of a type by either of its names; 0 bytes: unknown.
Property type_named(std::string_view name) {
  struct Type {
    std::string_view a, b;
    std::size_t bytes;
    bool real, is_signed;
  };
  constexpr Type types[] = {{"char", "int8", 1, false, true},    {"uchar", "uint8", 1, false, false},
                            {"short", "int16", 2, false, true},  {"ushort", "uint16", 2, false, false},
                            {"int", "int32", 4, false, true},    {"uint", "uint32", 4, false, false},
                            {"float", "float32", 4, true, true}, {"double", "float64", 8, true, true}};
  for (const Type& t : types)
    if (name == t.a || name == t.b) return {"", t.bytes, t.real, t.is_signed};
  return {};
}

struct Header {
  Order order = Order::text;
  std::vector<Element> elements;
  std::size_t end = 0;  ///< first byte of the data
  int lines = 0;
};

Property read_property(MeshText& text) {
  auto word = text.word();
  std::size_t count_bytes = 0;
  if (word == "list") {
    const Property length = type_named(text.word());
    if (length.bytes == 0 || length.real) text.fail("expected an integer type for the length of a list");
    count_bytes = length.bytes;
    word = text.word();
  }
  Property p = type_named(word);
  if (p.bytes == 0) text.fail(fmt::format("unknown type {}", MeshText::named(word)));
  p.count_bytes = count_bytes;
  p.name = std::string(text.word());
  return p;
}

/// Every element that the header announces needs its bytes: checked before any memory is taken.
void check_counts(MeshText& text, const Header& header, std::size_t file_size) {
  const std::size_t left = file_size - std::min(header.end, file_size);
  double least = 0.0;
  for (const Element& e : header.elements) {
    if (e.count > 0 && e.properties.empty()) text.fail(fmt::format("element '{}' has no property", e.name));
    std::size_t row = 0;
    for (const Property& p : e.properties)  // a value in text is a digit and a blank
      row += header.order == Order::text ? 2 : p.count_bytes > 0 ? p.count_bytes : p.bytes;
    least += static_cast<double>(e.count) * static_cast<double>(row);
  }
  if (least > static_cast<double>(left) + 1.0)
    text.fail(fmt::format("the header announces at least {:.0f} bytes of data, the file has {}", least, left));
}

Header read_header(std::string_view bytes, const std::string& file) {
  MeshText text(bytes, file);
  Header header;
  bool has_format = false;
  text.next_line();
  ++header.lines;
  text.expect("ply");
  while (text.next_line()) {
    ++header.lines;
    const auto first = text.word();
    if (first == "end_header") {
      if (!has_format) text.fail("the header names no format");
      header.end = text.offset();
      check_counts(text, header, bytes.size());
      return header;
    }
    if (first == "comment" || first == "obj_info" || first.empty()) continue;
    if (first == "format") {
      const auto name = text.word();
      if (name == "ascii")
        header.order = Order::text;
      else if (name == "binary_little_endian")
        header.order = Order::little;
      else if (name == "binary_big_endian")
        header.order = Order::big;
      else
        text.fail(fmt::format("unknown format {}", MeshText::named(name)));
      has_format = true;
    } else if (first == "element") {
      const auto name = text.word();
      const double count = text.number();
      if (!(count >= 0) || count > 4e9 || count != std::floor(count)) text.fail("expected a number of elements");
      header.elements.push_back({std::string(name), static_cast<std::size_t>(count), {}});
    } else if (first == "property") {
      if (header.elements.empty()) text.fail("a property before the first element");
      header.elements.back().properties.push_back(read_property(text));
    } else {
      text.fail(fmt::format("unknown statement {} in the header", MeshText::named(first)));
    }
  }
  text.fail("the file ends where 'end_header' is expected");
}

/// Values of the data part, one after the other.
class Values {
 public:
  Values(std::string_view bytes, const Header& header, const std::string& file)
      : order_(header.order),
        text_(bytes.substr(std::min(header.end, bytes.size())), file, false, header.lines),
        bytes_(bytes),
        at_(header.end),
        file_(file) {}
  /// Before each element of an ASCII file.
  void next_row() {
    if (order_ != Order::text) return;
    do
      if (!text_.next_line()) cut();
    while (text_.line().find_first_not_of(" \t\r") == std::string_view::npos);
  }
  /// Behind each element of an ASCII file: a word too many has moved those before it.
  void end_row() {
    if (order_ == Order::text) text_.expect_end();
  }
  /// wanted: else it may be no number ("nan" of a quality).
  double next(std::size_t size, bool real, bool is_signed, bool wanted = true) {
    if (order_ == Order::text && !wanted && !text_.word().empty()) return 0.0;
    if (order_ == Order::text) {
      const double value = text_.number(real);
      return real && size == 4 ? double{static_cast<float>(value)} : value;
    }
    if (size == 0 || at_ + size > bytes_.size()) cut();
    std::uint64_t raw = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const auto byte = static_cast<unsigned char>(bytes_[at_ + (order_ == Order::little ? size - 1 - k : k)]);
      raw = raw << 8 | byte;
    }
    at_ += size;
    if (real)
      return size == 4 ? double{std::bit_cast<float>(static_cast<std::uint32_t>(raw))} : std::bit_cast<double>(raw);
    const std::uint64_t sign = std::uint64_t{1} << (8 * size - 1);
    return is_signed && (raw & sign) ? -static_cast<double>(2 * sign - raw) : static_cast<double>(raw);
  }
  double written_precision() const { return text_.written_precision(); }
  [[noreturn]] void fail(const std::string& what) const {
    if (order_ == Order::text) text_.fail(what);
    throw SceneError(what, {file_, 0, 0});
  }

 private:
  [[noreturn]] void cut() const {
    throw SceneError("the file ends before all elements of its header are read", {file_, 0, 0});
  }
  Order order_;
  MeshText text_;
  std::string_view bytes_;
  std::size_t at_;
  std::string file_;
};

std::vector<double> read_list(Values& values, const Property& p, bool wanted) {
  const double count = p.count_bytes ? values.next(p.count_bytes, false, false) : 1.0;
  if (!(count >= 0) || count > 1e6 || count != std::floor(count)) values.fail("the length of a list is out of range");
  std::vector<double> list;
  for (auto left = static_cast<long>(count); left > 0; --left)
    list.push_back(values.next(p.bytes, p.real, p.is_signed, wanted));
  return list;
}

void read_vertex(Values& values, const Element& element, TriangleSurface& surface) {
  Vec3 x = Vec3::Zero();
  for (const Property& p : element.properties) {
    const std::size_t axis = p.name.size() == 1 ? std::string("xyz").find(p.name) : std::string::npos;
    const auto list = read_list(values, p, axis != std::string::npos);
    if (axis != std::string::npos && !list.empty()) x[static_cast<int>(axis)] = list[0];
  }
  if (!x.allFinite()) values.fail(fmt::format("vertex {} is not finite", surface.vertices.size()));
  surface.vertices.push_back(x);
}

void read_polygon(Values& values, const Element& element, TriangleSurface& surface) {
  for (const Property& p : element.properties) {
    const bool wanted = p.name == "vertex_indices" || p.name == "vertex_index";
    const auto list = read_list(values, p, wanted);
    if (!wanted) continue;
    if (list.size() < 3) values.fail(fmt::format("a face needs at least 3 vertices, found {}", list.size()));
    for (const double v : list)
      if (!(v >= 0) || v >= static_cast<double>(surface.vertices.size()) || v != std::floor(v))
        values.fail(fmt::format("vertex index {} is out of range: {} vertices", v, surface.vertices.size()));
    std::vector<std::uint32_t> polygon;
    for (const double v : list) polygon.push_back(static_cast<std::uint32_t>(v));
    append_polygon(surface.vertices, std::move(polygon), surface.triangles);
  }
}

}  // namespace

MeshFile read_ply(std::string_view bytes, const std::string& file, MeshFaces faces) {
  const Header header = read_header(bytes, file);
  Values values(bytes, header, file);
  TriangleSurface surface;
  for (const Element& element : header.elements)
    for (std::size_t k = 0; k < element.count; ++k) {
      values.next_row();
      if (element.name == "vertex")
        read_vertex(values, element, surface);
      else if (element.name == "face")
        read_polygon(values, element, surface);
      else
        for (const Property& p : element.properties) read_list(values, p, false);
      values.end_row();
    }
  return finished_mesh(std::move(surface), file, faces, values.written_precision());
}

}  // namespace epafi
