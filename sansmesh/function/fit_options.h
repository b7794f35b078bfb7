// Options of fitting a partition of unity to samples.
#pragma once

#include <optional>

#include "sansmesh/option.h"
#include "sansmesh/partition/paper_options.h"

namespace sansmesh::inline v1 {

/// Partition of unity that is fitted.
enum class FitMethod {
  partition,  ///< our own: docs/methods/partition-of-unity.md
  paper       ///< as the sources have it: docs/methods/paper-partition.md
};

/// Options of the fit of a function to samples. All optional lengths are in the unit of the input; where absent they
/// are derived from the data.
struct FitOptions {
  FitMethod fit = FitMethod::partition;
  /// Of FitMethod::paper: accepted rms distance of a support's samples over the diagonal of all [0.002], and the least
  /// coverage for degrees 2, 3 and 4 [0.4, 0.8, 0.85], each in 0..2.
  std::optional<double> threshold = {};
  std::optional<PaperCoverage> coverage = {};
  std::optional<int> depth = {};     ///< deepest level of the tree of fits, kLeastDepth..kMostDepth
  std::optional<double> error = {};  ///< accepted rms error of a local fit (length); default: a tenth of the noise
  std::optional<double> support =
      {};             ///< support radius / circumscribed radius of the block, 1.1..2; default 1.5 to 1.8
  int degree = 4;     ///< largest degree of the local polynomials, 1..4
  bool sharp = true;  ///< reproduce creases where the data shows them
  /// Whether the surface bounds no solid, and ends where its samples end: true, everywhere, false, nowhere; default:
  /// decided from the data for each connected part.
  std::optional<bool> open = {};

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the option, also where one belongs to the other method.
  void validate() const;
  bool is_paper() const { return fit == FitMethod::paper; }
};

}  // namespace sansmesh::inline v1
