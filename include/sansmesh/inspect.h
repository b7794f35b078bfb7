// Jobs that inspect surfaces: alignment, comparison, assessment, measures, cross-sections.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/cloud_options.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/solid_measures.h"
#include "sansmesh/surface_function.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

class Isosurface;
class SignedDistance;

/// A named surface of any kind: a mesh, points, a function or an isosurface. Cheap to copy: copies share immutable
/// data.
class SANSMESH_API AnySurface {
 public:
  /// Representation of the surface.
  enum class Kind : std::uint8_t { mesh, points, function, isosurface };

  /// `name` appears in messages: its file. A mesh without triangles is treated as points.
  AnySurface(TriangleMesh mesh, std::string name);
  /// Zero set of a function.
  AnySurface(SurfaceFunction function, std::string name);
  /// Level set of a volume; not null.
  AnySurface(std::shared_ptr<const Isosurface> isosurface, std::string name);

  /// Name as given.
  const std::string& name() const { return name_; }
  /// Representation of the surface.
  Kind kind() const { return kind_; }
  /// "mesh", "points", "function" or "isosurface".
  const char* kind_word() const;
  /// The function or isosurface in the input's coordinates; null for meshes and points. Valid as long as this surface
  /// or a copy of it.
  const ScalarField* field() const { return field_.get(); }
  /// The mesh or the points. For a function or isosurface, a mesh that is made at every call, with its notes added to
  /// `notes`. Throws DataError that begins with the name.
  std::shared_ptr<const TriangleMesh> mesh(Progress& progress, std::vector<Note>& notes) const;
  /// Reference system of the coordinates; null if unknown.
  const ReferenceSystem* reference() const;
  /// Bounding box of the mesh, the points or the samples of a function (the function's own box if it has none).
  Box3 bounds() const;
  /// Signed distances, from the function itself, the mesh or the points. An isosurface is measured by its mesh, since
  /// values of a volume are no distances and are extrapolated beyond its boundary. Throws DataError that begins with
  /// the name.
  std::shared_ptr<const SignedDistance> distance(Progress& progress, std::vector<Note>& notes) const;

 private:
  std::string name_;
  Kind kind_;
  std::shared_ptr<const TriangleMesh> mesh_;
  std::optional<SurfaceFunction> function_;
  std::shared_ptr<const Isosurface> isosurface_;
  std::shared_ptr<const ScalarField> field_;  ///< owns what it needs
};

/// A surface moved onto another.
struct SANSMESH_API AlignResult {
  TriangleMesh moved;  ///< moved surface with all attributes; points have no triangles
  /// Target of the motion: the mesh or the points; for functions and isosurfaces, their mesh.
  std::shared_ptr<const TriangleMesh> fixed;
  AffineMap motion;         ///< total motion, `before` included
  SurfaceAlignment report;  ///< quality of the fit; its motion is applied after `before`
  /// "not_unique": other poses fit equally well; "free_motions": the surfaces can slide on each other;
  /// "little_overlap"; "mirrored": the mirror image fits instead; "other_shape": the surfaces differ by more than
  /// noise; further ones on a mesh that was made.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< report rows
};

/// Finds the motion that brings `moving` onto `fixed` (docs/methods/alignment.md) and applies it after `before`. Throws
/// ArgumentError for bad options, DataError that begins with the name of a surface that cannot be aligned or fits
/// nowhere; Cancelled.
SANSMESH_API AlignResult align(const AnySurface& moving, const AnySurface& fixed,
                               const SurfaceAlignmentOptions& options, Progress& progress,
                               const AffineMap& before = {});

/// One of the two surfaces of a comparison.
enum class MapSide : std::uint8_t { part, reference };
/// Names in the order of the enumerators.
inline constexpr std::string_view kSideWords[] = {"part", "reference"};

/// Options of a comparison of two surfaces.
struct SANSMESH_API CompareOptions {
  DistanceMapOptions map = {};  ///< `reversed` follows from `on`
  /// Surface that carries the map; distances keep the sign seen from the part.
  MapSide on = MapSide::part;
  /// First halves edges of the mapped mesh until none is longer (length, > 0).
  std::optional<double> refine = {};
  /// First aligns the part with the reference.
  bool align = false;
  SurfaceAlignmentOptions alignment = {};  ///< options of `align`

  static const OptionSchema& schema();  ///< option rows, one per field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Sampling of points that take part in a comparison (lengths), and the part of the distances that it causes.
struct SANSMESH_API ComparedPoints {
  double spacing = 0;   ///< edge of the square that one point represents
  NoiseEstimate noise;  ///< noise of the points
  /// RMS of the distances if the points sample exactly the other surface. Of mapped points the noise. Of points to
  /// which distances are measured: that of the nearest point's disc; without normals, of the nearest point.
  double own_rms = 0;

  static const ReportSchema& schema();  ///< report rows
};

/// Report of compare().
struct SANSMESH_API CompareReport {
  MapSide on = MapSide::part;                      ///< side that carries the map
  std::optional<double> within;                    ///< as requested (length)
  double diagonal = 0;                             ///< diagonal of the reference's bounding box (length)
  std::optional<ComparedPoints> part_points;       ///< sampling of a part of points
  std::optional<ComparedPoints> reference_points;  ///< sampling of a reference of points
  std::optional<SurfaceAlignment> alignment;       ///< alignment of the part, if requested
  AffineMap motion;                                ///< motion of the part, if aligned

  static const ReportSchema& schema();  ///< report rows
};

/// Map of the distances between two surfaces.
struct SANSMESH_API CompareResult {
  TriangleMesh mesh;     ///< mesh of the part or the reference, with distances as attribute and colours
  DistanceMap map;       ///< distances at its vertices
  CompareReport report;  ///< sides and alignment
  /// Those of align; "edges_stay_long": refinement would take too many triangles; "coarse": only corners of large
  /// triangles are compared; "no_sign": the other side is points without normals.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< report rows
};

/// Compares a part with a reference: statistics and colours of signed distances, positive outside the reference. Throws
/// ArgumentError for bad options, and if a function would have to move; DataError that begins with a name; Cancelled.
SANSMESH_API CompareResult compare(const AnySurface& part, const AnySurface& reference, const CompareOptions& options,
                                   Progress& progress);

/// Options of an assessment of a mesh against a reference.
struct SANSMESH_API AssessOptions {
  /// Samples on each mesh, 1..2·10⁹. Default: 300000; 5000 if the sizes of the surfaces differ by a factor above 100,
  /// since each sample then costs as much as all triangles.
  std::optional<std::size_t> samples = {};

  static const OptionSchema& schema();  ///< option rows, one per field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Measures of a mesh alone and against a reference.
struct SANSMESH_API AssessReport {
  std::size_t vertices = 0;                 ///< vertices or points
  std::optional<MeshTopology> topology;     ///< topology of a mesh, sewn along coincident borders
  std::optional<MeshQuality> quality;       ///< quality of a mesh
  std::optional<SurfaceDistance> distance;  ///< with a reference: distances between both
  std::optional<MeshCoverage> coverage;     ///< with a reference that is a cloud or a meshed scan

  static const ReportSchema& schema();  ///< report rows
};

/// Assessment of a mesh.
struct AssessResult {
  AssessReport report;  ///< all measures
  /// "other_unit": the sizes of mesh and reference suggest different units.
  std::vector<Note> notes;
};

/// Measures a mesh, or points without triangles, alone. Throws Cancelled.
SANSMESH_API AssessResult assess(const TriangleMesh& mesh, Progress& progress);

/// Also measures distances to the reference and back. Throws ArgumentError for bad options, DataError if a side has no
/// finite points.
SANSMESH_API AssessResult assess(const TriangleMesh& mesh, PointSet reference, const AssessOptions& options,
                                 Progress& progress);

/// Measures of a solid.
struct MeasureResult {
  SolidMeasures measures;  ///< measures of the whole and of its components
  /// "open": no volume; "encloses_nothing": its sides cancel out; "faces_inward": the volume is negative; "cavities";
  /// "inside_out": parts that face inward but bound no cavity; "nested", "crossing_components", "crosses_itself":
  /// volume that counts more than once; "nonmanifold": edges with more than two triangles; "bad_corners": triangles
  /// were dropped; further ones on the mesh that was made.
  std::vector<Note> notes;
};

/// Area, volume, moments and defects of a surface; functions and isosurfaces are measured by their mesh. Throws
/// DataError for points, and if no triangle has an area; Cancelled.
SANSMESH_API MeasureResult measure(const AnySurface& surface, Progress& progress);

/// Axis perpendicular to a series of planes.
enum class SectionAxis : std::uint8_t { x, y, z };

/// Planes of cross-sections: single planes, a series perpendicular to an axis, or both. Default: three planes through
/// the middle of the box.
struct SANSMESH_API SectionOptions {
  std::vector<CutPlane> planes = {};     ///< single planes
  std::optional<SectionAxis> axis = {};  ///< axis of the series; default: no series
  std::optional<double> first = {};      ///< position of the first plane of the series (length)
  /// Distance between successive planes (length, not 0; negative: downwards). Default: spread over the box, or from
  /// `first` to its upper end.
  std::optional<double> interval = {};
  std::optional<int> count = {};  ///< 1..100000; default: 1, or as many intervals as fit into the box
  /// For functions and isosurfaces: lattice squares along the longer side of the box, 2..4096.
  std::optional<int> resolution = {};

  static const OptionSchema& schema();  ///< option rows, one per field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Report of section().
struct SectionReport {
  std::size_t curves = 0;       ///< curves of all planes
  std::size_t open_curves = 0;  ///< curves that are not closed: the surface has borders there
};

/// Cross-sections of a surface.
struct SANSMESH_API SectionResult {
  std::vector<Section> sections;  ///< one per plane: single planes, then the series
  SectionReport report;           ///< counts of curves
  /// "open_curves": the surface has borders there.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< report rows
};

/// Cuts a surface with planes. Sections of a function are computed from the function itself, without a mesh. Throws
/// ArgumentError for bad options, and for a resolution of meshes, which are cut exactly; DataError for points and
/// without finite vertices; Cancelled.
SANSMESH_API SectionResult section(const AnySurface& surface, const SectionOptions& options, Progress& progress);

/// Motion and quality of the fit, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const SurfaceAlignment& alignment);
/// Motion, statistics and exclusions, as lines of text. `other`: the name of the other side.
SANSMESH_API std::vector<std::string> summary_of(const CompareResult& compared, const CompareOptions& options,
                                                 const std::string& other);
/// Histogram of distances as bars, one line each.
SANSMESH_API std::vector<std::string> histogram_of(const DistanceMap& map);
/// Measures as lines of text, up to twenty parts.
SANSMESH_API std::vector<std::string> summary_of(const SolidMeasures& measures);
/// Quality of a mesh, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const AssessReport& report);

}  // namespace sansmesh::inline v1
