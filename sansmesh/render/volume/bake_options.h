// Options of baked volumes.
#pragma once

#include <cstddef>
#include <span>

#include "sansmesh/vec.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

struct BakeOptions {
  /// Error above which bricks are split: a share of the range of the values, 1e-6..1.
  double tolerance = kBakeError;
  /// Memory limit of the nodes in bytes, at least 1 MB; bricks of the smallest errors are not split.
  std::size_t memory = std::size_t{128} << 20;
  /// Points known to be in the volume or on its boundary, usually its samples; non-finite ones are left out. A brick
  /// without points found inside is split while it contains some of these, until its cells are as fine as the local
  /// spacing: only these points reveal thin shells and small parts. They must outlive refine(), like the field.
  std::span<const Vec3> samples = {};
  /// Throws ArgumentError naming the field.
  void validate() const;
};

}  // namespace sansmesh::inline v1
