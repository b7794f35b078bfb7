// Reconstructions of volumes by name: the one table that library, command line, help and documentation read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/sampled_volume.h"
#include "sansmesh/field/volume_field.h"

namespace sansmesh {

enum class ReconstructionMethod : std::uint8_t {
  nearest,     ///< the value of the nearest sample
  linear,      ///< that of the grid itself: trilinear, barycentric, …
  shepard,     ///< inverse squared distances
  sibson,      ///< natural neighbours
  mean_value,  ///< mean value coordinates in the cell
  cubic,       ///< the BC family; uniform and rectilinear grids
  sinc,        ///< windowed; uniform grids
  lagrange,    ///< polynomials through samples in each direction; uniform, rectilinear and curvilinear grids
  rbf,         ///< radial basis functions of compact support
  bernstein,   ///< splines in Bernstein–Bézier form on tetrahedra
  mls,         ///< moving least squares about each point
  mls_detail,  ///< robust local polynomials of adaptive degree, blended
  amls         ///< approximate moving least squares: ellipsoidal, normalised, iterated
};

/// What is absent is chosen from the data.
struct ReconstructionOptions {
  ReconstructionMethod method = ReconstructionMethod::mls_detail;
  std::optional<int> degree;      ///< mls, mls_detail: highest degree of polynomials, 0..4; lagrange: 1..5
  std::optional<int> iterations;  ///< amls, mls_detail: times that residuals are added, 0..100
  std::optional<double> shape;    ///< amls: ε, 0.05..10: small is smooth
  std::optional<int> order;       ///< amls: 2, 4 or 6
  std::optional<double> radius;   ///< mls, rbf, shepard: in spacings, 1..10
  std::optional<bool> robust;     ///< mls_detail: weights that leave steps between materials sharp
  double b = 0, c = 0.5;          ///< cubic: B and C, 0..1 each; Catmull–Rom

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// An entry of the table.
struct ReconstructionInfo {
  ReconstructionMethod method;
  std::string_view name;                  ///< as users write it: "mls-detail"
  std::string_view summary;               ///< a line
  std::string_view grids;                 ///< on which grids: "all", "uniform and rectilinear"
  std::vector<std::string_view> options;  ///< fields of ReconstructionOptions that it heeds
};

/// In the order of the enumerators.
std::span<const ReconstructionInfo> reconstruction_methods();
const ReconstructionInfo& info_of(ReconstructionMethod method);
/// Throws ArgumentError naming all methods.
ReconstructionMethod reconstruction_of_name(std::string_view name);

/// What was chosen, and what is worth knowing.
struct ReconstructionReport {
  ReconstructionOptions options;       ///< with what was chosen from the data
  std::vector<std::string> notes;      ///< "12 samples have no value: they were filled in from their neighbours", …
  std::vector<std::size_t> by_degree;  ///< polynomials of each degree that there are, where there are any
  double noise = 0;                    ///< of the values, where it was estimated (unit of the array)
};

/// The field of one array (all its components). `volume` is shared. Throws ArgumentError for options out of range, that
/// the method does not heed, or a grid that it cannot be used on (naming those that can), DataError as volume_values.
std::unique_ptr<VolumeField> reconstruct_volume(std::shared_ptr<const SampledVolume> volume, const std::string& array,
                                                const ReconstructionOptions& options, Progress& progress,
                                                ReconstructionReport* report = nullptr);

}  // namespace sansmesh
