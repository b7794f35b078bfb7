// Shapes with an edge or a corner: tests on the normals, a quadric for each face, and their combination.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/surface/mpu/shape_fits.h"

namespace sansmesh::inline v1 {

/// Assignment of unit normals to up to kMostPieces faces.
struct FaceSplit {
  std::size_t faces = 1;
  std::vector<std::uint8_t> face;  ///< face of each normal, < faces
};

/// Tests of ohtake2003, section 4 (after Kobbelt et al. 2001). Two normals with a cosine below 0.9 indicate an edge. A
/// third one that deviates from the plane of both, with a cosine above 0.7 to their normal, indicates a corner; if the
/// normals that do so differ like those of an edge, a corner of degree 4.
FaceSplit split_by_normals(std::span<const Vec3> normals);

/// A quadric for each face, combined by the maxima and minima with the least distance of the samples from the zero set;
/// nothing for a single face.
std::optional<LocalShape> piecewise_shape(const BallSamples& samples, int degree);

}  // namespace sansmesh::inline v1
