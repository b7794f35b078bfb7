// Choice of the surface and of the neighbourhood that estimate the curvatures of given samples with the least error.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/curvature_fit.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Sizes of neighbourhoods that are compared.
inline constexpr std::array<std::size_t, 11> kCurvatureSizes{20, 28, 40, 56, 80, 112, 160, 224, 320, 448, 640};
/// Number of samples at which they are compared.
inline constexpr std::size_t kTestedCurvatures = 400;

/// Neighbourhoods of one sample.
struct TestedNeighbourhoods {
  struct Part {
    std::size_t count = 0;  ///< number of offsets; 0: too few samples
    double radius = 0;      ///< largest distance
  };
  Vec3 normal;
  std::vector<Vec3> offsets;  ///< from the sample to all neighbours, the smallest neighbourhood first
  std::array<Part, kCurvatureSizes.size()> parts;
  // Of a mesh:
  std::vector<Vec3> along_edges;  ///< offsets to the next vertices, then to their next
  std::array<Part, 2> rings;      ///< the first, and both
};

struct CurvatureChoice {
  std::size_t neighbours = kCurvatureSizes[0];
  CurvatureSurface surface = CurvatureSurface::quadric;
  bool exact = false;  ///< noise contributes little to the error of a quartic, so it may pass through the samples
};

/// Nearest samples on the same sheet, for all sizes. False at samples without a normal.
bool find_nearest(const KdTree& tree, const PointSet& points, std::uint32_t sample, TestedNeighbourhoods& to);

/// Finds the neighbourhoods of tested sample i; false if it has none.
using FindNeighbourhoods = std::function<bool(std::size_t i, TestedNeighbourhoods& found)>;

/// The choice with the least expected error at `tested` samples. The error due to noise (length) follows from the
/// weights of a fit, the error due to shape from the change of the curvatures to a larger neighbourhood. `make_finder`
/// is called for each range of samples, so that a finder may have its own memory. `only_quadrics`: other surfaces are
/// not considered.
CurvatureChoice choose_curvature(std::size_t tested, const std::function<FindNeighbourhoods()>& make_finder,
                                 double noise, bool only_quadrics);

/// Whether the options require the equations of a source, so that other surfaces do not apply.
bool only_quadrics(const CurvatureOptions& options);

}  // namespace sansmesh::inline v1::detail
