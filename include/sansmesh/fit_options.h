// Options and report of fitting a partition of unity to samples.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "sansmesh/api.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Largest degree of local polynomials.
constexpr int kMaxDegree = 4;

/// Value that replaces a degree: each support takes the highest degree that the number and the coverage of its samples
/// allow; FitMethod::paper takes no higher degree than its threshold needs. If such a fit has no coverage thresholds,
/// kThesisCoverage applies.
constexpr int kAutomaticDegree = 99;

/// Number of local functions of each degree.
using FitsOfDegree = std::array<std::size_t, kMaxDegree + 1>;

/// Least coverage for degrees 2, 3 and 4: area of the box of the projected samples over that of the projected support.
using PaperCoverage = std::array<double, 3>;

/// tejada2008, section 4.4.3.
constexpr PaperCoverage kThesisCoverage{0.40, 0.80, 0.85};

/// polizelli, section 3.2.
constexpr PaperCoverage kPaperCoverage{0.85, 0.90, 0.95};

/// Disables the coverage test. Both sources show the test's effect by comparison with this.
constexpr PaperCoverage kNoCoverage{0, 0, 0};

/// Kinds of partitions of unity.
enum class FitMethod {
  partition,  ///< this library's method: docs/methods/partition-of-unity.md
  paper       ///< the published method: docs/methods/paper-partition.md
};

/// Options of fitting a function to samples. Optional lengths are in the unit of the input; where absent they are
/// derived from the data.
struct SANSMESH_API FitOptions {
  FitMethod fit = FitMethod::partition;  ///< kind of partition of unity
  /// FitMethod::paper only: accepted rms distance of a support's samples over the diagonal of all samples; default:
  /// 0.002.
  std::optional<double> threshold = {};
  /// FitMethod::paper only: least coverage for degrees 2, 3 and 4, each in 0..2; default: kThesisCoverage.
  std::optional<PaperCoverage> coverage = {};
  /// Deepest level of the tree of fits, 2..14; default: the level where supports run out of samples.
  std::optional<int> depth = {};
  std::optional<double> error = {};  ///< accepted rms error of a local fit (length); default: a tenth of the noise
  /// Support radius / circumscribed radius of the block, 1.1..2; default: 1.5 to 1.8.
  std::optional<double> support = {};
  int degree = 4;     ///< largest degree of the local polynomials, 1..4
  bool sharp = true;  ///< reproduce creases where the data shows them
  /// Open surface, which bounds no solid and ends where its samples end. true: everywhere, false: nowhere; default:
  /// decided from the data for each connected part.
  std::optional<bool> open = {};

  static const OptionSchema& schema();  ///< one row a field
  /// Throws ArgumentError naming the option, also for options of the other method.
  void validate() const;
  /// Whether the fit is FitMethod::paper.
  bool is_paper() const { return fit == FitMethod::paper; }
};

/// Statistics of the blocks of FitMethod::paper.
struct SANSMESH_API PaperReport {
  std::size_t blocks = 0;      ///< blocks of the tree of fits, all levels
  std::size_t fitted = 0;      ///< leaves with a polynomial of their own samples
  std::size_t borrowed = 0;    ///< leaves with too few samples: a plane of the nearest ones
  std::size_t two_sheets = 0;  ///< blocks subdivided because normals spread
  std::size_t too_many = 0;    ///< blocks subdivided without a fit, because they hold too many samples
  std::size_t not_worse = 0;   ///< blocks with fewer than 100 samples, subdivided because the children are not worse
  std::size_t kept = 0;        ///< blocks with fewer than 100 samples, not subdivided because the children are worse
  std::size_t above = 0;       ///< leaves with an error above the threshold, or with two sheets
  std::size_t balanced = 0;    ///< leaves subdivided only for balance: the mesh's blocks keep their function

  static const ReportSchema& schema();  ///< one row a figure
};

/// Largest plausible length of gradients of fitted functions: 999 in 1,000 are shorter. Longer ones come from sheets
/// that are too close to each other, from rims, and from contradicting samples. Not a bound: see ScalarField::ranges().
constexpr double kPlausibleGradient = 3;

}  // namespace sansmesh::inline v1
