// What is asked of a reconstruction of a volume, what it tells, and what the values of a volume are like.
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

/// Absent options are chosen from the data. Without a method no other option may be set.
struct SANSMESH_API ReconstructionOptions {
  std::optional<std::string> method = {};  ///< "mls-detail", "linear", …: `sansmesh schema` and its pages list them
  std::optional<int> degree = {};          ///< mls, mls-detail: highest degree of polynomials, 0..4; lagrange: 1..5
  std::optional<int> iterations = {};      ///< amls: times that residuals are added, 0..100
  std::optional<double> epsilon = {};      ///< amls: ε, 0.05..10: small is smooth
  std::optional<int> order = {};           ///< amls: 2, 4 or 6
  std::optional<double> radius = {};       ///< of the supports of methods that have some: in spacings, 1..10
  /// amls: balls about the samples, as wide as their farthest neighbour is away, in place of ellipsoids; for
  /// comparison. Not for lattices (uniform and rectilinear grids), whose supports follow their steps.
  std::optional<bool> spherical = {};
  std::optional<bool> robust = {};  ///< mls-detail: weights that leave steps between materials sharp
  double b = 0, c = 0.5;            ///< cubic: B and C, 0..1 each; Catmull–Rom

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What was chosen, and what is worth knowing.
struct ReconstructionReport {
  ReconstructionOptions options;       ///< with what was chosen from the data, the method too
  std::string why;                     ///< the method was chosen: a sentence without its end
  std::vector<std::string> notes;      ///< "12 samples have no value: they were filled in from their neighbours", …
  std::vector<std::size_t> by_degree;  ///< polynomials of each degree that there are, where there are any
  double noise = 0;                    ///< of the values, where it was estimated (unit of the array)
  std::size_t bytes = 0;               ///< of memory that the field takes with its samples and cells, about
};

/// Told from some thousand samples: each is predicted from the samples around it by polynomials of degree 0 to 3. All
/// values are shares of the range that the array has (of vectors: of the largest range of a component).
struct VolumeTraits {
  std::size_t samples = 0;  ///< that were looked at
  double range = 0;         ///< largest minus least value (unit of the array)
  /// Median error of predicting a sample from its neighbours, for each degree. It falls with the degree where samples
  /// are dense enough for what they show, and stays where there is noise, or structure between two samples.
  std::array<double, 4> left_out{};
  /// Root mean square of the same errors: what a few samples next to edges are missed by counts here.
  std::array<double, 4> left_out_rms{};
  double noise = 0;  ///< standard deviation of noise, if what no degree predicts is that: an upper bound
  /// Share of the samples next to steps: that are off by more than ten times the median, and a twentieth of the range.
  double steps = 0;

  /// Parabolas predict samples better than planes do: there is something to gain over linear interpolation.
  bool resolved() const { return left_out[2] < 0.8 * left_out[1] || left_out[1] < 1e-6; }
  /// They also do at the few samples that are predicted worst, which are those at edges.
  bool edges_resolved() const { return left_out_rms[2] < 0.5 * left_out_rms[1] || left_out_rms[1] < 1e-6; }
};

/// The method that is taken where nobody chose.
struct ReconstructionChoice {
  std::string method = "mls-detail";  ///< its name
  std::string why;                    ///< a sentence without an end
};

/// What the values of an array belong to.
enum class Association : std::uint8_t { points, cells };

}  // namespace sansmesh::inline v1
