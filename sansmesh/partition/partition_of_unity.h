// Adaptive partition of unity implicits (METHODS §3.1): F(x) = Σ f_i(x) θ_i(x) / Σ θ_i(x).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sansmesh/partition/partition_data.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

struct PartitionState;

class PartitionOfUnity : public ScalarField {
 public:
  /// The function that the data describe. They are taken as they are: `PartitionData::validate` checks those of a file.
  explicit PartitionOfUnity(PartitionData data);

  Box3 bounds() const override;
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;

  /// From proven slopes of the local functions (PartitionData::slopes), the weights, and a measured slope of the far
  /// field; widened for rounding. As narrow as a few slopes times the radius where neighbouring functions agree; in
  /// balls that very many supports reach, infinite.
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

  /// All that it is made of; positions relative to its origin.
  const PartitionData& data() const;
  /// The local functions: one per support, then further pieces of those with a crease.
  std::span<const LocalFunction> functions() const { return data().functions.view(); }
  const PartitionReport& report() const { return data().report; }

  /// A tree of blocks for polygonisation: fine enough that linear interpolation over its simplices stays within about
  /// `mesh_error` (length) of the surface on average, and fine at creases and where sheets come close; no finer than
  /// level `deepest`.
  BlockTree mesh_blocks(double mesh_error, int deepest = BlockTree::kMaxLevel) const;

  /// A point on or near the surface in every support: where a walk along the surface may start.
  std::vector<Vec3> seeds() const;

 private:
  std::shared_ptr<const PartitionState> state_;  // built once; copies share it
};

}  // namespace sansmesh::inline v1
