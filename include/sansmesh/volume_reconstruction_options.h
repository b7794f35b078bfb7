// Options and report of a volume reconstruction, and traits of the values of a volume.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/option.h"

namespace sansmesh::inline v1 {

/// Meaning of values in cells.
enum class CellValues : std::uint8_t {
  means,   ///< means over the cells, as of finite volumes and refinement levels
  centres  ///< values at the centres of the cells
};

/// Options of the reconstruction of a field from the samples of a volume. Absent options are chosen from the data;
/// without a method only `smoothing`, `cell_values` and `logarithm` may be set.
struct SANSMESH_API VolumeReconstructionOptions {
  std::optional<std::string> method = {};  ///< "mls-detail", "linear", …: see `sansmesh schema`
  /// Highest degree of polynomials: mls, mls-detail: 0..4; lagrange: 1..5; amls: 0..2, with 0 for values alone.
  std::optional<int> degree = {};
  std::optional<int> iterations = {};  ///< amls: number of iterations that add residuals, 0..100
  std::optional<double> epsilon = {};  ///< amls: shape parameter ε, 0.05..10; smaller is smoother
  std::optional<int> order = {};       ///< amls: 2, 4 or 6
  std::optional<double> radius = {};   ///< support radius in spacings, 1..10, for methods with supports
  /// amls: spherical supports with the radius of the farthest neighbour instead of ellipsoids, for comparison. Not for
  /// lattices (uniform and rectilinear grids): their supports follow the steps.
  std::optional<bool> spherical = {};
  std::optional<bool> robust = {};  ///< mls-detail: robust weights that keep steps between materials sharp
  /// mls, mls-detail: whether the field passes through the (smoothed) samples. Otherwise it is the polynomial as
  /// printed in the thesis, without its residuals and without linear interpolation where it is doubtful.
  std::optional<bool> interpolate = {};
  double b = 0, c = 0.5;  ///< cubic: B and C, 0..1 each; the default is Catmull–Rom
  /// All methods: factor of the estimated noise by which the samples are smoothed first; 0: samples are used as they
  /// are. Default: 1 if noise is found.
  std::optional<double> smoothing = {};
  /// Values in cells: the default is means; others than mls-detail always take centres.
  std::optional<CellValues> cell_values = {};
  /// Reconstruction of the logarithm, for positive values that span decades, of one component. No result is negative.
  std::optional<bool> logarithm = {};

  /// Schema of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Choices and remarks of a reconstruction.
struct VolumeReconstructionReport {
  VolumeReconstructionOptions options;  ///< options with all choices made from the data, including the method
  std::string why;                     ///< reason for an automatic choice of the method: a sentence without a full stop
  std::vector<std::string> notes;      ///< "12 samples have no value: they were filled in from their neighbours", …
  std::vector<std::size_t> by_degree;  ///< number of polynomials of each degree, if the method has polynomials
  double noise = 0;        ///< deviation of the noise found (unit of the array; largest component); 0 without noise
  std::string noise_kind;  ///< "white", "correlated" or "Rician"; empty without noise
  std::size_t bytes = 0;   ///< approximate memory of the field with its samples and cells
};

/// Estimated from some thousand samples: polynomials of degree 0 to 3 predict each from its neighbours. All values are
/// relative to the range of the array (of vectors: the largest range of a component).
struct VolumeTraits {
  std::size_t samples = 0;  ///< number of samples examined
  double range = 0;         ///< largest minus smallest value (unit of the array)
  /// Median leave-one-out error for each degree. It falls with the degree where the samples resolve the data, and stays
  /// constant for noise and for structure below the spacing.
  std::array<double, 4> left_out{};
  /// Root mean square of the same errors, dominated by the few samples next to edges.
  std::array<double, 4> left_out_rms{};
  double noise = 0;    ///< standard deviation of the part that no degree predicts: an upper bound of the noise
  std::string kind;    ///< kind of this noise: "white", "correlated" or "Rician"; empty without noise
  bool noisy = false;  ///< this part is noise: the residuals of neighbours do not resemble each other
  /// Share of samples next to steps: with an error above ten times the median and above a twentieth of the range.
  double steps = 0;

  /// Parabolas predict samples better than planes, so higher degrees improve on linear interpolation.
  bool resolved() const { return left_out[2] < 0.8 * left_out[1] || left_out[1] < 1e-6; }
  /// The same at the samples with the largest errors, which are those at edges.
  bool edges_resolved() const { return left_out_rms[2] < 0.5 * left_out_rms[1] || left_out_rms[1] < 1e-6; }
};

/// An automatic choice of the method.
struct VolumeReconstructionChoice {
  std::string method = "mls-detail";  ///< method name
  std::string why;                    ///< reason, without a full stop
};

/// Grid entities that the rows of an array belong to.
enum class Association : std::uint8_t { points, cells };

}  // namespace sansmesh::inline v1
