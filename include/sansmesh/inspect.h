// Jobs that judge surfaces: alignment, comparison, assessment, measures, cross-sections.
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

/// A surface of any kind, with its name: a mesh, points, a function or an isosurface. Cheap to copy: what it holds is
/// shared and never changes.
class SANSMESH_API AnySurface {
 public:
  /// What the surface is given by.
  enum class Kind : std::uint8_t { mesh, points, function, isosurface };

  /// `name` stands in messages: its file. A mesh without triangles is points.
  AnySurface(TriangleMesh mesh, std::string name);
  /// A function's zero set.
  AnySurface(SurfaceFunction function, std::string name);
  /// A level set of a volume; not null.
  AnySurface(std::shared_ptr<const Isosurface> isosurface, std::string name);

  /// As given.
  const std::string& name() const { return name_; }
  /// What it is given by.
  Kind kind() const { return kind_; }
  /// "mesh", "points", "function" or "isosurface".
  const char* kind_word() const;
  /// The function or isosurface in the input's coordinates; null for meshes and points. Valid as long as this
  /// surface or a copy of it.
  const ScalarField* field() const { return field_.get(); }
  /// The mesh or the points; of a function or isosurface its mesh, which is made at every call and whose warnings are
  /// added to `notes` with the code "mesh". Throws DataError that begins with the name.
  std::shared_ptr<const TriangleMesh> mesh(Progress& progress, std::vector<Note>& notes) const;
  /// Box around mesh, points or the samples of a function (its own box if it has none).
  Box3 bounds() const;
  /// Signed distances: of the function itself; else of the mesh or the points. An isosurface is measured by its mesh:
  /// values of a volume are no distances, and go on beyond its boundary. Throws DataError that begins with the name.
  std::shared_ptr<const SignedDistance> distance(Progress& progress, std::vector<Note>& notes) const;

 private:
  std::string name_;
  Kind kind_;
  std::shared_ptr<const TriangleMesh> mesh_;
  std::optional<SurfaceFunction> function_;
  std::shared_ptr<const Isosurface> isosurface_;
  std::shared_ptr<const ScalarField> field_;  ///< with all that it needs
};

/// A surface moved onto another.
struct SANSMESH_API AlignResult {
  TriangleMesh moved;  ///< with all that belongs to it; points have no triangles
  /// What it was moved onto: the mesh or the points, of functions and isosurfaces the mesh that was made.
  std::shared_ptr<const TriangleMesh> fixed;
  AffineMap motion;         ///< all of it, `before` included
  SurfaceAlignment report;  ///< how well it fits; its motion comes after `before`
  /// "not_unique": other poses fit as well; "free_motions": the surfaces slide on each other; "little_overlap";
  /// "mirrored": the mirror image fits instead; "other_shape": they differ by more than noise; "mesh": what there is to
  /// say of a mesh that was made.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Finds the motion that brings `moving` onto `fixed` (docs/methods/alignment.md) and applies it, after `before`.
/// Throws ArgumentError for bad options, DataError that begins with the name of a surface where it cannot be aligned,
/// or fits nowhere; Cancelled.
SANSMESH_API AlignResult align(const AnySurface& moving, const AnySurface& fixed,
                               const SurfaceAlignmentOptions& options, Progress& progress,
                               const AffineMap& before = {});

/// One of the two surfaces of a comparison.
enum class MapSide : std::uint8_t { part, reference };
/// In the order of the enumerators.
inline constexpr std::string_view kSideWords[] = {"part", "reference"};

/// How two surfaces are compared.
struct SANSMESH_API CompareOptions {
  DistanceMapOptions map = {};  ///< its `reversed` follows from `on`
  /// On which of them the map lies; the sign of distances stays the part's.
  MapSide on = MapSide::part;
  /// First halve edges of the mapped mesh until none is longer (length, > 0).
  std::optional<double> refine = {};
  /// First move the part onto the reference.
  bool align = false;
  SurfaceAlignmentOptions alignment = {};  ///< of `align`

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Numbers of a run of compare().
struct SANSMESH_API CompareReport {
  MapSide on = MapSide::part;                 ///< the side that is mapped
  std::optional<double> within;               ///< as asked for (length)
  double diagonal = 0;                        ///< of the box of the reference (length)
  std::optional<SurfaceAlignment> alignment;  ///< if the part was aligned
  AffineMap motion;                           ///< of the part, if it was aligned

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Map of the distances between two surfaces.
struct SANSMESH_API CompareResult {
  TriangleMesh mesh;     ///< of the part or the reference, with the attribute of distances and their colours
  DistanceMap map;       ///< of its vertices
  CompareReport report;  ///< what was compared, and the alignment
  /// Those of align; "edges_stay_long": refining would take too many triangles; "coarse": only corners of large
  /// triangles are compared; "no_sign": the other side is points without normals.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Compares a part with a reference: statistics and colours of signed distances, positive outside of the reference.
/// Throws ArgumentError for bad options, and where a function is to be moved; DataError that begins with a name;
/// Cancelled.
SANSMESH_API CompareResult compare(const AnySurface& part, const AnySurface& reference, const CompareOptions& options,
                                   Progress& progress);

/// How a mesh is assessed against a reference.
struct SANSMESH_API AssessOptions {
  /// Samples on each mesh, 1..2·10⁹. Default: 300000; 5000 of surfaces that differ in size by more than a hundred,
  /// where each costs as much as all triangles.
  std::optional<std::size_t> samples = {};

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Measures of a mesh by itself, and against a reference.
struct SANSMESH_API AssessReport {
  std::size_t vertices = 0;                 ///< or points
  std::optional<MeshTopology> topology;     ///< of a mesh, sewn where its borders lie on each other
  std::optional<MeshQuality> quality;       ///< of a mesh
  std::optional<SurfaceDistance> distance;  ///< with a reference: how far apart they are
  std::optional<MeshCoverage> coverage;     ///< with a reference: of a mesh whose reference is a cloud or a meshed scan

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Assessment of a mesh.
struct AssessResult {
  AssessReport report;  ///< all measures
  /// "other_unit": mesh and reference differ in size as if they were not in the same unit.
  std::vector<Note> notes;
};

/// Measures a mesh, or points without triangles, by itself. Throws Cancelled.
SANSMESH_API AssessResult assess(const TriangleMesh& mesh, Progress& progress);

/// The same, and how far it is from the reference and back. Throws ArgumentError for bad options, DataError if a side
/// has no finite points.
SANSMESH_API AssessResult assess(const TriangleMesh& mesh, PointSet reference, const AssessOptions& options,
                                 Progress& progress);

/// Measures of a solid.
struct MeasureResult {
  SolidMeasures measures;  ///< of the whole and of its components
  /// "open": no volume; "encloses_nothing": its sides cancel out; "faces_inward": the volume is negative; "cavities";
  /// "inside_out": parts that face inward, but bound no cavity; "nested", "crossing_components", "crosses_itself":
  /// volume that counts more than once; "nonmanifold": edges of more than two triangles; "bad_corners": triangles that
  /// were left out; "mesh": what there is to say of the mesh that was made.
  std::vector<Note> notes;
};

/// Area, volume, moments and flaws of a surface; of a function or isosurface its mesh is measured. Throws DataError of
/// points, and if no triangle has an area; Cancelled.
SANSMESH_API MeasureResult measure(const AnySurface& surface, Progress& progress);

/// Axis that a series of planes runs across.
enum class SectionAxis : std::uint8_t { x, y, z };

/// Planes of cross-sections: single planes, a series of them across an axis, or both; without either three planes
/// through the middle of the box.
struct SANSMESH_API SectionOptions {
  std::vector<CutPlane> planes = {};     ///< single ones
  std::optional<SectionAxis> axis = {};  ///< of the series; default: there is none
  std::optional<double> first = {};      ///< position of the first of the series (length)
  std::optional<double> interval = {};   ///< from one to the next (length, not 0); default: spread over the box
  std::optional<int> count = {};         ///< 1..100000; default: 1, or as many as steps fit into the box
  /// Of functions and isosurfaces: lattice squares along the longer side of the box, 2..4096.
  std::optional<int> resolution = {};

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Numbers of a run of section().
struct SectionReport {
  std::size_t curves = 0;       ///< of all planes
  std::size_t open_curves = 0;  ///< of these, not closed: the surface has borders there
};

/// Cross-sections of a surface.
struct SANSMESH_API SectionResult {
  std::vector<Section> sections;  ///< a plane each: single ones, then the series
  SectionReport report;           ///< counts of their curves
  /// "open_curves": the surface has borders there.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Cuts a surface with planes; of a function the curves of the function itself, without a mesh. Throws ArgumentError
/// for bad options, and for a resolution of meshes, which are cut exactly; DataError of points, and without finite
/// vertices; Cancelled.
SANSMESH_API SectionResult section(const AnySurface& surface, const SectionOptions& options, Progress& progress);

/// The motion and how it fits, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const SurfaceAlignment& alignment);
/// How a part was moved, statistics and what was left out, in lines for people. `other`: the name of what it was
/// compared with.
SANSMESH_API std::vector<std::string> summary_of(const CompareResult& compared, const CompareOptions& options,
                                                 const std::string& other);
/// The distribution of distances as bars, a line each.
SANSMESH_API std::vector<std::string> histogram_of(const DistanceMap& map);
/// Measures in lines for people, without the parts beyond the twentieth.
SANSMESH_API std::vector<std::string> summary_of(const SolidMeasures& measures);
/// How good a mesh is, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const AssessReport& report);

}  // namespace sansmesh::inline v1
