// Vertices and triangles of a cut, with names that identify vertices shared by simplices.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

constexpr std::uint32_t kNoName = ~std::uint32_t{0};

/// Identifies a vertex in all simplices that share it: on a lattice edge by its ends and the piece; in a face by its
/// corners and two pieces; inside a simplex by the simplex and the pieces.
using CutName = std::array<std::uint32_t, 6>;

/// Maps names to indices in order of first use.
class CutNames {
 public:
  std::uint32_t number(const CutName& name) {
    if (2 * names_.size() >= table_.size()) grow();
    std::size_t at = scattered(name) & (table_.size() - 1);
    while (table_[at] != kNoName && names_[table_[at]] != name) at = (at + 1) & (table_.size() - 1);
    if (table_[at] == kNoName) {
      table_[at] = static_cast<std::uint32_t>(names_.size());
      names_.push_back(name);
    }
    return table_[at];
  }
  const std::vector<CutName>& names() const { return names_; }

 private:
  static std::size_t scattered(const CutName& name) {
    std::uint64_t h = 0;
    for (const std::uint32_t k : name) h = (h ^ h >> 29 ^ k) * 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(h ^ h >> 32);
  }
  void grow() {
    table_.assign(std::max<std::size_t>(64, 2 * table_.size()), kNoName);
    for (std::uint32_t i = 0; i < names_.size(); ++i) {
      std::size_t at = scattered(names_[i]) & (table_.size() - 1);
      while (table_[at] != kNoName) at = (at + 1) & (table_.size() - 1);
      table_[at] = i;
    }
  }
  std::vector<std::uint32_t> table_;
  std::vector<CutName> names_;
};

/// The part of a cut that one task makes.
struct CutChunk {
  CutNames names;
  std::vector<Vec3> x;
  std::vector<float> size, room;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> piece;
  std::optional<Vec3> cracked;
};

}  // namespace sansmesh::inline v1
