// Arrays that never change, shared instead of copied: owned in memory, or a view into a mapped file.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace sansmesh::inline v1 {

/// A constant array of T that keeps alive what it lies in. Copies share; an edit makes a new one.
template <class T>
class SharedArray {
 public:
  SharedArray() = default;
  /// Takes the values over.
  SharedArray(std::vector<T> values) {  // NOLINT(google-explicit-constructor): an array is what a vector becomes
    auto owner = std::make_shared<const std::vector<T>>(std::move(values));
    view_ = *owner;
    owner_ = std::move(owner);
  }
  /// A view of memory that stays as it is as long as `owner` lives.
  SharedArray(std::span<const T> view, std::shared_ptr<const void> owner) : owner_(std::move(owner)), view_(view) {}

  std::span<const T> view() const { return view_; }
  std::size_t size() const { return view_.size(); }
  bool empty() const { return view_.empty(); }
  const T* data() const { return view_.data(); }
  const T& operator[](std::size_t i) const { return view_[i]; }
  auto begin() const { return view_.begin(); }
  auto end() const { return view_.end(); }
  /// A copy to change.
  std::vector<T> copy() const { return {view_.begin(), view_.end()}; }

 private:
  std::shared_ptr<const void> owner_;
  std::span<const T> view_;
};

}  // namespace sansmesh::inline v1
