// What a partition of unity is made of, as plain arrays: what a file keeps and what an edit replaces.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/core/shared_array.h"
#include "sansmesh/fit_options.h"
#include "sansmesh/partition/local_function.h"
#include "sansmesh/partition/paper_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct PartitionOptions {
  std::optional<int>
      max_depth;  ///< deepest level of the tree, kLeastDepth..kMostDepth; default: where supports run out of samples
  std::optional<double> error;  ///< accepted rms error of a local function (length); default: 0.1 noise
  /// Radius of a support / circumscribed radius of its block, 1.1..2; default: 1.5, up to 2.5 where noise is large
  /// against the spacing.
  std::optional<double> support;
  int max_degree = 4;      ///< largest polynomial degree, 1..4
  int min_samples = 9;     ///< a support with fewer samples borrows a larger ball for its fit
  int max_samples = 1000;  ///< beyond this a block is subdivided without fitting (METHODS case iii);
                           ///< on the deepest level only so many of its samples are used
  std::array<double, kMaxDegree + 1> coverage{0, 0, 0.4, 0.6, 0.7};  ///< least coverage k for each degree
  double max_eccentricity = 0.2;  ///< beyond it (a border of the data) only planes: curved fits overshoot there
  bool sharp = true;              ///< split supports at creases
  /// Whether the surface bounds no solid: true, of all sheets, false, of none; default: decided for each of them.
  std::optional<bool> open;

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What fitting learned about the data.
struct PartitionReport {
  double noise = 0;           ///< rms deviation of the samples from the surface (length)
  double error = 0;           ///< accepted error used (length)
  double accuracy = 0;        ///< estimated rms error of the surface (length)
  double area = 0;            ///< of the surface near samples (length²)
  double spacing = 0;         ///< of the samples: √(area / count) (length)
  int depth = 0;              ///< deepest level used
  std::size_t functions = 0;  ///< supports
  FitsOfDegree functions_of_degree{};
  std::size_t creased = 0;         ///< supports with a crease or corner
  double open_area = 0;            ///< of sheets that bound no solid (length²)
  double mean_winding_number = 1;  ///< just behind the samples: 1 of a closed surface, 1/2 of a plane
};

/// Of one support, beside its function: which block it belongs to, and how well it was fitted. The layout is that of
/// function files.
struct Support {
  enum State : std::uint8_t { fitted = 0, constant = 1 };
  std::uint64_t code = 0;     ///< Morton code of the block on its level
  Vec3f foot;                 ///< of the support's centre on the function's zero set
  float area = 0;             ///< of the zero set within the block; 0 for constants
  float error = 0;            ///< rms distance of the samples from the zero set (length)
  float coverage = 0;         ///< box of the samples over the disc of the support (METHODS §3.1)
  std::uint32_t samples = 0;  ///< in the ball of the fit (of every stride-th, where there are very many)
  std::uint8_t level = 0;     ///< of the block
  std::uint8_t state = fitted;
  std::uint8_t creased = 0;  ///< 1: there is a crease or corner in it
  std::uint8_t open = 0;     ///< 1: on a sheet that bounds no solid (sheets that end: openness.h)
};

static_assert(sizeof(Support) == 40 && alignof(Support) == 8);

/// How a fit came to its scales: what is needed to refit a part of it as if it had been part of the whole.
struct ScaleBasis {
  int sort_depth = 0;   ///< of the tree of samples
  int tried = 0;        ///< finest level that was tried
  int finest = 0;       ///< finest level that was worth it
  double variance = 0;  ///< of the noise (length²)
  double accepted = 0;  ///< rms error that needs no subdivision (length)
  double support = 0;   ///< radius of a support / circumscribed radius of its block
  double fit = 0;       ///< radius of the ball of samples that a fit starts from / circumscribed radius of its block
  double height = 0;    ///< how far off the surface samples counted at least where scales were chosen (length)
};

struct PartitionData {
  /// How flat the surface is around the blocks of one level that hold samples.
  struct Flatness {
    SharedArray<std::uint64_t> code;   ///< Morton codes, ascending
    SharedArray<float> gap;            ///< that linear triangles would leave (length; large or infinite at creases)
    SharedArray<std::uint32_t> child;  ///< code.size() + 1 entries: children on the next level; none on the last
  };

  Vec3 origin;     ///< of the cloud: the function takes world positions
  Vec3f lower;     ///< of the root cube, relative to origin
  float edge = 0;  ///< of the root cube
  PartitionOptions options;
  /// Of a fit as the sources have it: its functions are blended without any of the default's precautions, and its tree
  /// (`flatness`) is that of the blocks, inner ones with an infinite gap. `options` then says the same as far as it
  /// can.
  std::optional<PaperOptions> paper;
  PartitionReport report;
  ScaleBasis basis;
  SharedArray<LocalFunction> functions;  ///< one per support, then further pieces of creased ones
  /// Of each of the functions, a proven bound for the length of its gradient in the ball of its support
  /// (local_slope()). Empty: to be computed from the functions.
  SharedArray<float> slopes;
  SharedArray<Support> supports;   ///< in the order of their blocks along the Morton curve
  std::vector<Flatness> flatness;  ///< of each level

  /// Fills in the slopes from the functions.
  void find_slopes();

  /// Throws DataError that says what is wrong with it, were it from a file.
  void validate() const;
};

}  // namespace sansmesh::inline v1
