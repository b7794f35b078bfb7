// Measures of solids, cross-sections and distance maps.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// An oriented box.
struct SANSMESH_API OrientedBox {
  std::array<Vec3, 3> axes{};     ///< orthonormal, right-handed
  std::array<double, 3> sizes{};  ///< along the axes, descending
  Vec3 center;                    ///< middle of the box

  static const ReportSchema& schema();  ///< one row per figure
};

/// Volume and moments of a solid of density 1; lengths in the unit of the mesh, positions in world coordinates.
struct MassMeasures {
  double volume = 0;                ///< length³; negative if the triangles face inward
  Vec3 center;                      ///< centre of mass
  std::array<double, 3> moments{};  ///< principal moments of inertia about the centre, ascending (length⁵)
  /// Principal axes: orthonormal, right-handed; arbitrary where moments are equal.
  std::array<Vec3, 3> axes{};
};

/// Measures of a set of triangles.
struct SANSMESH_API BodyMeasures {
  std::size_t triangles = 0;          ///< number of triangles measured
  std::size_t boundary_edges = 0;     ///< edges with one triangle
  std::size_t open_edges = 0;         ///< edges whose triangles do not cancel in direction
  std::size_t nonmanifold_edges = 0;  ///< edges with three triangles or more
  double area = 0;                    ///< length²
  Vec3 surface_center;                ///< centroid of the surface
  Box3 box;                           ///< bounding box of the triangles
  /// Volume and moments. Absent unless closed: an open surface has no inside.
  std::optional<MassMeasures> mass;

  /// Every edge is traversed equally often in both directions, so that the volume is independent of the origin.
  bool closed() const { return triangles > 0 && open_edges == 0; }

  /// For a component: winding number of the other closed components around it; 0 outside of all.
  int surrounding = 0;
  /// The sign of its volume fits neither a free solid nor a cavity in another one.
  bool misplaced() const { return mass && surrounding != (mass->volume < 0 ? 1 : 0); }

  static const ReportSchema& schema();  ///< one row per figure
};

/// Measures of a solid, in total and by component.
struct SANSMESH_API SolidMeasures {
  BodyMeasures whole;                    ///< all triangles
  std::vector<BodyMeasures> components;  ///< sets of triangles that share vertices, by descending area
  MeshTopology topology;                 ///< topology of all triangles
  /// The smallest box found: no larger than the axis-aligned box and the box along the principal axes.
  OrientedBox smallest_box;
  /// Triangles with a missing or non-finite corner, or with two equal corners.
  std::size_t left_out = 0;
  std::size_t crossing_pairs = 0;       ///< pairs of intersecting triangles
  std::size_t crossing_components = 0;  ///< components that intersect another one

  static const ReportSchema& schema();  ///< one row per figure
};

/// The plane ⟨normal, x⟩ = offset with a right-handed orthonormal frame (u, v, normal). In-plane coordinates of x are
/// (⟨u, x⟩, ⟨v, x⟩): x and y for z = c, y and z for x = c, z and x for y = c.
struct CutPlane {
  Vec3 normal{0, 0, 1};         ///< unit
  double offset = 0;            ///< distance from the origin along the normal (length)
  Vec3 u{1, 0, 0}, v{0, 1, 0};  ///< unit vectors of the in-plane coordinates

  /// Signed distance of x from the plane, positive on the side of the normal.
  double height(const Vec3& x) const { return dot(normal, x) - offset; }
  /// The point with in-plane coordinates (a, b).
  Vec3 at(double a, double b) const { return u * a + v * b + normal * offset; }
};

/// The plane ⟨normal, x⟩ = offset for a normal of any length (both sides are divided by it). Throws ArgumentError
/// unless all numbers are finite and the normal is not zero.
SANSMESH_API CutPlane cut_plane(const Vec3& normal, double offset);

/// The plane x, y or z (axis 0, 1 or 2) = value.
SANSMESH_API CutPlane axis_plane(int axis, double value);

/// `count` planes perpendicular to an axis at start, start + step, … Throws ArgumentError if count < 1 or > 100000, if
/// the step is not finite, or if it is 0 for several planes.
SANSMESH_API std::vector<CutPlane> plane_series(int axis, double start, double step, int count);

/// `count` planes perpendicular to an axis that cut the box into count + 1 slices of equal thickness.
SANSMESH_API std::vector<CutPlane> spread_planes(const Box3& box, int axis, int count);

/// Three planes x, y and z = c through the centre of the box.
SANSMESH_API std::vector<CutPlane> middle_planes(const Box3& box);

/// Parses "z=0.5", or "nx,ny,nz,d" for ⟨n, x⟩ = d. Throws ArgumentError that quotes the text.
SANSMESH_API CutPlane parse_plane(const std::string& text);

/// Exact text of a plane in the syntax of parse_plane, for schemas (sansmesh/option.h).
SANSMESH_API std::string text_of_option(const CutPlane& plane);

/// Inverse of text_of_option.
inline void option_of_text(std::string_view text, CutPlane& plane) { plane = parse_plane(std::string(text)); }

/// Equation of a plane for display: "z = 0.5", or "0.6 x + 0.8 y = 1".
SANSMESH_API std::string equation(const CutPlane& plane);

/// One polyline of a cross-section. Seen against the normal (u to the right, v up) the solid is on the left of the
/// curve: outer boundaries are counter-clockwise, holes clockwise.
struct SectionCurve {
  std::vector<Vec3> points;                  ///< in space; a closed curve does not repeat its first point
  std::vector<std::array<double, 2>> plane;  ///< the same in plane coordinates (u, v)
  bool closed = false;                       ///< the last point connects to the first
  double length = 0;                         ///< length of the curve
  double area = 0;                           ///< enclosed area, signed by orientation: negative for holes; 0 if open
};

/// Cross-section of a surface with a plane.
struct SANSMESH_API Section {
  CutPlane plane;                    ///< cutting plane
  std::vector<SectionCurve> curves;  ///< open ones first
  double length = 0;                 ///< total length of the curves
  /// Enclosed area (length²): signed sum over the closed curves. Negative if the surface faces inward.
  double area = 0;
  bool closed() const;              ///< every curve is closed
  std::size_t open_curves() const;  ///< number of open curves

  static const ReportSchema& schema();  ///< one row per figure
};

/// Options of a distance map. Lengths are in the unit of the input. Absent values follow from the data.
struct SANSMESH_API DistanceMapOptions {
  /// Points farther away are left out (> 0), since they belong to another object. Default: a tenth of the diagonal of
  /// the reference's box.
  std::optional<double> max_distance = {};
  std::optional<double> within = {};  ///< tolerance (length, >= 0): the statistics report the share within it
  /// Half of the range of the histogram and the colours (> 0). Default: the bound of 99 % of the area, rounded up to
  /// two digits, and at least 1e-6 of the diagonal of the reference's box.
  std::optional<double> color_range = {};
  bool skip_border = false;  ///< leaves out points whose closest point is on the border of an open reference
  bool reversed = false;     ///< maps the reference: distances to the part, with reversed sign

  static const OptionSchema& schema();  ///< one row per field
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Statistics of the measured distances, in the unit of the input. The weight of a mesh vertex is a third of the area
/// of its triangles, so that the density of vertices has no effect; all points of a cloud have the same weight. NaN if
/// nothing was measured.
struct SANSMESH_API DistanceStatistics {
  double mean = 0;                         ///< mean signed distance
  double mean_absolute = 0;                ///< mean absolute distance
  double rms = 0;                          ///< root mean square
  double deviation = 0;                    ///< standard deviation
  double p05 = 0;                          ///< 5 % quantile of the signed distance
  double median = 0;                       ///< median signed distance
  double p95 = 0;                          ///< 95 % quantile of the signed distance
  double p95_absolute = 0;                 ///< 95 % quantile of the absolute distance
  double lowest = 0;                       ///< smallest signed distance, without regard to weights
  double highest = 0;                      ///< largest signed distance, without regard to weights
  Vec3 lowest_at;                          ///< position of the smallest, on the mapped surface (world coordinates)
  Vec3 highest_at;                         ///< position of the largest, on the mapped surface (world coordinates)
  std::optional<double> within_tolerance;  ///< share of the weight within ±tolerance, 0..1; absent without a tolerance
  double area = 0;                         ///< measured area (length²); for points their number
  /// Shares of the weight in kHistogramBins bins of equal width over −range..range (0..range without sides).
  std::vector<double> histogram;
  double below_range = 0;       ///< share of the weight below −range
  double above_range = 0;       ///< share of the weight above range
  double range = 0;             ///< half of the range of the histogram and the colours (length, > 0)
  bool smallest_range = false;  ///< the range is the smallest allowed, since nearly all distances are below it

  static const ReportSchema& schema();  ///< one row per figure
};

/// Distances of the vertices of one surface from another one, in the unit of the input.
struct SANSMESH_API DistanceMap {
  std::vector<float> distance;    ///< per vertex, positive outside; NaN if left out
  bool has_sides = true;          ///< false: distances are absolute
  double max_distance = 0;        ///< value used
  std::size_t measured = 0;       ///< number of vertices with a distance
  std::size_t beyond = 0;         ///< left out: farther away than max_distance
  std::size_t not_found = 0;      ///< left out: the search found no surface
  std::size_t at_border = 0;      ///< closest point on a border; left out only with skip_border
  std::size_t not_finite = 0;     ///< left out: vertices that are not finite or unused
  DistanceStatistics statistics;  ///< statistics of the distances
  /// Of points: the closest point of the other surface to each, relative to the origin of the points; NaN if left out.
  std::vector<Vec3f> feet;

  static const ReportSchema& schema();  ///< one row per figure
};

inline constexpr std::size_t kHistogramBins =
    41;  ///< size of DistanceStatistics::histogram; odd: one bin is centred at 0

}  // namespace sansmesh::inline v1
