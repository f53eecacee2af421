/// @file state_snapshot.h  The whole state kept in memory: the last good state of a run that may fail.
#pragma once
#include <map>

#include "engine/error.h"
#include "engine/state_visitor.h"

namespace epafi {

class StateSnapshot {
 public:
  /// `walk(visitor)` shows all state. Buffers are reused from one save to the next.
  template <class Walk>
  void save(const Walk& walk) {
    Saver saver(columns_);
    walk(saver);
    saved_ = true;
  }
  template <class Walk>
  void restore(const Walk& walk) {
    Loader loader(columns_);
    walk(loader);
  }
  bool saved() const { return saved_; }

 private:
  using Columns = std::map<std::string, std::vector<std::byte>, std::less<>>;
  struct Saver final : StateVisitor {
    explicit Saver(Columns& c) : columns(c) {}
    Columns& columns;
    std::size_t bytes_of(std::string_view, std::size_t, std::size_t current) override { return current; }
    void exchange(std::string_view name, std::size_t, std::byte* data, std::size_t bytes) override {
      auto found = columns.find(name);
      if (found == columns.end()) found = columns.emplace(std::string(name), std::vector<std::byte>{}).first;
      found->second.assign(data, data + bytes);
    }
  };
  struct Loader final : StateVisitor {
    explicit Loader(Columns& c) : columns(c) {}
    Columns& columns;
    std::size_t bytes_of(std::string_view name, std::size_t, std::size_t) override {
      const auto found = columns.find(name);
      EPAFI_REQUIRE(found != columns.end(), "every column was saved");
      return found->second.size();
    }
    void exchange(std::string_view name, std::size_t, std::byte* data, std::size_t bytes) override {
      const auto& from = columns.find(name)->second;
      if (bytes > 0) std::memcpy(data, from.data(), bytes);
    }
  };
  Columns columns_;
  bool saved_ = false;
};

}  // namespace epafi
