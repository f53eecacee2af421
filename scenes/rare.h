/// @file rare.h  An optional value that few of many objects have; if absent it takes only a pointer, so that a million
/// bodies do not pay for the motion of one drum.
#pragma once
#include <memory>
#include <optional>
#include <utility>

namespace epafi {

template <class T>
class Rare {
 public:
  Rare() = default;
  Rare(T value) : value_(std::make_unique<T>(std::move(value))) {}
  Rare(std::optional<T> value) : value_(value ? std::make_unique<T>(std::move(*value)) : nullptr) {}
  Rare(const Rare& o) : value_(o.value_ ? std::make_unique<T>(*o.value_) : nullptr) {}
  Rare(Rare&&) noexcept = default;
  Rare& operator=(Rare o) noexcept {
    value_ = std::move(o.value_);
    return *this;
  }
  ~Rare() = default;

  explicit operator bool() const { return value_ != nullptr; }
  bool has_value() const { return value_ != nullptr; }
  const T& operator*() const { return *value_; }
  const T* operator->() const { return value_.get(); }

 private:
  std::unique_ptr<T> value_;
};

}  // namespace epafi
