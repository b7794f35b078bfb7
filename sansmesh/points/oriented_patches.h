// A cloud with normals summarised by a few thousand plane pieces that tile its surface whatever the sampling density.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/core/box.h"
#include "sansmesh/core/vec.h"

namespace sansmesh {

/// Plane pieces as a structure of arrays; all arrays have the same length.
struct OrientedPatches {
  std::vector<Vec3f> positions;  ///< Centroids.
  std::vector<Vec3f> normals;    ///< Unit, outward.
  std::vector<float> areas;      ///< > 0, squared unit of the positions.
  std::vector<float> sizes;      ///< > 0, edge of the cell that the piece was cut by: about the distance to its like.

  std::size_t size() const { return positions.size(); }
};

/// Cuts space into cubes, one plane piece for each sheet that passes through a cube:
/// - Cubes have the edge `cell` (> 0, finite, else ArgumentError; enlarged to 2⁻²⁰ of the box if smaller) where there
///   are samples enough, twice, four times ... that where they are sparse, so that few cubes of the surface are empty.
/// - Samples of a cube are split into up to three sheets by the directions of their normals (edges, thin walls).
/// - The area of a piece is that of its plane within the cube, not that of its samples: neighbouring pieces tile.
///   Pieces of one cube end at each other's planes; next to empty cubes (borders, outliers) they end at their samples.
/// - Noise or misregistration up to about a quarter of `cell` does not count twice: the plane belongs to the samples
///   on both sides of the cube's face, hence cuts only one of the two cubes.
/// positions, normals: same length (else ArgumentError); samples that are not finite or have no normal are left out.
/// O(n), parallel; the result does not depend on the number of threads. Empty for no samples.
OrientedPatches make_patches(std::span<const Vec3f> positions, std::span<const Vec3f> normals, double cell);

/// Cell for make_patches: about 16 000 cubes on a surface half as large as that of `box`, at least 4 `noise` (standard
/// deviation) and 2.5 `spacing` (typical distance of neighbours), at most 1/8 of the box's longest side. Positive even
/// for a box without extent.
double suggest_cell(const Box3& box, double spacing, double noise);

}  // namespace sansmesh
