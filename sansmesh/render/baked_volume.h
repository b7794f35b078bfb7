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

namespace sansmesh::inline v1 {

struct BakeOptions {
  /// Bricks are split where the error is larger: a share of the range of the values, 1e-6..1.
  double tolerance = 0.004;
  /// Bytes that nodes may take, 1 MB at least; what is left out then are the bricks of the smallest errors.
  std::size_t memory = std::size_t{128} << 20;
  /// Known to be in the volume or on its boundary, such as its samples; those that are not finite are left out. Bricks
  /// that no point of was found inside are split while they hold some, until their cells are as fine as the spacing
  /// there: thin shells and small parts are found only by these. Must outlive refine(), as the field.
  std::span<const Vec3> places = {};
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// How near a baked field is to the field that it stands for.
struct BakeReport {
  double least = 0, most = 0;  ///< of the values found in the volume
  /// At those of 20,000 points spread evenly over the box that are in the volume, and where fewer than one in 50 is, as
  /// many of the places, too; they are others than the points that decided what was split. Shares of the range. The
  /// largest is that of these points, no bound: between them the field may be farther off.
  double error_mean = 0, error_most = 0;
  std::size_t checked = 0;  ///< points that these errors were found at
  /// Largest at the middles of all cells in the volume, which decided; no bound either.
  double cell_error_most = 0;
  std::size_t bricks = 0, bytes = 0;
  std::uint64_t evaluations = 0;  ///< of the field, so far
  int levels = 0;                 ///< of bricks
  /// Nothing is left to split: the tolerance holds, or cells are half the spacing, beyond which nothing is known, or
  /// as fine as it where splits did not help twice in a row (values that jump), or where only places tell of the
  /// volume. False: the memory was at its end, or refine() is to go on.
  bool finished = false;

  static const ReportSchema& schema();
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
  /// `degrees` are 1.
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
