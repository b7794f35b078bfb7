// Shapes with an edge or a corner: tests on the normals, a quadric for each face, and how these combine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/surface/mpu/shape_fits.h"

namespace sansmesh::inline v1 {

/// For each of these unit normals which of up to kMostPieces faces it belongs to.
struct FaceSplit {
  std::size_t faces = 1;
  std::vector<std::uint8_t> face;  ///< < faces
};

/// The tests of [ohtake2003], section 4 (after Kobbelt et al. 2001): two normals whose cosine is below 0.9 are those
/// of an edge; a third one that deviates from the plane of both, by a cosine above 0.7 to their normal, is that of a
/// corner, and where those that do so differ like the normals of an edge, of one of degree 4.
FaceSplit split_by_normals(std::span<const Vec3> normals);

/// A quadric for each face, combined by those maxima and minima that leave the samples nearest to the zero set; nothing
/// where there is one face.
std::optional<LocalShape> piecewise_shape(const BallSamples& samples, int degree);

}  // namespace sansmesh::inline v1
