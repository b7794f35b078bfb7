// Jobs that judge surfaces: alignment, comparison, assessment, measures, cross-sections.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/affine_map.h"
#include "sansmesh/api.h"
#include "sansmesh/box.h"
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

/// Cheap to copy: what it holds is shared and never changes.
class SANSMESH_API AnySurface {
 public:
  enum class Kind : std::uint8_t { mesh, points, function, isosurface };

  /// `name` stands in messages: its file. A mesh without triangles is points.
  AnySurface(TriangleMesh mesh, std::string name);
  AnySurface(SurfaceFunction function, std::string name);
  AnySurface(std::shared_ptr<const Isosurface> isosurface, std::string name);

  const std::string& name() const { return name_; }
  Kind kind() const { return kind_; }
  /// "mesh", "points", "function" or "isosurface".
  const char* kind_word() const;
  /// The function or isosurface in the input's coordinates; null for meshes and points.
  const ScalarField* field() const { return field_.get(); }
  /// The mesh or the points; of a function or isosurface its mesh, which is made at every call and whose warnings are
  /// added to `notes` with the code "mesh". Throws DataError that begins with the name.
  std::shared_ptr<const TriangleMesh> mesh(Progress& progress, std::vector<Note>& notes) const;
  /// Around mesh, points or the samples of a function (its own box if it has none).
  Box3 bounds() const;
  /// Of the function itself; else of the mesh or the points. An isosurface is measured by its mesh: values of a volume
  /// are no distances, and go on beyond its boundary. Throws DataError that begins with the name.
  std::shared_ptr<const SignedDistance> distance(Progress& progress, std::vector<Note>& notes) const;

 private:
  std::string name_;
  Kind kind_;
  std::shared_ptr<const TriangleMesh> mesh_;
  std::optional<SurfaceFunction> function_;
  std::shared_ptr<const Isosurface> isosurface_;
  std::shared_ptr<const ScalarField> field_;  ///< with all that it needs
};

struct SANSMESH_API AlignResult {
  TriangleMesh moved;  ///< with all that belongs to it; points have no triangles
  /// What it was moved onto: the mesh or the points, of functions and isosurfaces the mesh that was made.
  std::shared_ptr<const TriangleMesh> fixed;
  AffineMap motion;  ///< all of it, `before` included
  SurfaceAlignment report;
  /// "not_unique": other poses fit as well; "free_motions": the surfaces slide on each other; "little_overlap";
  /// "mirrored": the mirror image fits instead; "other_shape": they differ by more than noise; "mesh": what there is to
  /// say of a mesh that was made.
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// Finds the motion (align_surfaces) and applies it, after `before`. Throws ArgumentError for bad options, DataError
/// that begins with the name of a surface where it cannot be aligned, or fits nowhere; Cancelled.
SANSMESH_API AlignResult align(const AnySurface& moving, const AnySurface& fixed,
                               const SurfaceAlignmentOptions& options, Progress& progress,
                               const AffineMap& before = {});

enum class MapSide : std::uint8_t { part, reference };
/// In the order of the enumerators.
inline constexpr std::string_view kSideWords[] = {"part", "reference"};

struct SANSMESH_API CompareOptions {
  DistanceMapOptions map = {};  ///< its `reversed` follows from `on`
  /// On which of them the map lies; the sign of distances stays the part's.
  MapSide on = MapSide::part;
  /// First halve edges of the mapped mesh until none is longer (length, > 0).
  std::optional<double> refine = {};
  /// First move the part onto the reference.
  bool align = false;
  SurfaceAlignmentOptions alignment = {};

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct SANSMESH_API CompareReport {
  MapSide on = MapSide::part;       ///< as used
  std::optional<double> tolerance;  ///< as asked for (length)
  double diagonal = 0;              ///< of the reference
  std::optional<SurfaceAlignment> alignment;
  AffineMap motion;  ///< of the part, if it was aligned

  static const ReportSchema& schema();
};

struct SANSMESH_API CompareResult {
  TriangleMesh mesh;  ///< of the part or the reference, with distances and their colours (apply_map)
  DistanceMap map;    ///< of its vertices
  CompareReport report;
  /// Those of align; "edges_stay_long": refining would take too many triangles; "coarse": only corners of large
  /// triangles are compared; "no_sign": the other side is points without normals.
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// Statistics and colours of signed distances, positive outside of the reference. Throws ArgumentError for bad options,
/// and where a function is to be moved; DataError that begins with a name; Cancelled.
SANSMESH_API CompareResult compare(const AnySurface& part, const AnySurface& reference, const CompareOptions& options,
                                   Progress& progress);

struct SANSMESH_API AssessOptions {
  /// On each mesh, 1..2·10⁹. Default: 300000; 5000 of surfaces that differ in size by more than a hundred, where each
  /// costs as much as all triangles.
  std::optional<std::size_t> samples = {};

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct SANSMESH_API AssessReport {
  std::size_t vertices = 0;              ///< or points
  std::optional<MeshTopology> topology;  ///< of a mesh, sewn where its borders lie on each other
  std::optional<MeshQuality> quality;    ///< of a mesh
  // With a reference.
  std::optional<SurfaceDistance> distance;
  std::optional<MeshCoverage> coverage;  ///< of a mesh whose reference is a cloud or a meshed scan

  static const ReportSchema& schema();
};

struct AssessResult {
  AssessReport report;
  /// "other_unit": mesh and reference differ in size as if they were not in the same unit.
  std::vector<Note> notes;
};

/// Of a mesh, or of points without triangles, by itself. Throws Cancelled.
SANSMESH_API AssessResult assess(const TriangleMesh& mesh, Progress& progress);

/// The same, and how far it is from the reference and back. Throws ArgumentError for bad options, DataError if a side
/// has no finite points.
SANSMESH_API AssessResult assess(const TriangleMesh& mesh, PointSet reference, const AssessOptions& options,
                                 Progress& progress);

struct MeasureResult {
  SolidMeasures measures;
  /// "open": no volume; "encloses_nothing": its sides cancel out; "faces_inward": the volume is negative; "cavities";
  /// "inside_out": parts that face inward, but bound no cavity; "nested", "crossing_components", "crosses_itself":
  /// volume that counts more than once; "nonmanifold": edges of more than two triangles; "bad_corners": triangles that
  /// were left out; "mesh": what there is to say of the mesh that was made.
  std::vector<Note> notes;
};

/// Of a function or isosurface its mesh is measured. Throws DataError of points, and if no triangle has an area;
/// Cancelled.
SANSMESH_API MeasureResult measure(const AnySurface& surface, Progress& progress);

enum class SectionAxis : std::uint8_t { x, y, z };

/// Single planes, a series of them across an axis, or both; without either three planes through the middle of the box.
struct SANSMESH_API SectionOptions {
  std::vector<CutPlane> planes = {};
  std::optional<SectionAxis> axis = {};
  std::optional<double> first = {};     ///< position of the first of the series (length)
  std::optional<double> interval = {};  ///< from one to the next (length, not 0); default: spread over the box
  std::optional<int> count = {};        ///< 1..100000; default: 1, or as many as steps fit into the box
  /// Of functions and isosurfaces: lattice squares along the longer side of the box, 2..4096.
  std::optional<int> resolution = {};

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct SectionReport {
  std::size_t curves = 0, open_curves = 0;
};

struct SANSMESH_API SectionResult {
  std::vector<Section> sections;  ///< a plane each: single ones, then the series
  SectionReport report;
  /// "open_curves": the surface has borders there.
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// Of a function the curves of the function itself, without a mesh. Throws ArgumentError for bad options, and for a
/// resolution of meshes, which are cut exactly; DataError of points, and without finite vertices; Cancelled.
SANSMESH_API SectionResult section(const AnySurface& surface, const SectionOptions& options, Progress& progress);

/// Each in lines for people: the motion and how it fits; how a part was moved, statistics and what was left out
/// (`other` is the name of what it was compared with); the distribution of distances as bars; measures, without the
/// parts beyond the twentieth; how good a mesh is.
SANSMESH_API std::vector<std::string> summary_of(const SurfaceAlignment& alignment);
SANSMESH_API std::vector<std::string> summary_of(const CompareResult& compared, const CompareOptions& options,
                                                 const std::string& other);
SANSMESH_API std::vector<std::string> histogram_of(const DistanceMap& map);
SANSMESH_API std::vector<std::string> summary_of(const SolidMeasures& measures);
SANSMESH_API std::vector<std::string> summary_of(const AssessReport& report);

}  // namespace sansmesh::inline v1
