// Adaptive partition of unity implicits (tejada2008, 4.4; polizelli): F(x) = Σ f_i(x) θ_i(x) / Σ θ_i(x).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sansmesh/field/field_hints.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

struct PartitionState;

class PartitionOfUnity : public ScalarField, public SignField, public CreaseField {
 public:
  /// Function described by the data. They are not checked: `PartitionData::validate` checks those of a file.
  explicit PartitionOfUnity(PartitionData data);

  Box3 bounds() const override;
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void evaluate_signs(std::span<const Vec3> x, std::span<double> values, std::span<std::uint8_t> sized) const override;
  /// In the balls of supports with a crease.
  void find_creases(std::span<const Vec3> x, std::span<std::uint8_t> near) const override;

  /// Bounds from proven slopes of the local functions (PartitionData::slopes), the weights, and a measured slope of the
  /// far field; widened for rounding. Where neighbouring functions agree, the width is a few slopes times the radius;
  /// infinite in balls that very many supports reach.
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

  /// The complete data; positions relative to its origin.
  const PartitionData& data() const;
  /// Local functions: one per support, then further pieces of creased ones.
  std::span<const LocalFunction> functions() const { return data().functions.view(); }
  const PartitionReport& report() const { return data().report; }

  /// Tree of blocks for polygonisation. Linear interpolation over its simplices is within about `mesh_error` (length)
  /// of the surface on average; blocks are fine at creases and where sheets are close, and at most on level `deepest`.
  BlockTree mesh_blocks(double mesh_error, int deepest = BlockTree::kMaxLevel) const;

  /// A point on or near the surface in every support: starting points of a walk along the surface.
  std::vector<Vec3> seeds() const;

 private:
  std::shared_ptr<const PartitionState> state_;  // built once; copies share it
};

}  // namespace sansmesh::inline v1
