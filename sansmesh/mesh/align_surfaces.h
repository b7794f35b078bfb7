// One surface moved onto another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sansmesh/affine_map.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Where the search for the motion begins.
enum class AlignStart : std::uint8_t {
  automatic,   ///< where the surface lies; if that does not lead to a fit, everywhere
  as_it_lies,  ///< nowhere else
  anywhere     ///< every rotation, and places that look alike
};

struct SurfaceAlignmentOptions {
  AlignStart start = AlignStart::automatic;
  /// Of the moving surface that are compared in the last steps, 100..10^7.
  std::size_t samples = 20000;
  /// Steps of each search at most, 1..1000.
  int iterations = 100;
  /// Also find one factor for all lengths.
  bool scale = false;

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// x → scale · R (x − from) + to, R by its columns, in the coordinates of the world.
struct SimilarityMotion {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  double scale = 1;
  Vec3 from, to;

  Vec3 turn(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3 operator()(const Vec3& p) const { return turn(p - from) * scale + to; }
  /// Of the rotation, 0..180 degrees.
  double angle() const;
  Vec3 axis() const;  ///< unit; any where the angle is 0
  AffineMap map() const;
};

/// From this share of `differing` on two surfaces are not of the same shape.
constexpr double kOtherShape = 0.1;

/// Lengths in the unit of the fixed surface.
struct SurfaceAlignment {
  SimilarityMotion motion;
  AlignStart start = AlignStart::as_it_lies;  ///< from which the motion was found
  int iterations = 0;                         ///< of the last search
  std::size_t samples = 0;                    ///< compared
  /// Share (0..1) of the samples that lie on the fixed surface: within `reach` of it, where it has not ended, and with
  /// a like normal.
  double overlap = 0;
  double reach = 0;
  /// Distances of these from the surface, now; and of all samples before.
  double rms = 0, median = 0, p95 = 0;
  double median_before = 0;
  /// How far the samples were moved, root mean square.
  double moved = 0;
  /// Other poses that fit as well (to 2 %): the shape looks alike from several sides. Only where they were looked for.
  std::size_t alternatives = 0;
  bool searched = false;                   ///< whether they were looked for
  std::vector<double> alternative_angles;  ///< to these, in degrees
  /// Motions, of the six (seven), that the surfaces do not tell: 3 of a ball, 1 of a vase that was turned on a wheel.
  int free_motions = 0;
  /// Share (0..1) of the samples beside the fixed surface at which its shape is another one: their neighbours are off
  /// by the same, which noise is not. Median of that distance.
  double differing = 0, differing_by = 0;
  /// The mirror image of what moves fits where it does not itself. Looked for only where the shape differs.
  bool mirror_image_fits = false;
  /// Whether this can be the motion: the overlap is a fifth or more.
  bool found = false;
  /// Size of what moves over that of the fixed surface, as they came: distances from the middle that three quarters of
  /// their points are within.
  double size_ratio = 1;

  static const ReportSchema& schema();
};

/// Finds the motion that brings samples of `moving` onto the surface of `fixed` (its triangles, or the tangent planes
/// of its points): distances from sample to surface, weighted down by Tukey's function of a width that follows the
/// median, until they do not fall any more [chen1992], [rusinkiewicz2019]. Samples beyond borders and such with another
/// normal do not count, so that a part fits onto the whole, and two parts that overlap onto each other. From anywhere:
/// 480 rotations about the middle, and pairs of places with like features [rusu2009]; the poses in which most of both
/// surfaces lie on each other are searched from. The same for any number of threads. Points without normals get
/// estimated ones. Throws DataError where a side has fewer than 20 finite points, or no extent.
SurfaceAlignment align_surfaces(const TriangleMesh& moving, const TriangleMesh& fixed,
                                const SurfaceAlignmentOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
