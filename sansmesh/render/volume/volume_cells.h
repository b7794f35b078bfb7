// A coarse grid over a volume with the spacing and the value range of each cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/progress.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// Rays take their step length from it and skip clear cells.
class VolumeCells {
 public:
  /// Ranges are those of VolumeField::ranges. If the field has none, they follow from values and gradients at points
  /// about as far apart as the samples, extrapolated by the gradients between these points; cells that would need too
  /// many points have infinite ranges. `field` has one component; `other` may be null.
  VolumeCells(const VolumeField& field, const VolumeField* other, Progress& progress);

  const Box3& box() const { return box_; }
  const std::array<int, 3>& counts() const { return counts_; }
  const Vec3& edge() const { return edge_; }
  std::size_t size() const { return spacing_.size(); }
  /// The cell of a point (world coordinates); points outside belong to the nearest cell.
  std::size_t cell(const Vec3& x) const {
    std::size_t index = 0;
    for (std::size_t k = 3; k-- > 0;) {
      const double at = (x[k] - box_.lower[k]) * inverse_[k];
      const int most = counts_[k] - 1;
      const int i = at > 0 ? (at < most ? static_cast<int>(at) : most) : 0;
      index = index * static_cast<std::size_t>(counts_[k]) + static_cast<std::size_t>(i);
    }
    return index;
  }
  Vec3 center(std::size_t cell) const {
    Vec3 x = box_.lower;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto n = static_cast<std::size_t>(counts_[k]);
      x[k] += (static_cast<double>(cell % n) + 0.5) * edge_[k];
      cell /= n;
    }
    return x;
  }
  /// Parameter t at which a line x + t d inside a cell leaves it, or leaves the block that has `around` more cells in
  /// each direction.
  double exit(std::size_t cell, const Vec3& x, const Vec3& d, std::size_t around = 0) const;
  double spacing(std::size_t cell) const { return static_cast<double>(spacing_[cell]); }
  const ValueRange& range(std::size_t cell) const { return ranges_[cell]; }
  /// Of the other field.
  const ValueRange& other_range(std::size_t cell) const { return other_ranges_[cell]; }

 private:
  void find_ranges(const VolumeField& field, std::vector<ValueRange>& ranges, Progress& progress) const;

  Box3 box_;
  std::array<int, 3> counts_{1, 1, 1};
  Vec3 edge_, inverse_;
  std::vector<float> spacing_;
  std::vector<ValueRange> ranges_, other_ranges_;
};

namespace detail {
/// Replaces 1 for each clear cell by one more than the number of clear layers around it, at most 255. Cells beyond the
/// grid count as clear.
void clear_reach(const VolumeCells& cells, std::span<std::uint8_t> clear);
}  // namespace detail

}  // namespace sansmesh::inline v1
