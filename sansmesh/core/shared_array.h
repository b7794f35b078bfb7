// Shared immutable arrays, either owned or views into a mapped file.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace sansmesh::inline v1 {

/// Constant array of T that keeps its memory alive. Copies share the memory.
template <class T>
class SharedArray {
 public:
  SharedArray() = default;
  /// Takes ownership of the values.
  SharedArray(std::vector<T> values) {  // NOLINT(google-explicit-constructor): a vector converts to an array
    auto owner = std::make_shared<const std::vector<T>>(std::move(values));
    view_ = *owner;
    owner_ = std::move(owner);
  }
  /// View of memory that stays unchanged as long as `owner` lives.
  SharedArray(std::span<const T> view, std::shared_ptr<const void> owner) : owner_(std::move(owner)), view_(view) {}

  std::span<const T> view() const { return view_; }
  std::size_t size() const { return view_.size(); }
  bool empty() const { return view_.empty(); }
  const T* data() const { return view_.data(); }
  const T& operator[](std::size_t i) const { return view_[i]; }
  auto begin() const { return view_.begin(); }
  auto end() const { return view_.end(); }
  /// Mutable copy of the values.
  std::vector<T> copy() const { return {view_.begin(), view_.end()}; }

 private:
  std::shared_ptr<const void> owner_;
  std::span<const T> view_;
};

}  // namespace sansmesh::inline v1
