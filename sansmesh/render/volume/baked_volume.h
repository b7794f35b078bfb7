// A field sampled once, so that pictures of it take no time: a tree of bricks, as fine as the field needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

struct BakeOptions {
  /// Bricks are split where the error is larger: a share of the range of the values, 1e-6..1.
  double tolerance = kBakeError;
  /// Bytes that nodes may take, 1 MB at least; what is left out then are the bricks of the smallest errors.
  std::size_t memory = std::size_t{128} << 20;
  /// Known to be in the volume or on its boundary, such as its samples; those that are not finite are left out. Bricks
  /// that no point of was found inside are split while they hold some, until their cells are as fine as the spacing
  /// there: thin shells and small parts are found only by these. Must outlive refine(), as the field.
  std::span<const Vec3> places = {};
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Bricks of 8³ cells with values and gradients at the 9³ nodes, each linear in between in all three directions; the
/// tree splits bricks into eight. Where bricks of different size meet, nodes of the finer one that lie on the coarser
/// one take what that says there: values and gradients are continuous, without a rule on how much neighbours differ.
class BakedVolume : public VolumeField {
 public:
  /// `field` has one component; it must outlive refine(), not the baked volume. Throws ArgumentError for others, and
  /// for bad options, DataError where it has no extent.
  BakedVolume(const VolumeField& field, const BakeOptions& options, Progress& progress);
  /// Without any refinement but `rounds` of it: for pictures while more is on its way.
  BakedVolume(const VolumeField& field, const BakeOptions& options, int rounds, Progress& progress);
  ~BakedVolume() override;
  BakedVolume(const BakedVolume&) = delete;
  BakedVolume& operator=(const BakedVolume&) = delete;

  /// Splits all bricks whose errors are too large once, as far as the memory reaches, those of the largest errors
  /// first. False: there was none. Not while others evaluate.
  bool refine(Progress& progress);

  const BakeReport& report() const;

  Box3 bounds() const override;
  std::size_t components() const override { return 1; }
  /// About 30 ns a point and thread. `inside`: what most of the nodes around a point are, weighted by their distance.
  void evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const override;
  /// That of the field where cells are finer, else the shortest edge of the cell around each of x.
  void spacing(std::span<const Vec3> x, std::span<double> found) const override;
  /// Exact bounds of the values of all bricks that a box touches.
  void ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
