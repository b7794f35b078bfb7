// Data of a partition of unity as plain arrays: the content of files, and the argument and result of edits.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/core/shared_array.h"
#include "sansmesh/fit_options.h"
#include "sansmesh/partition/local_function.h"
#include "sansmesh/partition/paper/paper_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct PartitionOptions {
  /// Deepest level of the tree, kLeastDepth..kMostDepth; default: the level where supports run out of samples.
  std::optional<int> max_depth;
  std::optional<double> error;  ///< accepted rms error of a local function (length); default: 0.1 noise
  /// Radius of a support / circumscribed radius of its block, 1.1..2; default: 1.5, up to 2.5 if noise is large against
  /// the spacing.
  std::optional<double> support;
  int max_degree = 4;   ///< largest polynomial degree, 1..4
  int min_samples = 9;  ///< a support with fewer samples uses a larger ball for its fit
  /// With more samples a block is subdivided without fitting (tejada2008, 4.4.3, case iii); on the deepest level only
  /// this many of its samples are used.
  int max_samples = 1000;
  std::array<double, kMaxDegree + 1> coverage{0, 0, 0.4, 0.6, 0.7};  ///< least coverage k for each degree
  double max_eccentricity = 0.2;  ///< above it (a border of the data) only planes, because curved fits overshoot there
  bool sharp = true;              ///< split supports at creases
  /// Open surface, which bounds no solid. true: all sheets, false: none; default: decided for each sheet.
  std::optional<bool> open;

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Measured properties of the data and statistics of the fit.
struct PartitionReport {
  double noise = 0;           ///< rms deviation of the samples from the surface (length)
  double error = 0;           ///< accepted error used (length)
  double accuracy = 0;        ///< estimated rms error of the surface (length)
  double area = 0;            ///< area of the surface near samples (length²)
  double spacing = 0;         ///< spacing of the samples: √(area / count) (length)
  int depth = 0;              ///< deepest level used
  std::size_t functions = 0;  ///< supports
  FitsOfDegree functions_of_degree{};
  std::size_t creased = 0;  ///< supports with a crease or corner
  double open_area = 0;     ///< area of sheets that bound no solid (length²)
  double mean_winding_number =
      1;  ///< mean winding number just behind the samples: 1 for a closed surface, 1/2 for a plane
};

/// Properties of one support besides its function: its block and the quality of its fit. The layout is that of function
/// files.
struct Support {
  enum State : std::uint8_t { fitted = 0, constant = 1 };
  std::uint64_t code = 0;     ///< Morton code of the block on its level
  Vec3f foot;                 ///< foot of the support's centre on the function's zero set
  float area = 0;             ///< area of the zero set within the block; 0 for constants
  float error = 0;            ///< rms distance of the samples from the zero set (length)
  float coverage = 0;         ///< area of the samples' box over that of the support's disc (tejada2008, 4.4.3)
  std::uint32_t samples = 0;  ///< number of samples in the ball of the fit (every stride-th, if there are very many)
  std::uint8_t level = 0;     ///< level of the block
  std::uint8_t state = fitted;
  std::uint8_t creased = 0;  ///< 1: contains a crease or corner
  std::uint8_t open = 0;     ///< 1: on a sheet that bounds no solid (openness.h)
};

static_assert(sizeof(Support) == 40 && alignof(Support) == 8);

/// Choice of scales of a fit, from which a part of it can be refitted as if it belonged to the whole.
struct ScaleBasis {
  int sort_depth = 0;   ///< depth of the tree of samples
  int tried = 0;        ///< finest level that was tried
  int finest = 0;       ///< finest level that was accepted
  double variance = 0;  ///< variance of the noise (length²)
  double accepted = 0;  ///< rms error that needs no subdivision (length)
  double support = 0;   ///< radius of a support / circumscribed radius of its block
  double fit = 0;       ///< radius of the initial ball of samples of a fit / circumscribed radius of its block
  double height = 0;    ///< least distance off the surface up to which samples counted in the choice of scales (length)
};

struct PartitionData {
  /// Flatness of the surface around the blocks of one level that hold samples.
  struct Flatness {
    SharedArray<std::uint64_t> code;  ///< Morton codes, ascending
    SharedArray<float> gap;           ///< distance to linear triangles (length; large or infinite at creases)
    SharedArray<std::uint32_t>
        child;  ///< code.size() + 1 entries: start of the children on the next level; empty on the last
  };

  Vec3 origin;     ///< origin of the cloud; the function takes world positions
  Vec3f lower;     ///< corner of the root cube, relative to origin
  float edge = 0;  ///< edge of the root cube
  PartitionOptions options;
  /// Options of the published method, if that was used. Its functions are blended without the precautions of the
  /// default method, and its tree (`flatness`) is that of the blocks, inner ones with an infinite gap. `options` then
  /// holds the equivalent values where they exist.
  std::optional<PaperOptions> paper;
  PartitionReport report;
  ScaleBasis basis;
  SharedArray<LocalFunction> functions;  ///< one per support, then further pieces of creased ones
  /// Proven bound of the length of each function's gradient in the ball of its support (local_slope()). Empty: to be
  /// computed from the functions.
  SharedArray<float> slopes;
  SharedArray<Support> supports;   ///< in the order of their blocks along the Morton curve
  std::vector<Flatness> flatness;  ///< one per level

  /// Computes the slopes from the functions.
  void find_slopes();

  /// Throws DataError describing the first inconsistency, in the words of an error in a file.
  void validate() const;
};

}  // namespace sansmesh::inline v1
