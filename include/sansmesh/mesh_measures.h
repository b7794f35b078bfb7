// Measures of meshes by themselves and against each other: topology, quality, distance, coverage, alignment.
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

/// How the triangles of a mesh hang together. Counts over the triangles with three different corners; others are only
/// counted as degenerate. Vertices are told apart by index, not by position: a triangle soup has three boundary edges
/// per triangle.
struct SANSMESH_API MeshTopology {
  std::size_t vertices = 0;              ///< used by a triangle
  std::size_t unused_vertices = 0;       ///< used by none
  std::size_t triangles = 0;             ///< with three different corners
  std::size_t degenerate_triangles = 0;  ///< with a repeated corner, a corner that does not exist, or without area
  std::size_t edges = 0;                 ///< different unordered pairs of vertices
  std::size_t boundary_edges = 0;        ///< of one triangle
  std::size_t boundary_loops = 0;        ///< connected sets of boundary edges: holes, where all else is manifold
  std::size_t nonmanifold_edges = 0;     ///< of three triangles or more
  std::size_t nonmanifold_vertices = 0;  ///< whose triangles form several fans
  std::size_t inconsistent_edges = 0;    ///< of two triangles that run through it in the same direction
  /// Edges that more triangles run through in one direction than in the other: all of the boundary, and what else has
  /// faces that contradict each other.
  std::size_t open_edges = 0;
  std::size_t components = 0;         ///< sets of triangles connected by shared vertices
  std::size_t largest_component = 0;  ///< triangles of the largest one
  long euler = 0;                     ///< vertices − edges + triangles

  /// No edge of three triangles or more, and every vertex has one fan: a surface, perhaps with borders.
  bool manifold() const { return nonmanifold_edges == 0 && nonmanifold_vertices == 0; }
  /// No two triangles of an edge contradict each other.
  bool oriented() const { return inconsistent_edges == 0; }
  /// No edge is open: the volume within does not depend on where it is measured from, even if it is not manifold.
  bool encloses() const { return triangles > 0 && open_edges == 0; }
  /// No boundary, manifold, consistently oriented: the surface of a solid (self-intersections are not looked for).
  bool closed() const { return triangles > 0 && boundary_edges == 0 && manifold() && oriented(); }
  /// Number of handles of all components together; nothing unless manifold and oriented, where it has no meaning.
  std::optional<long> genus() const {
    if (triangles == 0 || !manifold() || !oriented()) return std::nullopt;
    return static_cast<long>(components) - (euler + static_cast<long>(boundary_loops)) / 2;
  }

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Counts them. Time and memory linear in the size of the mesh, in parallel.
SANSMESH_API MeshTopology measure_topology(const TriangleMesh& mesh);

/// Shapes and sizes of the triangles, over those with an area; lengths in the unit of the mesh, angles in degrees.
struct SANSMESH_API MeshQuality {
  std::size_t triangles = 0;  ///< that have an area
  /// Aspect ratio AR = l_max P / (4 √3 S) with longest edge l_max, perimeter P, area S: 1 for an equilateral triangle
  /// (METHODS 3.3; tejada2008, section 3.3). Ratios above 1e6 count as 1e6, so that one sliver does not hide the rest.
  double aspect_mean = 0;
  double aspect_deviation = 0;     ///< standard deviation of the aspect ratio
  double aspect_max = 0;           ///< largest aspect ratio, 1e6 at most
  double smallest_angle_mean = 0;  ///< mean over the triangles of their smallest angle: 60 at best
  double smallest_angle = 0;       ///< of all
  double small_angle_share = 0;    ///< share in 0..1 of triangles with an angle below 10°
  double edge_mean = 0;            ///< mean over the triangles' edges (inner ones count twice)
  double area = 0;                 ///< length²
  /// length³, by the divergence theorem; positive if the triangles face outward. Meaningless for open meshes.
  double volume = 0;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Measures them. Deterministic for any number of threads.
SANSMESH_API MeshQuality measure_quality(const TriangleMesh& mesh);

/// Distances from the samples of one surface to the closest points of the other. Lengths in the unit of the input.
struct SANSMESH_API OneWayDistance {
  std::size_t samples = 0;  ///< number of samples
  double mean = 0;          ///< mean distance
  double rms = 0;           ///< root mean square distance
  double p95 = 0;           ///< 95 % quantile of the distances
  double max = 0;           ///< largest distance (one-sided Hausdorff distance of the samples)
  /// Mean angle between the tangent planes at a sample and its closest point (degrees, 0..90). Absent where a side is
  /// points without normals.
  std::optional<double> angle;
  /// The same between the normals, with regard to their signs (degrees, 0..180).
  std::optional<double> signed_angle;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// How far two surfaces are apart, both ways.
struct SurfaceDistance {
  OneWayDistance to_reference;    ///< accuracy: is what was made where it should be?
  OneWayDistance from_reference;  ///< completeness: is all there?
  double diagonal = 0;            ///< of the reference's bounding box
  /// A length in percent of the reference's diagonal.
  double percent(double length) const { return diagonal > 0 ? 100 * length / diagonal : 0; }
};

/// How many of some places are far from all that they should be near.
struct SANSMESH_API FarPlaces {
  std::size_t looked_at = 0;  ///< places
  double beyond = 0;          ///< what counts as far (length)
  double share = 0;           ///< of the places that are far, 0..1
  std::optional<Vec3> most;   ///< one around which most of those lie (input); nothing where none is far

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// What a mesh leaves out of its samples, and what it makes up.
struct SANSMESH_API MeshCoverage {
  double spacing = 0;  ///< of the samples, as estimated (length)
  double noise = 0;    ///< of the samples, as estimated: standard deviation (length)
  FarPlaces lost;      ///< samples without a surface
  FarPlaces invented;  ///< surface without samples

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Where the search for the motion begins.
enum class AlignStart : std::uint8_t {
  automatic,   ///< where the surface lies; if that does not lead to a fit, everywhere
  as_it_lies,  ///< nowhere else
  anywhere     ///< every rotation, and places that look alike
};

/// How a motion is looked for.
struct SANSMESH_API SurfaceAlignmentOptions {
  AlignStart start = AlignStart::automatic;  ///< where the search begins
  /// Samples of the moving surface that are compared in the last steps, 100..10^7.
  std::size_t samples = 20000;
  /// Steps of each search at most, 1..1000.
  int iterations = 100;
  /// Also find one factor for all lengths.
  bool find_scale = false;

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// x → scale · R (x − from) + to, R by its columns, in the coordinates of the world.
struct SANSMESH_API SimilarityMotion {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< column of R: where the unit vector of that axis turns
  double scale = 1;                         ///< factor of lengths, > 0
  Vec3 from;                                ///< centre before the motion
  Vec3 to;                                  ///< where that goes

  /// R v: of a direction.
  Vec3 turn(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
  /// Of a position.
  Vec3 operator()(const Vec3& p) const { return turn(p - from) * scale + to; }
  /// Angle of the rotation, 0..180 degrees.
  double angle() const;
  Vec3 axis() const;  ///< of the rotation: unit; any where the angle is 0
  /// The same as an affine map.
  AffineMap map() const;
};

/// A motion, and how well the surfaces fit by it. Lengths in the unit of the fixed surface.
struct SANSMESH_API SurfaceAlignment {
  SimilarityMotion motion;                    ///< of the moving surface
  AlignStart start = AlignStart::as_it_lies;  ///< from which the motion was found
  int iterations = 0;                         ///< of the last search
  std::size_t samples = 0;                    ///< compared
  /// Share (0..1) of the samples that lie on the fixed surface: within `reach` of it, where it has not ended, and with
  /// a like normal.
  double overlap = 0;
  double reach = 0;          ///< length, see above
  double rms = 0;            ///< distance of these samples from the surface, root mean square
  double median = 0;         ///< distance of these samples from the surface
  double p95 = 0;            ///< 95 % quantile of that distance
  double median_before = 0;  ///< distance of all samples from the surface before the motion
  /// How far the samples were moved, root mean square.
  double moved = 0;
  /// Other poses that fit as well (to 2 %): the shape looks alike from several sides. Only where they were looked for.
  std::size_t alternatives = 0;
  bool searched = false;                   ///< whether they were looked for
  std::vector<double> alternative_angles;  ///< to these, in degrees
  /// Motions, of the six (seven), that the surfaces do not tell: 3 of a ball, 1 of a vase that was turned on a wheel.
  int free_motions = 0;
  /// Share (0..1) of the samples beside the fixed surface at which its shape is another one: their neighbours are off
  /// by the same, which noise is not.
  double differing = 0;
  double differing_by = 0;  ///< median distance of these samples from the fixed surface
  /// The mirror image of what moves fits where it does not itself. Looked for only where the shape differs.
  bool mirror_image_fits = false;
  /// Whether this can be the motion: the overlap is a fifth or more.
  bool found = false;
  /// Size of what moves over that of the fixed surface, as they came: distances from the middle that three quarters of
  /// their points are within.
  double size_ratio = 1;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

}  // namespace sansmesh::inline v1
