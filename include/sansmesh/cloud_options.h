// Options of what is done to samples before any method, and what is found of their noise and normals.
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

/// Classes 0 to 255, numbered as in the LAS specification of the ASPRS: below 64 as there, above as the user defines
/// them.
using PointClasses = std::bitset<256>;

/// Reads a list with commas: numbers, ranges of them ("3-5") and names, in lower or upper case, of one class ("ground")
/// or of several ("vegetation": 3 to 5, "noise": 7 and 18, "wire": 13, 14 and 16). Throws ArgumentError, which lists
/// the names, for what is none of them.
SANSMESH_API PointClasses parse_point_classes(std::string_view list);

/// Text for classes, such as "2,4-6": parse_point_classes reads the same classes from it.
SANSMESH_API std::string point_classes_text(const PointClasses& classes);

/// Name of a class, "ground"; empty for classes without a name.
SANSMESH_API std::string_view point_class_name(unsigned number);

/// From what the signs of normals are taken, in the order in which it is trusted.
enum class OrientBy {
  automatic,    ///< the first of the following that there is
  scanner,      ///< the positions of scanners (PointSet::scanners)
  rows,         ///< rows and columns of a frame (PointSet::grid_normals)
  flight,       ///< the flight lines of a survey, from LAS attributes (times, scan angles)
  up,           ///< z: terrain is seen from above
  propagation,  ///< neighbours agree, and each connected part looks outward
};

/// What the signs were taken from: "by scanner position", "upward, as terrain".
SANSMESH_API std::string_view orientation_words(OrientBy by);

/// Where the input is a mesh or a polygon soup: what the samples are.
enum class FaceUse {
  automatic,  ///< samples of the faces where the vertices are too few or far apart to describe the surface
  ignore,     ///< the vertices, as if there were no faces
  sample,     ///< samples spread over the faces
  vertices    ///< the vertices, however few or flat, with the sides and normals of the faces
};

/// What is done about given normals.
enum class NormalUse {
  automatic,  ///< used, and turned where they are not consistent, point inward or away from known scanners
  as_given,   ///< used without a look at them
  estimate    ///< replaced
};

/// What is done to the samples before any method.
struct SANSMESH_API CloudPreparation {
  FaceUse faces = FaceUse::automatic;        ///< of meshes: what the samples are
  NormalUse normals = NormalUse::automatic;  ///< what is done about given normals
  /// From what normals that need it get their signs. Other than automatic: given ones get them anew, too, and DataError
  /// is thrown where nothing of the kind is known.
  OrientBy orient_by = OrientBy::automatic;
  /// Move scans that do not quite fit together onto each other (docs/methods/registration.md). Where false, a warning
  /// tells of scans that disagree.
  bool align = false;
  /// Leave out samples that belong to no surface, with a warning that counts them.
  bool remove_outliers = false;
  /// Only points of these classes, the others being left out before anything else.
  std::optional<PointClasses> classes = {};

  static const OptionSchema& schema();  ///< a row a field
};

/// How normals are estimated from neighbours.
struct SANSMESH_API NormalOptions {
  /// What is fitted to the neighbours.
  enum class Method {
    covariance,  ///< plane through the neighbours: direction of least variance (Hoppe et al. 1992)
    jet          ///< quadratic height function over that plane (Cazals & Pouget 2005): unbiased by curvature
  };
  Method method = Method::jet;  ///< what is fitted
  /// Samples in a neighbourhood, 6..500; default: from the spacing and the noise.
  std::optional<int> neighbours = {};
  /// Rounds of reweighting, 0..10, that reduce the weight of samples off the fitted plane: outliers, the other side of
  /// a crease or of a thin sheet. Sharper at creases, a little less steady under noise, half as fast.
  int reweightings = 0;
  /// Known spacing of the samples (length), to save its estimation; used where `neighbours` is absent.
  std::optional<double> spacing = {};
  /// Known standard deviation of the samples off the surface (length), to save its estimation; used likewise.
  std::optional<double> noise = {};

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What can be known of the noise of a cloud (lengths).
struct SANSMESH_API NoiseEstimate {
  double deviation = 0;  ///< standard deviation of the samples off the surface
  /// It is no more than this: what the nearest neighbours leave of the samples' heights, shape and noise together.
  double most = 0;
  /// There are neighbourhoods that show the noise by itself, or too little of either to matter. False where shape and
  /// noise look the same, as of few samples, and where steps hide what is smaller.
  bool known = false;
  /// Coordinates come in steps of this height, whole neighbourhoods at the same: depths of a sensor with few digits.
  double step = 0;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// The noise in words: "0.0039", "less than 0.0002", "unknown: 0.02 at most, of shape or noise", "unknown: too few
/// samples", …; `spacing` of the samples (length).
SANSMESH_API std::string noise_words(const NoiseEstimate& noise, double spacing);

/// How the normals of a cloud point.
enum class OrientationCheck {
  missing,     ///< no normals, or hardly any
  oriented,    ///< consistent and outward as far as can be told
  inward,      ///< consistent but pointing into the shape
  unoriented,  ///< neighbouring normals disagree in sign systematically
};

/// How the normals of a cloud point, in numbers.
struct SANSMESH_API OrientationReport {
  OrientationCheck check = OrientationCheck::missing;  ///< what follows from the numbers
  /// What neighbouring normals say of each other's signs, by its weight: the share that confirms those they have.
  /// 1: no contradiction; about ½: signs, or normals, at random.
  double agreement = 0;
  /// Share of the samples whose normals have to do with those of their neighbours at all: hardly any of normals at
  /// random.
  double related = 0;
  double outward = 0;  ///< share of the samples that lie in closed parts whose normals point outward
  double inward = 0;   ///< share of the samples that lie in closed parts whose normals point inward
  double open = 0;     ///< share of the samples in parts so far from closed that they have no outside: the rest
  /// Share of the samples, in closed parts, around which the normals do not enclose what they should
  /// (by winding numbers): seen from afar, where agreement is between neighbours.
  double doubt = 0;

  /// Whether signs that are consistent are right, too, for all but a few of the samples: agreement is the better the
  /// smoother normals are, and noise as large as the shape is thin hides which side is out.
  bool certain() const;
};

/// What is found of the normals that a cloud has.
struct SANSMESH_API GivenNormals {
  bool oriented = false;     ///< surely, be it inward
  std::string words;         ///< "none", "oriented outward", "not oriented consistently: …"
  OrientationReport report;  ///< by how neighbours agree and where closed parts look
  /// The sensor that all but a few look to, where one is known: it outweighs what neighbours say.
  std::optional<OrientBy> oriented_by = {};
  double looking_away = 0;  ///< share (0..1) of the normals that looks away from that sensor

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

}  // namespace sansmesh::inline v1
