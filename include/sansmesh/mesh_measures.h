// Measures of meshes: topology, quality, distance, coverage, alignment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Topology of a mesh. Counts refer to triangles with three different corners; others only count as degenerate.
/// Vertices are identified by index, not by position: a triangle soup has three boundary edges per triangle.
struct SANSMESH_API MeshTopology {
  std::size_t vertices = 0;              ///< used by a triangle
  std::size_t unused_vertices = 0;       ///< used by no triangle
  std::size_t triangles = 0;             ///< with three different corners
  std::size_t degenerate_triangles = 0;  ///< with a repeated or nonexistent corner, or without area
  std::size_t edges = 0;                 ///< distinct unordered pairs of vertices
  std::size_t boundary_edges = 0;        ///< edges of one triangle
  std::size_t boundary_loops = 0;        ///< connected sets of boundary edges: holes, if the rest is manifold
  std::size_t nonmanifold_edges = 0;     ///< edges of three or more triangles
  std::size_t nonmanifold_vertices = 0;  ///< vertices whose triangles form several fans
  std::size_t inconsistent_edges = 0;    ///< edges of two triangles that traverse it in the same direction
  /// Edges traversed more often in one direction than in the other: all boundary edges, and edges of inconsistently
  /// oriented faces.
  std::size_t open_edges = 0;
  std::size_t components = 0;         ///< sets of triangles connected by shared vertices
  std::size_t largest_component = 0;  ///< number of triangles of the largest component
  long euler = 0;                     ///< Euler characteristic: vertices − edges + triangles

  /// Whether no edge has three or more triangles and every vertex has one fan: a surface, possibly with boundary.
  bool manifold() const { return nonmanifold_edges == 0 && nonmanifold_vertices == 0; }
  /// Whether the two triangles of every edge are consistently oriented.
  bool oriented() const { return inconsistent_edges == 0; }
  /// Whether no edge is open: the enclosed volume does not depend on the reference point, even if the mesh is not
  /// manifold.
  bool encloses() const { return triangles > 0 && open_edges == 0; }
  /// Whether the mesh is the surface of a solid: no boundary, manifold, consistently oriented. Self-intersections are
  /// not checked.
  bool closed() const { return triangles > 0 && boundary_edges == 0 && manifold() && oriented(); }
  /// Total number of handles of all components; nothing unless manifold and oriented, where it is defined.
  std::optional<long> genus() const {
    if (triangles == 0 || !manifold() || !oriented()) return std::nullopt;
    return static_cast<long>(components) - (euler + static_cast<long>(boundary_loops)) / 2;
  }

  static const ReportSchema& schema();  ///< a row per reported value
};

/// Measures the topology in parallel. Linear in time and memory.
SANSMESH_API MeshTopology measure_topology(const TriangleMesh& mesh);

/// Shapes and sizes of the triangles with an area; lengths in the mesh's unit, angles in degrees.
struct SANSMESH_API MeshQuality {
  std::size_t triangles = 0;  ///< number of triangles with an area
  /// Mean aspect ratio AR = l_max P / (4 √3 S) with longest edge l_max, perimeter P, area S: 1 for an equilateral
  /// triangle (tejada2008, 3.3). Ratios above 1e6 count as 1e6, so that one sliver does not hide the rest.
  double aspect_mean = 0;
  double aspect_deviation = 0;     ///< standard deviation of the aspect ratio
  double aspect_max = 0;           ///< largest aspect ratio, at most 1e6
  double smallest_angle_mean = 0;  ///< mean of the triangles' smallest angles: at best 60
  double smallest_angle = 0;       ///< smallest angle of all triangles
  double small_angle_share = 0;    ///< share (0..1) of triangles with an angle below 10°
  double edge_mean = 0;            ///< mean length of the triangles' edges (inner edges count twice)
  double area = 0;                 ///< length²
  /// length³, by the divergence theorem; positive if the triangles face outward. Undefined for open meshes.
  double volume = 0;

  static const ReportSchema& schema();  ///< a row per reported value
};

/// Measures the quality. Independent of the number of threads.
SANSMESH_API MeshQuality measure_quality(const TriangleMesh& mesh);

/// Distances from the samples of one surface to the closest points of the other. Lengths in the input's unit.
struct SANSMESH_API OneWayDistance {
  std::size_t samples = 0;  ///< number of samples
  double mean = 0;          ///< mean distance
  double rms = 0;           ///< root mean square distance
  double p95 = 0;           ///< 95 % quantile of the distances
  double max = 0;           ///< largest distance (one-sided Hausdorff distance of the samples)
  /// Mean angle between the tangent planes at a sample and its closest point (degrees, 0..90). Absent if one side is
  /// points without normals.
  std::optional<double> angle;
  /// Mean angle between the normals, with their signs (degrees, 0..180).
  std::optional<double> signed_angle;

  static const ReportSchema& schema();  ///< a row per reported value
};

/// Two-sided distance between two surfaces.
struct SurfaceDistance {
  OneWayDistance to_reference;    ///< accuracy: distances of the result from the reference
  OneWayDistance from_reference;  ///< completeness: distances of the reference from the result
  double diagonal = 0;            ///< diagonal of the reference's bounding box
  /// Length in percent of the reference's diagonal.
  double percent(double length) const { return diagonal > 0 ? 100 * length / diagonal : 0; }
};

/// Share of points that are far from a reference.
struct SANSMESH_API FarPoints {
  std::size_t tested = 0;       ///< number of points
  double beyond = 0;            ///< distance from which a point counts as far (length)
  double share = 0;             ///< share of far points, 0..1
  std::optional<Vec3> densest;  ///< point around which most far points are (input); absent if none is far

  static const ReportSchema& schema();  ///< a row per reported value
};

/// Coverage of the samples by a mesh, and of the mesh by the samples.
struct SANSMESH_API MeshCoverage {
  double spacing = 0;  ///< estimated spacing of the samples (length)
  double noise = 0;    ///< estimated noise of the samples: standard deviation (length)
  FarPoints lost;      ///< samples without a surface
  FarPoints invented;  ///< surface without samples

  static const ReportSchema& schema();  ///< a row per reported value
};

/// Start of the search for a motion.
enum class AlignStart : std::uint8_t {
  automatic,   ///< given pose; if the search fails, all poses
  given_pose,  ///< given pose only
  anywhere     ///< all rotations, and similar-looking regions
};

/// Options of surface alignment.
struct SANSMESH_API SurfaceAlignmentOptions {
  AlignStart start = AlignStart::automatic;  ///< start of the search
  /// Number of samples of the moving surface in the last steps, 100..10^7.
  std::size_t samples = 20000;
  /// Largest number of steps of each search, 1..1000.
  int iterations = 100;
  /// Also estimate a uniform scale.
  bool find_scale = false;

  static const OptionSchema& schema();  ///< a row per field
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Similarity motion x → scale · R (x − from) + to in world coordinates; x, y, z are the columns of R.
struct SANSMESH_API SimilarityMotion {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< columns of R: images of the unit vectors
  double scale = 1;                         ///< uniform scale, > 0
  Vec3 from;                                ///< centre before the motion
  Vec3 to;                                  ///< image of the centre

  /// R v, for directions.
  Vec3 rotate(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
  /// Image of a position.
  Vec3 operator()(const Vec3& p) const { return rotate(p - from) * scale + to; }
  /// Angle of the rotation, 0..180 degrees.
  double angle() const;
  Vec3 axis() const;  ///< unit axis of the rotation; arbitrary if the angle is 0
  /// Motion as an affine map.
  AffineMap map() const;
};

/// Motion, and fit of the surfaces. Lengths in the unit of the fixed surface.
struct SANSMESH_API SurfaceAlignment {
  SimilarityMotion motion;                    ///< motion of the moving surface
  AlignStart start = AlignStart::given_pose;  ///< start from which the motion was found
  int iterations = 0;                         ///< steps of the last search
  std::size_t samples = 0;                    ///< number of compared samples
  /// Share (0..1) of the samples on the fixed surface: within `reach` of it, not beyond its boundary, and with a
  /// similar normal.
  double overlap = 0;
  double reach = 0;          ///< length, see above
  double rms = 0;            ///< distance of these samples from the surface, root mean square
  double median = 0;         ///< median distance of these samples from the surface
  double p95 = 0;            ///< 95 % quantile of that distance
  double median_before = 0;  ///< median distance of all samples from the surface before the motion
  /// Displacement of the samples, root mean square.
  double moved = 0;
  /// Number of other poses with the same fit (within 2 %): symmetries of the shape. Only if they were searched for.
  std::size_t alternatives = 0;
  bool searched = false;                   ///< whether other poses were searched for
  std::vector<double> alternative_angles;  ///< rotation angles to these poses, in degrees
  /// Number of the six (seven) degrees of freedom that the surfaces do not determine: 3 for a sphere, 1 for a surface
  /// of revolution.
  int free_motions = 0;
  /// Share (0..1) of the samples near the fixed surface whose shape differs from it: neighbouring samples deviate
  /// alike, unlike noise.
  double differing = 0;
  double differing_by = 0;  ///< median distance of these samples from the fixed surface
  /// The mirror image of the moving surface fits, but the surface itself does not. Checked only if the shapes differ.
  bool mirror_image_fits = false;
  /// Whether the motion is plausible: the overlap is at least a fifth.
  bool found = false;
  /// Size of the moving surface over that of the fixed one, before the motion: radii around the centre that contain
  /// three quarters of the points.
  double size_ratio = 1;

  static const ReportSchema& schema();  ///< a row per reported value
};

}  // namespace sansmesh::inline v1
