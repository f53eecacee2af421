/// @file hdf5_file.h  The only door to HDF5 (C library 1.10): datasets of numbers by path, attributes, groups.
/// Files use the 1.8 format: every piece of structure carries a checksum, and any HDF5 since 2008 reads them.
/// All errors are FileErrors that name the file, the operation and HDF5's innermost cause.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/units/error.h"

namespace epafi {

/// Type of the elements of a dataset.
enum class Hdf5Type { float32, float64, int8, int16, int32, int64, uint8, uint16, uint32, uint64 };

/// HDF5 type of a C++ number.
template <class T>
requires std::is_arithmetic_v<T>
constexpr Hdf5Type hdf5_type() {
  constexpr int size = sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 1 : sizeof(T) == 4 ? 2 : 3;
  if constexpr (std::is_floating_point_v<T>) {
    static_assert(sizeof(T) == 4 || sizeof(T) == 8);
    return sizeof(T) == 4 ? Hdf5Type::float32 : Hdf5Type::float64;
  } else {
    const Hdf5Type first = std::is_signed_v<T> ? Hdf5Type::int8 : Hdf5Type::uint8;
    return static_cast<Hdf5Type>(static_cast<int>(first) + size);
  }
}
static_assert(hdf5_type<std::int64_t>() == Hdf5Type::int64 && hdf5_type<std::uint16_t>() == Hdf5Type::uint16);

/// Layout of a dataset in the file. Rows are the first dimension; `columns` 1 makes it one-dimensional.
struct Hdf5Layout {
  std::size_t columns = 1;
  bool extendable = false;  ///< may be appended to and truncated
  bool compressed = false;  ///< byte shuffle and gzip level 1
  std::size_t chunk_rows = 1024;
};

class Hdf5File {
 public:
  enum class Mode { read, create, append };  ///< create empties an existing file; append needs one
  Hdf5File(const std::filesystem::path& path, Mode mode);
  ~Hdf5File();
  Hdf5File(Hdf5File&&) noexcept;
  Hdf5File& operator=(Hdf5File&&) noexcept;
  /// Writes everything and closes; an error here is reported, in the destructor it would not be.
  void close();

  bool has(const std::string& name) const;
  /// Names in a group, sorted.
  std::vector<std::string> children(const std::string& group) const;
  void make_group(const std::string& name);
  void remove(const std::string& name);

  /// A new dataset; groups on the way are made.
  template <class T>
  void write(const std::string& name, std::span<const T> values, const Hdf5Layout& layout = {}) {
    write_raw(name, hdf5_type<T>(), values.data(), values.size(), layout);
  }
  /// The same of so many rows, by pieces: fill(first, count, values) writes rows first to first + count, one behind the
  /// other. No more than a piece is in memory at once, and that one in the cache.
  template <class T, class Fill>
  void write_pieces(const std::string& name, std::size_t rows, std::size_t columns, const Fill& fill) {
    std::vector<T> piece;
    write_pieces_raw(name, hdf5_type<T>(), rows, columns, [&](std::size_t first, std::size_t count) {
      piece.resize(count * columns);
      fill(first, count, piece.data());
      return static_cast<const void*>(piece.data());
    });
  }
  template <class T>
  void append(const std::string& name, std::span<const T> values) {
    append_raw(name, hdf5_type<T>(), values.data(), values.size());
  }
  /// Rows from `first` on, which are there already.
  template <class T>
  void overwrite(const std::string& name, std::size_t first, std::span<const T> values) {
    overwrite_raw(name, hdf5_type<T>(), first, values.data(), values.size());
  }
  /// Keeps the first `rows` rows of an extendable dataset.
  void truncate(const std::string& name, std::size_t rows);
  /// All elements, row by row. The stored type must be of the same kind and not wider than T.
  template <class T>
  std::vector<T> read(const std::string& name) const {
    std::vector<T> values(elements_checked(name, hdf5_type<T>()));
    read_raw(name, hdf5_type<T>(), values.data());
    return values;
  }
  /// Into memory of the caller: exactly `size` elements.
  template <class T>
  void read_into(const std::string& name, T* values, std::size_t size) const {
    if (elements_checked(name, hdf5_type<T>()) != size) refuse_size(name, size);
    read_raw(name, hdf5_type<T>(), values);
  }
  /// Extent of each dimension; empty for a scalar.
  std::vector<std::size_t> shape(const std::string& name) const;

  void write_text(const std::string& name, const std::string& text);
  std::string read_text(const std::string& name) const;

  /// Attributes of a group or dataset ("/" is the file); an existing one is replaced.
  void set_attribute(const std::string& object, const std::string& key, const std::string& value);
  void set_attribute(const std::string& object, const std::string& key, double value);
  void set_attribute(const std::string& object, const std::string& key, std::uint64_t value);
  bool has_attribute(const std::string& object, const std::string& key) const;
  std::string text_attribute(const std::string& object, const std::string& key) const;
  double number_attribute(const std::string& object, const std::string& key) const;
  std::uint64_t count_attribute(const std::string& object, const std::string& key) const;

  const std::filesystem::path& path() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  void write_raw(const std::string&, Hdf5Type, const void*, std::size_t elements, const Hdf5Layout&);
  using Piece = std::function<const void*(std::size_t first, std::size_t count)>;
  void write_pieces_raw(const std::string&, Hdf5Type, std::size_t rows, std::size_t columns, const Piece&);
  void append_raw(const std::string&, Hdf5Type, const void*, std::size_t elements);
  void overwrite_raw(const std::string&, Hdf5Type, std::size_t first, const void*, std::size_t elements);
  std::size_t elements_checked(const std::string&, Hdf5Type) const;
  void read_raw(const std::string&, Hdf5Type, void*) const;
  [[noreturn]] void refuse_size(const std::string&, std::size_t wanted) const;
};

}  // namespace epafi
