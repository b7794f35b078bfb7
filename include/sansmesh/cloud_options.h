// Options of cloud preparation, and estimates of noise and orientation of normals.
#pragma once

#include <bitset>
#include <optional>
#include <string>
#include <string_view>

#include "sansmesh/api.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

/// Classes 0 to 255 as in the ASPRS LAS specification: standard below 64, user-defined above.
using PointClasses = std::bitset<256>;

/// Parses a comma-separated list of numbers, ranges ("3-5") and names in any case, of one class ("ground") or several
/// ("vegetation": 3 to 5, "noise": 7 and 18, "wire": 13, 14 and 16). Throws ArgumentError, with the known names, for
/// other entries.
SANSMESH_API PointClasses parse_point_classes(std::string_view list);

/// Formats classes such that parse_point_classes reads them: "2,4-6".
SANSMESH_API std::string point_classes_text(const PointClasses& classes);

/// Name of a class: "ground"; empty for classes without a name.
SANSMESH_API std::string_view point_class_name(unsigned number);

/// Source of the signs of normals, in descending order of reliability.
enum class OrientBy {
  automatic,    ///< first available one of the following
  scanner,      ///< scanner positions (PointSet::scanners)
  rows,         ///< rows and columns of a depth frame (PointSet::grid_normals)
  flight,       ///< flight lines of a survey, from LAS attributes (times, scan angles)
  up,           ///< +z: terrain is seen from above
  propagation,  ///< agreement of neighbours; connected parts face outward
};

/// Description of the source: "by scanner position", "upward, as terrain".
SANSMESH_API std::string_view orientation_words(OrientBy by);

/// Samples taken from a mesh or polygon soup.
enum class FaceUse {
  automatic,  ///< samples on the faces if the vertices are too few or too far apart to describe the surface
  ignore,     ///< vertices, ignoring the faces
  sample,     ///< samples distributed over the faces
  vertices    ///< vertices in any case, with the sides and normals of the faces
};

/// Treatment of given normals.
enum class NormalUse {
  /// used, but reoriented if inconsistent, inward or facing away from known scanners, and replaced by estimates if
  /// unrelated to those of neighbouring samples
  automatic,
  as_given,  ///< used unchecked
  estimate   ///< replaced by estimates
};

/// Preparation of the samples before any method.
struct SANSMESH_API CloudPreparation {
  FaceUse faces = FaceUse::automatic;        ///< samples of a mesh
  NormalUse normals = NormalUse::automatic;  ///< treatment of given normals
  /// Source of the signs of normals. Any source but automatic also reorients given normals, and throws DataError if the
  /// data lacks it.
  OrientBy orient_by = OrientBy::automatic;
  /// Align slightly misregistered scans (docs/methods/registration.md). If false, a warning reports misaligned scans.
  bool align = false;
  /// Remove samples off the surface, with a warning that states their number. Default: `reconstruct` and `fit_function`
  /// remove them where they are clearly clutter (docs/methods/points.md), other jobs keep them.
  std::optional<bool> remove_outliers = {};
  /// Keep only points of these classes; applied first.
  std::optional<PointClasses> classes = {};

  static const OptionSchema& schema();  ///< a row per field
};

/// Estimation of normals from neighbours.
struct SANSMESH_API NormalOptions {
  /// Model fitted to the neighbours.
  enum class Method {
    covariance,  ///< plane through the neighbours: direction of least variance (hoppe1992)
    jet          ///< quadratic height function over that plane (cazals2005): not biased by curvature
  };
  Method method = Method::jet;  ///< fitted model
  /// Samples per neighbourhood, 6..500; default: from spacing and noise.
  std::optional<int> neighbours = {};
  /// Rounds of reweighting, 0..10. They reduce the weight of samples off the fitted plane: outliers, the other side of
  /// a crease or of a thin sheet. Sharper at creases, slightly less stable under noise, half as fast.
  int reweightings = 0;
  /// Known spacing of the samples (length), saves its estimation; used if `neighbours` is absent.
  std::optional<double> spacing = {};
  /// Known standard deviation of the samples off the surface (length), saves its estimation; used if `neighbours` is
  /// absent.
  std::optional<double> noise = {};

  static const OptionSchema& schema();  ///< a row per field
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Estimated noise of a cloud (lengths).
struct SANSMESH_API NoiseEstimate {
  double deviation = 0;  ///< standard deviation of the samples off the surface
  /// Upper bound: residual heights of the samples over their nearest neighbours, shape and noise together.
  double most = 0;
  /// Whether some neighbourhoods separate noise from shape, or both are negligible. False if they cannot be separated
  /// (few samples), or if steps hide smaller noise.
  bool known = false;
  /// Step of quantised coordinates, where whole neighbourhoods have the same value: depths of a sensor with few digits.
  double step = 0;

  static const ReportSchema& schema();  ///< a row per reported value
};

/// Noise as text: "0.0039", "less than 0.0002", "unknown: 0.02 at most, of shape or noise", "unknown: too few samples",
/// …; `spacing` of the samples (length).
SANSMESH_API std::string noise_words(const NoiseEstimate& noise, double spacing);

/// Orientation of the normals of a cloud.
enum class OrientationCheck {
  missing,     ///< no normals, or very few
  oriented,    ///< consistent and, as far as can be determined, outward
  inward,      ///< consistent but inward
  unoriented,  ///< neighbouring normals disagree systematically in sign
};

/// Orientation of the normals of a cloud, with its measures.
struct SANSMESH_API OrientationReport {
  OrientationCheck check = OrientationCheck::missing;  ///< conclusion from the measures
  /// Weighted share of pairs of neighbouring normals that confirm each other's signs. 1: no contradiction; about ½:
  /// random signs or normals.
  double agreement = 0;
  /// Share of the samples whose normals are correlated with those of their neighbours; near 0 for random normals.
  double related = 0;
  double outward = 0;  ///< share of the samples in closed parts with outward normals
  double inward = 0;   ///< share of the samples in closed parts with inward normals
  double open = 0;     ///< share of the samples in open parts, which have no outside: the rest
  /// Share of the samples in closed parts whose winding numbers contradict the normals; a global measure, in contrast
  /// to `agreement`.
  double doubt = 0;

  /// Whether consistent signs are also correct for all but a few samples. Agreement increases with the smoothness of
  /// the normals; noise of the size of the shape's thickness hides the outer side.
  bool certain() const;
};

/// Assessment of the given normals of a cloud.
struct SANSMESH_API GivenNormals {
  bool oriented = false;     ///< certainly consistent, possibly inward
  std::string words;         ///< "none", "oriented outward", "not oriented consistently: …"
  OrientationReport report;  ///< agreement of neighbours, and direction in closed parts
  /// Sensor, if known, that all but a few normals face: it outweighs the agreement of neighbours.
  std::optional<OrientBy> oriented_by = {};
  double looking_away = 0;  ///< share (0..1) of the normals that face away from that sensor

  static const ReportSchema& schema();  ///< a row per reported value
};

}  // namespace sansmesh::inline v1
