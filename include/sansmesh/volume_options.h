// Arrays of volumes by name, and options of what is made of volumes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/attribute_table.h"
#include "sansmesh/box.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/option.h"
#include "sansmesh/reconstruction_options.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

/// An array of a volume. One name may stand for two: one of points and one of cells.
struct DatasetArray {
  std::string name;                      ///< as the file has it
  Association of = Association::points;  ///< points or cells
  NumberType type = NumberType::f32;     ///< of its numbers
  std::size_t components = 1;            ///< numbers a row
  std::vector<double> least, most;       ///< of each component, over what is finite and not hidden; NaN: nothing is
  std::size_t not_finite = 0;            ///< numbers
};

/// What of an array is meant by "NAME", "NAME:1", "NAME:y" or "NAME:magnitude".
struct ArrayChoice {
  std::string array;                     ///< its name
  std::optional<std::size_t> component;  ///< one of several; else all
  bool magnitude = false;                ///< of the vector

  bool operator==(const ArrayChoice&) const = default;  ///< the same choice
};

/// A surface in a volume, as it is named where a file is asked for: "data.vtu[Temp=300]", "data.vtu[V:magnitude=2]".
struct IsosurfaceName {
  std::string file;   ///< without the brackets
  std::string array;  ///< with its component
  double value = 0;   ///< on the surface
};

/// Nothing where the text does not end in brackets with an equals sign between them; throws ArgumentError where the
/// value is no number or something is missing.
SANSMESH_API std::optional<IsosurfaceName> parse_isosurface_name(const std::string& text);

/// A field on a uniform lattice: what programs that know nothing else can use.
struct SANSMESH_API ResampleOptions {
  /// Points along the longest side of the box, 2..4096; those of the others follow, so that steps are equal. Or points
  /// along x, y and z, 1..65536 each.
  std::vector<std::size_t> size = {128};
  std::optional<Box3> box = {};  ///< default: that of the volume
  bool gradients = false;        ///< also an array NAME_gradient of three numbers a component
  double outside = 0;            ///< value where the volume is not; may be NaN

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Values between the steps of a volume that changes.
enum class TimeInterpolation : std::uint8_t {
  constant,  ///< that of the step before, as in the source (METHODS §5.2)
  linear,    ///< between the two steps around
  cubic      ///< through the two before and the two after: smooth in time
};

/// A mesh of the surface on which a quantity has a value.
struct SANSMESH_API IsosurfaceOptions {
  /// Edge of the smallest blocks (length). Default: the local spacing of the samples.
  std::optional<double> cell = {};
  std::optional<double> mesh_error = {};                         ///< as in MeshOptions
  std::optional<std::size_t> triangles = {};                     ///< as in MeshOptions
  ComponentChoice components = {ComponentChoice::Kind::all, 1};  ///< parts to keep
  bool closed = false;  ///< the boundary of {f > value}: closed by faces of the volume's boundary
  bool enhance = true;  ///< as in MeshOptions

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What became of the mesh.
struct SANSMESH_API IsosurfaceReport {
  std::size_t blocks = 0;             ///< that it was cut out of
  double cell = 0;                    ///< edge of the smallest blocks (length)
  double mesh_error = 0;              ///< distance between mesh and surface aimed at (length)
  std::size_t components = 0;         ///< parts that are not connected
  bool closed = false;                ///< no edge is open
  double area = 0;                    ///< length²
  std::optional<double> volume;       ///< enclosed, where closed
  std::vector<std::string> warnings;  ///< a line each

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Surfaces of volumes without a mesh: moving least squares on samples that weigh in by how near their value is to that
/// of an isosurface, or how steep the volume is there (METHODS §5.1).
struct SANSMESH_API VolumeSurfaceOptions {
  /// The layer of samples that counts.
  enum class Kind {
    isovalue,  ///< ω₁ = exp(−((v − f_i)/β₁)²): where the quantity has a value
    high_gradient  ///< ω₂ = exp(−((‖∇f_i‖/‖∇f‖_max − 1)/β₂)²): where it changes most, borders of materials
  } kind = Kind::isovalue;  ///< which surface
  double value = 0;         ///< v (unit of the array; isovalue only)
  /// β₁ (unit of the array, > 0) or β₂ (share, 0.01..1). Default of β₁: what the quantity changes by over a spacing
  /// around each sample, so that the layer of samples that count is equally thick at steep and at flat places; of β₂:
  /// 0.35.
  std::optional<double> beta = {};
  /// h of the corrector's weights, and half the radius of the predictor's, in spacings, 0.5..20. Default: 2, more with
  /// noise.
  std::optional<double> smoothing = {};
  /// high_gradient: ‖∇f‖_max is the largest across the border around the sample, so that faint borders count like
  /// strong ones; else the largest of the volume as in the source, a thousandth of the samples left out.
  bool local_maximum = true;
  /// high_gradient: least ‖∇f‖ of a border (unit of the array per length). Default: what stands out from noise, a
  /// seventh of the largest at least.
  std::optional<double> least_gradient = {};
  // One application is a step of the predictor and one of the corrector; one of them runs at least.
  bool predictor = true;        ///< finds the layer of samples from farther away
  bool corrector = true;        ///< finds the surface
  bool alternating = false;     ///< predictor: direction and offset in turns, as in the source
  bool line_search = false;     ///< predictor: along the direction, as in the source
  bool separate_sheets = true;  ///< samples that face away from those nearby are ignored
  /// The field of the surface asks the projection itself at every place, not the paraboloids at the feet of the
  /// samples: the definition to the letter, for two (meshes) to ten (pictures) times the time.
  bool exact_projection = false;

  /// The rows of these options, without `value`.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What was found on the way to such a surface.
struct SANSMESH_API VolumeSurfaceReport {
  std::size_t samples = 0;     ///< that count
  double spacing = 0;          ///< of those, on the median (length)
  double smoothing = 0;        ///< h over the spacing
  double slope = 0;            ///< of the quantity at the surface, on the median (unit of the array per length)
  double noise = 0;            ///< of the values (unit of the array)
  double noise_distance = 0;   ///< what that moves an isosurface by (length)
  double least_gradient = 0;   ///< high_gradient
  std::optional<double> beta;  ///< where one holds everywhere

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

}  // namespace sansmesh::inline v1
