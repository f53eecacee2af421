/// @file state_snapshot.h  The whole state kept aside: the last good state of a run that may fail. Small states stay in
/// memory; large ones go to a scratch file, where they do not double what a sphere takes (270 bytes with its springs).
#pragma once
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

#include "engine/state/state_visitor.h"
#include "engine/units/error.h"

namespace epafi {

class StateSnapshot {
 public:
  /// Bytes of a state above which it goes to the file: writing 4 MB takes 1 ms, and less is cheap to hold.
  static constexpr std::size_t most_in_memory = std::size_t{4} << 20;

  StateSnapshot() = default;
  /// scratch: a file of this name holds large states while this lives; it has no entry in its folder.
  explicit StateSnapshot(std::filesystem::path scratch) : scratch_(std::move(scratch)) {}

  /// `walk(visitor)` shows all state. Buffers are reused from one save to the next.
  template <class Walk>
  void save(const Walk& walk) {
    ByteCounter size;
    walk(size);
    begin(size.total);
    Saver saver(*this);
    walk(saver);
    if (file_ != nullptr && failed_) {  // no room on the disk: memory has to do
      scratch_.clear();
      begin(size.total);
      walk(saver);
    }
    saved_ = true;
  }
  template <class Walk>
  void restore(const Walk& walk) {
    Loader loader(*this);
    walk(loader);
  }
  bool saved() const { return saved_; }
  bool in_file() const { return file_ != nullptr; }

 private:
  struct Stretch {
    std::size_t begin = 0, bytes = 0;
  };
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  struct Saver final : StateVisitor {
    explicit Saver(StateSnapshot& to) : to(to) {}
    StateSnapshot& to;
    std::size_t bytes_of(std::string_view, std::size_t, std::size_t current) override { return current; }
    void exchange(std::string_view name, std::size_t, std::byte* data, std::size_t bytes) override {
      to.put(name, data, bytes);
    }
  };
  struct Loader final : StateVisitor {
    explicit Loader(StateSnapshot& from) : from(from) {}
    StateSnapshot& from;
    std::size_t bytes_of(std::string_view name, std::size_t, std::size_t) override {
      const auto found = from.columns_.find(name);
      EPAFI_REQUIRE(found != from.columns_.end(), "every column was saved");
      return found->second.bytes;
    }
    void exchange(std::string_view name, std::size_t, std::byte* data, std::size_t) override {
      from.get(from.columns_.find(name)->second, data);
    }
  };

  void begin(std::size_t bytes);
  void put(std::string_view name, const std::byte* data, std::size_t bytes);
  void get(const Stretch& stretch, std::byte* data);

  std::filesystem::path scratch_;
  std::map<std::string, Stretch, std::less<>> columns_;
  std::vector<std::byte> memory_;
  std::unique_ptr<std::FILE, Close> file_;
  std::size_t written_ = 0;
  bool saved_ = false, failed_ = false;
};

inline void StateSnapshot::begin(std::size_t bytes) {
  written_ = 0;
  failed_ = false;
  if (bytes > most_in_memory && !scratch_.empty()) {
    if (file_ == nullptr) {
      file_.reset(std::fopen(scratch_.c_str(), "wb+"));
      std::error_code none;
      std::filesystem::remove(scratch_, none);  // its room is freed with the last handle, whatever ends the run
    } else {
      std::rewind(file_.get());
    }
  } else {
    file_.reset();
  }
  if (file_ == nullptr)
    memory_.resize(std::max(memory_.size(), bytes));
  else
    std::vector<std::byte>().swap(memory_);
}

inline void StateSnapshot::put(std::string_view name, const std::byte* data, std::size_t bytes) {
  auto found = columns_.find(name);
  if (found == columns_.end()) found = columns_.emplace(std::string(name), Stretch{}).first;
  found->second = {written_, bytes};
  if (file_ != nullptr)
    failed_ = failed_ || std::fwrite(data, 1, bytes, file_.get()) != bytes;
  else if (bytes > 0)
    std::memcpy(memory_.data() + written_, data, bytes);
  written_ += bytes;
}

inline void StateSnapshot::get(const Stretch& stretch, std::byte* data) {
  if (stretch.bytes == 0) return;
  if (file_ == nullptr) {
    std::memcpy(data, memory_.data() + stretch.begin, stretch.bytes);
    return;
  }
  std::fflush(file_.get());
  const bool read = std::fseek(file_.get(), static_cast<long>(stretch.begin), SEEK_SET) == 0 &&
                    std::fread(data, 1, stretch.bytes, file_.get()) == stretch.bytes;
  EPAFI_REQUIRE(read, "the scratch file gives back what it took");
  (void)read;
}

}  // namespace epafi
