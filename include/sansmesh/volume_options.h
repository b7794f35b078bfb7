// Names of arrays of volumes, and options of surfaces and grids made from volumes.
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
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/report.h"
#include "sansmesh/volume_reconstruction_options.h"

namespace sansmesh::inline v1 {

/// An array of a volume. A point array and a cell array may have the same name.
struct DatasetArray {
  std::string name;                      ///< name in the file
  Association of = Association::points;  ///< points or cells
  NumberType type = NumberType::f32;     ///< type of the numbers
  std::size_t components = 1;            ///< numbers per row
  std::vector<double> least, most;       ///< range of each component over finite, visible values; NaN if there are none
  std::size_t not_finite = 0;            ///< number of values that are not finite
};

/// Selection in an array: "NAME", "NAME:1", "NAME:y" or "NAME:magnitude".
struct ArrayChoice {
  std::string array;                     ///< array name
  std::optional<std::size_t> component;  ///< one component; all if absent
  bool magnitude = false;                ///< magnitude of the vector

  bool operator==(const ArrayChoice&) const = default;  ///< equality of all members
};

/// An isosurface of a file, written "data.vtu[Temp=300]" or "data.vtu[V:magnitude=2]".
struct IsosurfaceName {
  std::string file;   ///< file name without the brackets
  std::string array;  ///< array name with its component
  double value = 0;   ///< iso-value
};

/// Returns nothing unless the text ends in brackets that contain an equals sign. Throws ArgumentError if the value is
/// not a number or a part is missing.
SANSMESH_API std::optional<IsosurfaceName> parse_isosurface_name(const std::string& text);

/// A field resampled on a uniform lattice, for programs that read only these.
struct SANSMESH_API ResampleOptions {
  /// Points along the longest side of the box, 2..4096 (the other sides follow from equal steps), or points along x, y
  /// and z, 1..65536 each.
  std::vector<std::size_t> size = {128};
  std::optional<Box3> box = {};  ///< default: the box of the volume
  bool gradients = false;        ///< adds an array NAME_gradient with three numbers per component
  double outside = 0;            ///< value outside the volume; may be NaN

  /// Schema of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Interpolation between the time steps of a volume.
enum class TimeInterpolation : std::uint8_t {
  constant,  ///< value of the previous step (tejada2008, 5.3)
  linear,    ///< between the two adjacent steps
  cubic      ///< through two steps before and two after; smooth in time
};

/// Options of an isosurface mesh.
struct SANSMESH_API IsosurfaceOptions {
  /// Edge of the smallest blocks (length). Default: the local spacing of the samples.
  std::optional<double> cell = {};
  std::optional<double> mesh_error = {};                         ///< as in MeshOptions
  std::optional<std::size_t> triangles = {};                     ///< as in MeshOptions
  ComponentChoice components = {ComponentChoice::Kind::all, 1};  ///< components to keep
  bool closed = false;  ///< meshes the boundary of {f > value}: the volume's boundary closes the surface
  bool enhance = true;  ///< as in MeshOptions

  /// Schema of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Figures of an isosurface mesh.
struct SANSMESH_API IsosurfaceReport {
  std::size_t blocks = 0;        ///< number of blocks polygonised
  double cell = 0;               ///< edge of the smallest blocks (length)
  double mesh_error = 0;         ///< target distance between mesh and surface (length)
  std::size_t components = 0;    ///< number of connected components
  bool closed = false;           ///< no edge is open
  double area = 0;               ///< length²
  std::optional<double> volume;  ///< enclosed volume, if closed
  std::vector<Note> notes;       ///< requests that could not be met

  static const ReportSchema& schema();  ///< one row per figure
};

/// Surfaces of volumes without a mesh: moving least squares on samples, weighted by how close their value is to the
/// iso-value or by the norm of their gradient (tejada2008, 5.2).
struct SANSMESH_API VolumeSurfaceOptions {
  /// Weight function that selects the layer of samples.
  enum class Kind {
    isovalue,      ///< ω₁ = exp(−((v − f_i)/β₁)²): around an iso-value
    high_gradient  ///< ω₂ = exp(−((‖∇f_i‖/‖∇f‖_max − 1)/β₂)²): around the largest gradients, at borders of materials
  } kind = Kind::isovalue;  ///< kind of surface
  double value = 0;         ///< v (unit of the array; isovalue only)
  /// β₁ (unit of the array, > 0) or β₂ (0.01..1). Default of β₁: the change of the quantity over one spacing around
  /// each sample, so that the layer has the same thickness everywhere. Default of β₂: 0.35.
  std::optional<double> beta = {};
  /// h of the corrector's weights, and half the radius of the predictor's, in spacings, 0.5..20. Default: 2, more with
  /// noise.
  std::optional<double> smoothing = {};
  /// high_gradient: ‖∇f‖_max is the largest gradient across the border near the sample, so that faint borders count as
  /// much as strong ones. Otherwise it is the largest of the volume as in the source, without the top thousandth of the
  /// samples.
  bool local_maximum = true;
  /// high_gradient: smallest ‖∇f‖ of a border (unit of the array per length). Default: above the noise, and at least a
  /// seventh of the largest.
  std::optional<double> least_gradient = {};
  // One application is a predictor step and a corrector step; at least one of them is enabled.
  bool predictor = true;        ///< finds the layer of samples from a distance
  bool corrector = true;        ///< finds the surface
  bool alternating = false;     ///< predictor: optimises direction and offset in turn, as in the source
  bool line_search = false;     ///< predictor: line search along the direction, as in the source
  bool separate_sheets = true;  ///< ignores samples that face away from their neighbours
  /// The field evaluates the projection at each query point instead of the paraboloids at the feet of the samples: the
  /// exact definition, at two (meshes) to ten (pictures) times the cost.
  bool exact_projection = false;

  /// Schema of these options, without `value`.
  static const OptionSchema& schema();
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Figures of a volume surface.
struct SANSMESH_API VolumeSurfaceReport {
  std::size_t samples = 0;     ///< number of samples with a weight
  double spacing = 0;          ///< median spacing of these samples (length)
  double smoothing = 0;        ///< h over the spacing
  double slope = 0;            ///< median gradient norm at the surface (unit of the array per length)
  double noise = 0;            ///< noise of the values (unit of the array)
  double smoothed = 0;         ///< share of smoothed samples in the values, 0..1: 0 are the file's
  double noise_distance = 0;   ///< displacement of an isosurface by this noise (length)
  double least_gradient = 0;   ///< high_gradient: threshold used
  std::optional<double> beta;  ///< β if it is the same everywhere

  static const ReportSchema& schema();  ///< one row per figure
};

}  // namespace sansmesh::inline v1
