// A field sampled once for fast pictures: a tree of bricks with adaptive resolution.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "sansmesh/progress.h"
#include "sansmesh/render/volume/bake_options.h"
#include "sansmesh/report.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {
namespace detail {
struct BakedBricks;
}  // namespace detail

/// Bricks of 8³ cells with values and gradients at the 9³ nodes and trilinear interpolation; the tree splits bricks
/// into eight. Where bricks of different size meet, nodes of the finer one take the values of the coarser one. So
/// values and gradients are continuous without a rule on the size difference of neighbours.
class BakedVolume : public VolumeField {
 public:
  /// `field` has one component; it must outlive refine(), not the baked volume. Throws ArgumentError for other fields
  /// and bad options, DataError if it has no extent.
  BakedVolume(const VolumeField& field, const BakeOptions& options, Progress& progress);
  /// Stops after `rounds` rounds of refinement: for previews.
  BakedVolume(const VolumeField& field, const BakeOptions& options, int rounds, Progress& progress);
  ~BakedVolume() override;
  BakedVolume(const BakedVolume&) = delete;
  BakedVolume& operator=(const BakedVolume&) = delete;

  /// One round of refinement: splits all bricks with too large errors, those of the largest errors first, within the
  /// memory limit. Returns false if there was none. Not thread-safe with evaluation.
  bool refine(Progress& progress);

  const BakeReport& report() const;

  Box3 bounds() const override;
  std::size_t components() const override { return 1; }
  /// About 30 ns per point and thread. `inside`: that of most nodes around a point, weighted by their distance.
  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const override;
  /// The field's spacing where cells are finer, else the shortest edge of the cell at each x.
  void spacing(std::span<const Vec3> x, std::span<double> found) const override;
  /// Exact bounds of the values of all bricks that a box touches.
  void ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const override;

 private:
  void summarize();

  std::unique_ptr<detail::BakedBricks> bricks_;
};

}  // namespace sansmesh::inline v1
