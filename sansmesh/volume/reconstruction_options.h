// What is asked of a reconstruction of a volume, and what it tells.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/option.h"

namespace sansmesh::inline v1 {

/// Absent options are chosen from the data. Without a method no other option may be set.
struct ReconstructionOptions {
  std::optional<std::string> method = {};  ///< a name of VolumeMethod::registry()
  std::optional<int> degree = {};          ///< mls, mls-detail: highest degree of polynomials, 0..4; lagrange: 1..5
  std::optional<int> iterations = {};      ///< amls: times that residuals are added, 0..100
  std::optional<double> epsilon = {};      ///< amls: ε, 0.05..10: small is smooth
  std::optional<int> order = {};           ///< amls: 2, 4 or 6
  std::optional<double> radius = {};       ///< mls, rbf, shepard: in spacings, 1..10
  /// amls: balls about the samples, as wide as their farthest neighbour is away, in place of ellipsoids; for
  /// comparison. Not for lattices (uniform and rectilinear grids), whose supports follow their steps.
  std::optional<bool> spherical = {};
  std::optional<bool> robust = {};  ///< mls-detail: weights that leave steps between materials sharp
  double b = 0, c = 0.5;            ///< cubic: B and C, 0..1 each; Catmull–Rom

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What was chosen, and what is worth knowing.
struct ReconstructionReport {
  ReconstructionOptions options;       ///< with what was chosen from the data, the method too
  std::string why;                     ///< the method was chosen: a sentence without its end (choose_reconstruction)
  std::vector<std::string> notes;      ///< "12 samples have no value: they were filled in from their neighbours", …
  std::vector<std::size_t> by_degree;  ///< polynomials of each degree that there are, where there are any
  double noise = 0;                    ///< of the values, where it was estimated (unit of the array)
  std::size_t bytes = 0;               ///< of memory that the field takes with its samples and cells, about
};

}  // namespace sansmesh::inline v1
