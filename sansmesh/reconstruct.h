// From samples to a mesh in one call: the front door of the library.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/point_set.h"
#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/prepare_cloud.h"
#include "sansmesh/surface_model.h"

namespace sansmesh {

struct PartitionReport;

/// Which connected components of the surface are kept.
struct ComponentChoice {
  enum class Kind { automatic, all, count } kind = Kind::automatic;
  int count = 1;  ///< for Kind::count: this many of the largest
};

/// All optional lengths are in the unit of the input; where absent they are derived from the data.
struct ReconstructOptions {
  using Faces = FaceUse;
  using Normals = NormalUse;
  Faces faces = Faces::automatic;
  Normals normals = Normals::automatic;
  bool remove_outliers = false;  ///< leave out samples that belong to no surface
  /// Another surface than the adaptive partition of unity, whose own options then mean nothing: max_depth, error,
  /// support, max_degree. It is cut where it leaves its domain of definition: not closed where the samples have
  /// borders.
  std::optional<SurfaceOptions> surface;
  std::optional<int> max_depth;      ///< deepest level of the block tree, 2..12
  std::optional<double> error;       ///< accepted rms error of a local fit (length); default: a tenth of the noise
  std::optional<double> support;     ///< support radius / circumscribed radius of the block, 1.1..2; default 1.5 to 1.8
  int max_degree = 4;                ///< largest degree of the local polynomials, 1..4
  std::optional<double> mesh_error;  ///< accepted mean distance between mesh and surface (length)
  /// At most this many triangles, at least 4 (needs `enhance`); the mesh error then follows from it.
  std::optional<std::size_t> triangles;
  std::optional<double> trim;  ///< cut the surface farther than this from any sample (length); 0 = choose from data
  ComponentChoice components;
  bool sharp = true;  ///< reproduce creases where the data shows them
  bool carry_colors = true;
  bool enhance = true;  ///< few, well-shaped triangles: clustering, smoothing, simplification
  /// Without `enhance`: α of METHODS 3.3, 0 ≤ α < 1: lattice vertices step back from the surface before it is cut out,
  /// by up to α times a quarter of the local block edge.
  double displacement = 0;
  bool measure_quality = false;  ///< fill in the report's aspect ratios (costs a second, unenhanced extraction)

  /// Throws ArgumentError naming the option.
  void validate() const;
};

struct ReconstructReport {
  double spacing = 0;      ///< √(area / samples): edge of the square that one sample stands for (length)
  double noise = 0;        ///< estimated standard deviation of the samples off the surface (length)
  int depth = 0;           ///< deepest level of the block tree used
  std::size_t blocks = 0;  ///< leaf blocks
  std::size_t fits = 0;    ///< local approximations
  int components = 0;      ///< of the mesh written
  double aspect_mean_before = 0, aspect_deviation_before = 0;  ///< aspect ratio of the unenhanced mesh
  double aspect_mean = 0, aspect_deviation = 0;
  double mesh_error = 0;  ///< distance between mesh and surface aimed at (length)
  std::vector<std::string> warnings;
};

/// Points (normals are estimated or oriented if need be) → closed manifold mesh. Throws DataError where the points
/// cannot be reconstructed (fewer than 9, all coincident, collinear or in a plane), ArgumentError for bad options.
TriangleMesh reconstruct(PointSet points, const ReconstructOptions& options, Progress& progress,
                         ReconstructReport* report = nullptr);

/// Distance between mesh and surface worth aiming at, given what fitting learned: two fifths of the surface's own
/// error, but not so little that there are many more vertices than samples.
double default_mesh_error(const PartitionReport& report);

}  // namespace sansmesh
