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

/// Instead of a degree: for each support the highest that its samples allow, by their number and by what they cover of
/// it; of a fit as the sources have it, no higher than its threshold needs. Where such a fit asked for no coverage, the
/// thesis' thresholds stand in.
constexpr int kAutomaticDegree = 99;

/// Number of local functions of each degree.
using FitsOfDegree = std::array<std::size_t, kMaxDegree + 1>;

/// Least coverage for degrees 2, 3 and 4: area of the box of the projected samples over that of the projected support.
using PaperCoverage = std::array<double, 3>;

/// tejada2008, section 4.4.3.
constexpr PaperCoverage kThesisCoverage{0.40, 0.80, 0.85};

/// polizelli, section 3.2.
constexpr PaperCoverage kPaperCoverage{0.85, 0.90, 0.95};

/// Without the test: what both sources show the effect of it against.
constexpr PaperCoverage kNoCoverage{0, 0, 0};

/// Partition of unity that is fitted.
enum class FitMethod {
  partition,  ///< our own: docs/methods/partition-of-unity.md
  paper       ///< as the sources have it: docs/methods/paper-partition.md
};

/// Options of the fit of a function to samples. All optional lengths are in the unit of the input; where absent they
/// are derived from the data.
struct SANSMESH_API FitOptions {
  FitMethod fit = FitMethod::partition;  ///< which partition of unity
  /// Of FitMethod::paper: accepted rms distance of a support's samples over the diagonal of all; default: 0.002.
  std::optional<double> threshold = {};
  /// Of FitMethod::paper: least coverage for degrees 2, 3 and 4, each in 0..2; default: kThesisCoverage.
  std::optional<PaperCoverage> coverage = {};
  std::optional<int> depth =
      {};  ///< deepest level of the tree of fits, 2..14; default: where supports run out of samples
  std::optional<double> error = {};  ///< accepted rms error of a local fit (length); default: a tenth of the noise
  /// Support radius / circumscribed radius of the block, 1.1..2; default: 1.5 to 1.8.
  std::optional<double> support = {};
  int degree = 4;     ///< largest degree of the local polynomials, 1..4
  bool sharp = true;  ///< reproduce creases where the data shows them
  /// Whether the surface bounds no solid, and ends where its samples end: true, everywhere, false, nowhere; default:
  /// decided from the data for each connected part.
  std::optional<bool> open = {};

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the option, also where one belongs to the other method.
  void validate() const;
  /// Whether the fit is FitMethod::paper.
  bool is_paper() const { return fit == FitMethod::paper; }
};

/// How the blocks of FitMethod::paper came to be.
struct SANSMESH_API PaperReport {
  std::size_t blocks = 0;      ///< of the tree of fits, all levels
  std::size_t fitted = 0;      ///< leaves with a polynomial of their own samples
  std::size_t borrowed = 0;    ///< leaves with too few samples: a plane of the nearest ones
  std::size_t two_sheets = 0;  ///< subdivided since normals spread
  std::size_t too_many = 0;    ///< subdivided without a fit
  std::size_t not_worse = 0;   ///< with fewer than 100 samples: subdivided since the children are not worse
  std::size_t kept = 0;        ///< with fewer than 100 samples: not subdivided since the children are worse
  std::size_t above = 0;       ///< leaves whose error is above the threshold, or with two sheets
  std::size_t balanced = 0;    ///< leaves that only balance subdivides: the mesh's blocks have their function

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Gradients of functions that fit their samples are shorter than this, but for one in a thousand: longer ones come
/// from sheets that are too close to each other, rims, and samples that contradict each other. No bound: that is
/// ScalarField::ranges().
constexpr double kSoundSlope = 3;

}  // namespace sansmesh::inline v1
