// Measures of solids, cross-sections and maps of distances.
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

/// A box in any direction.
struct SANSMESH_API OrientedBox {
  std::array<Vec3, 3> axes{};     ///< orthonormal, right-handed
  std::array<double, 3> sizes{};  ///< along the axes, descending
  Vec3 center;                    ///< middle of the box

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Volume and moments of a solid of density 1; lengths in the unit of the mesh, positions in world coordinates.
struct MassMeasures {
  double volume = 0;                ///< length³; negative if the triangles face inward
  Vec3 center;                      ///< of mass
  std::array<double, 3> moments{};  ///< principal moments of inertia about the centre, ascending (length⁵)
  /// Axes of these: orthonormal, right-handed. Where moments are equal any axes do.
  std::array<Vec3, 3> axes{};
};

/// Measures of a set of triangles.
struct SANSMESH_API BodyMeasures {
  std::size_t triangles = 0;          ///< that were measured
  std::size_t boundary_edges = 0;     ///< of one triangle
  std::size_t open_edges = 0;         ///< that more triangles run through in one direction than in the other
  std::size_t nonmanifold_edges = 0;  ///< of three triangles or more
  double area = 0;                    ///< length²
  Vec3 surface_center;                ///< mean of the surface's points
  Box3 box;                           ///< around the triangles
  /// Volume and moments. Only if closed: there is no inside otherwise.
  std::optional<MassMeasures> mass;

  /// Every edge is run through as often in one direction as in the other: then the volume does not depend on where it
  /// is measured from.
  bool closed() const { return triangles > 0 && open_edges == 0; }

  /// Of a component: the winding number of the other closed components around it. 0 outside of all of them.
  int surrounding = 0;
  /// Its volume is neither that of a solid that stands free nor that of a cavity in one.
  bool misplaced() const { return mass && surrounding != (mass->volume < 0 ? 1 : 0); }

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Measures of a solid, as a whole and by components.
struct SANSMESH_API SolidMeasures {
  BodyMeasures whole;                    ///< all triangles together
  std::vector<BodyMeasures> components;  ///< sets of triangles that share vertices, largest area first
  MeshTopology topology;                 ///< of the whole
  /// The box of least volume that was found: not larger than the upright one, nor than that along the principal axes.
  OrientedBox smallest_box;
  /// Triangles with a corner that is not finite or missing, or with two corners that are one.
  std::size_t left_out = 0;
  std::size_t crossing_pairs = 0;       ///< pairs of triangles that cut through each other
  std::size_t crossing_components = 0;  ///< components that cut through another one

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// The points x with ⟨normal, x⟩ = offset, and a frame (u, v, normal), right-handed and orthonormal. The coordinates of
/// x within the plane are (⟨u, x⟩, ⟨v, x⟩): for z = c these are x and y, for x = c y and z, for y = c z and x.
struct CutPlane {
  Vec3 normal{0, 0, 1};         ///< unit
  double offset = 0;            ///< distance from 0, along the normal (length)
  Vec3 u{1, 0, 0}, v{0, 1, 0};  ///< unit vector along that coordinate within the plane

  /// Signed distance of x from the plane: positive on the side that the normal points to.
  double height(const Vec3& x) const { return dot(normal, x) - offset; }
  /// The point with coordinates (a, b) within the plane.
  Vec3 at(double a, double b) const { return u * a + v * b + normal * offset; }
};

/// The plane ⟨normal, x⟩ = offset for a normal of any length (both are divided by it). Throws ArgumentError unless all
/// is finite and the normal has a direction.
SANSMESH_API CutPlane cut_plane(const Vec3& normal, double offset);

/// The plane x, y or z (axis 0, 1 or 2) = value.
SANSMESH_API CutPlane axis_plane(int axis, double value);

/// `count` planes across an axis at start, start + step, … Throws ArgumentError if count < 1 or > 100000, the step is
/// not finite, or 0 for several planes.
SANSMESH_API std::vector<CutPlane> plane_series(int axis, double start, double step, int count);

/// `count` planes across an axis that cut the box into count + 1 slices of equal thickness.
SANSMESH_API std::vector<CutPlane> spread_planes(const Box3& box, int axis, int count);

/// Three planes, x, y and z = c, through the middle of the box.
SANSMESH_API std::vector<CutPlane> middle_planes(const Box3& box);

/// Reads a plane: "z=0.5", or "nx,ny,nz,d" for ⟨n, x⟩ = d. Throws ArgumentError that quotes the text.
SANSMESH_API CutPlane parse_plane(const std::string& text);

/// A plane as parse_plane reads it, to the last digit: its words in schemas (sansmesh/option.h).
SANSMESH_API std::string text_of_option(const CutPlane& plane);

/// The same way back, by parse_plane.
inline void option_of_text(std::string_view text, CutPlane& plane) { plane = parse_plane(std::string(text)); }

/// A plane as its equation, for people to read: "z = 0.5", or "0.6 x + 0.8 y = 1".
SANSMESH_API std::string equation(const CutPlane& plane);

/// One curve of a cross-section: a polyline. Seen against the plane's normal (u to the right, v up) the solid lies to
/// the left of its direction: outer boundaries run counter-clockwise, holes clockwise.
struct SectionCurve {
  std::vector<Vec3> points;                  ///< in space; the first is not repeated at the end of a closed curve
  std::vector<std::array<double, 2>> plane;  ///< the same in the plane's coordinates (u, v)
  bool closed = false;                       ///< the last point is joined to the first
  double length = 0;                         ///< of the curve
  double area = 0;  ///< enclosed, with the sign of the direction: negative for holes; 0 if open
};

/// Cross-section of a surface with a plane.
struct SANSMESH_API Section {
  CutPlane plane;                    ///< that cuts
  std::vector<SectionCurve> curves;  ///< open ones first
  double length = 0;                 ///< of all curves together
  /// Enclosed area (length²): sum over the closed curves: holes are subtracted. Negative if the surface faces inward.
  double area = 0;
  bool closed() const;              ///< whether every curve is
  std::size_t open_curves() const;  ///< curves that are not closed

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// What a map of distances measures and shows. Lengths in the unit of the input. What is absent follows from the data.
struct SANSMESH_API DistanceMapOptions {
  /// Places farther off than this belong to something else and are left out (> 0). Default: a tenth of the diagonal of
  /// the reference's box.
  std::optional<double> max_distance = {};
  std::optional<double> within = {};  ///< length: the statistics tell which share keeps within it (>= 0)
  /// Half of the range of the histogram and of the colours (> 0). Default: what 99 % of the area stays within, rounded
  /// up to two digits, but at least 1e-6 of the diagonal of the reference's box.
  std::optional<double> color_range = {};
  bool skip_border = false;  ///< leave out places whose closest point lies on the border of an open reference
  bool reversed = false;     ///< the map lies on the reference, distances are to the part, with their sign reversed

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Statistics of distances, over what was measured. Lengths in the unit of the input. On a mesh every vertex weighs as
/// much as a third of the area of its triangles, so that dense places count no more than others; points all weigh the
/// same. NaN where nothing was measured.
struct SANSMESH_API DistanceStatistics {
  double mean = 0;                         ///< of the signed distance
  double mean_absolute = 0;                ///< mean of its absolute value
  double rms = 0;                          ///< root mean square
  double deviation = 0;                    ///< standard deviation from the mean
  double p05 = 0;                          ///< 5 % quantile of the signed distance
  double median = 0;                       ///< of the signed distance
  double p95 = 0;                          ///< 95 % quantile of the signed distance
  double p95_absolute = 0;                 ///< 95 % quantile of its absolute value
  double lowest = 0;                       ///< least signed distance of all that was measured, whatever its weight
  double highest = 0;                      ///< largest signed distance of all that was measured, whatever its weight
  Vec3 lowest_at;                          ///< where that is, on the mapped surface (world coordinates)
  Vec3 highest_at;                         ///< where that is, on the mapped surface (world coordinates)
  std::optional<double> within_tolerance;  ///< share of the weight within ±tolerance, 0..1; nothing without one
  double area = 0;                         ///< that was measured (length²); of points: their number
  /// Share of the weight in kHistogramBins bins of equal width over −range..range (0..range without sides).
  std::vector<double> histogram;
  double below_range = 0;       ///< share of the weight below −range
  double above_range = 0;       ///< share of the weight above range
  double range = 0;             ///< half of the range of the histogram and of the colours (length, > 0)
  bool smallest_range = false;  ///< it is the smallest, since nearly everything lies nearer

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Distances of the vertices of one surface from another one. Lengths in the unit of the input.
struct SANSMESH_API DistanceMap {
  std::vector<float> distance;    ///< of every vertex; positive outside; NaN where it was left out
  bool has_sides = true;          ///< false: only absolute values are known
  double max_distance = 0;        ///< as used
  std::size_t measured = 0;       ///< vertices with a distance
  std::size_t beyond = 0;         ///< left out: farther than max_distance
  std::size_t not_found = 0;      ///< left out: no surface could be found from there
  std::size_t at_border = 0;      ///< whose closest point lies on a border; left out only with skip_border
  std::size_t not_finite = 0;     ///< left out: vertices that are not finite, or that no triangle uses
  DistanceStatistics statistics;  ///< of the distances

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

inline constexpr std::size_t kHistogramBins = 41;  ///< of DistanceStatistics::histogram; odd: one bin lies around 0

}  // namespace sansmesh::inline v1
