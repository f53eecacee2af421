/// @file state_visitor.h  Visitor of all state: the same walk saves a checkpoint, loads it, hashes it and counts its
/// bytes. Every owner of state has `void visit(StateVisitor&)`; callers need not know what a column means.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "engine/state/plain.h"
#include "engine/state/state_column.h"

namespace epafi {

/// Owner of the rows of a column. Code that moves bodies to other processes moves these rows with them.
enum class RowsOf : std::uint8_t {
  nobody,        ///< the state as a whole
  bodies,        ///< row k: the body of slot k
  ids,           ///< row k: the slot of body id k
  first_slots,   ///< row k: a slot of contact k, with which a group of columns begins
  second_slots,  ///< its other one
  contacts,      ///< row k: contact k of the group that was begun last
  pairs,         ///< the same with both slots in the first eight bytes of a row, which begins a group
  share          ///< a term of a sum over all processes, or a bool that is true if it is in one of them
};

class StateVisitor {
 public:
  virtual ~StateVisitor() = default;

  /// False if the loaded file has no such column (an older version).
  virtual bool has(std::string_view) const { return true; }
  /// A column of plain values; a loading visitor resizes it. `name` is unique in the walk ("world/position").
  template <class T, class Allocator>
  requires is_plain<T>
  void column(std::string_view name, std::vector<T, Allocator>& values) {
    const std::size_t wanted = bytes_of(name, sizeof(T), values.size() * sizeof(T));
    if (wanted != values.size() * sizeof(T)) values.resize(wanted / sizeof(T));
    exchange(name, sizeof(T), reinterpret_cast<std::byte*>(values.data()), wanted);
  }
  template <class T>
  void column(std::string_view name, StateColumn<T>& values) {
    if (only_counts())
      exchange(name, sizeof(T), nullptr, values.size() * sizeof(T));
    else
      values.as_vector([&](auto& all) { column(name, all); });
  }
  template <class T>
  requires is_plain<T>
  void value(std::string_view name, T& v) {
    bytes_of(name, sizeof(T), sizeof(T));
    exchange(name, sizeof(T), reinterpret_cast<std::byte*>(&v), sizeof(T));
  }
  /// A column whose rows belong to bodies, contacts, ... (RowsOf).
  template <class Column>
  void rows(RowsOf whose, std::string_view name, Column& values) {
    whose_ = whose;
    column(name, values);
    whose_ = RowsOf::nobody;
  }
  /// The same with rows of `numbers` numbers.
  void records(RowsOf whose, std::string_view name, std::size_t numbers, std::vector<double>& values) {
    const std::size_t row = numbers * sizeof(double);
    whose_ = whose;
    values.resize(bytes_of(name, row, values.size() * sizeof(double)) / sizeof(double));
    exchange(name, row, reinterpret_cast<std::byte*>(values.data()), values.size() * sizeof(double));
    whose_ = RowsOf::nobody;
  }
  /// A number that is summed over all processes, or a bool that is true if it is in one of them.
  template <class T>
  void share(std::string_view name, T& v) {
    static_assert(std::is_same_v<T, double> || std::is_same_v<T, bool>);
    whose_ = RowsOf::share;
    value(name, v);
    whose_ = RowsOf::nobody;
  }

 protected:
  /// Owner of the rows of the present column.
  RowsOf whose() const { return whose_; }
  /// `exchange` uses the number of bytes only.
  virtual bool only_counts() const { return false; }
  /// Bytes the column shall have: `current` when saving, the stored size when loading (a multiple of `element`).
  virtual std::size_t bytes_of(std::string_view name, std::size_t element, std::size_t current) = 0;
  /// Copies out of `data` (saving) or into it (loading).
  virtual void exchange(std::string_view name, std::size_t element, std::byte* data, std::size_t bytes) = 0;

 private:
  RowsOf whose_ = RowsOf::nobody;
};

/// Counts the bytes of all columns.
class ByteCounter : public StateVisitor {
 public:
  std::size_t total = 0;

 protected:
  bool only_counts() const override { return true; }
  std::size_t bytes_of(std::string_view, std::size_t, std::size_t current) override { return current; }
  void exchange(std::string_view, std::size_t, std::byte*, std::size_t bytes) override { total += bytes; }
};

}  // namespace epafi
