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

/// "2,3-5": what parse_point_classes reads as these classes.
SANSMESH_API std::string point_classes_text(const PointClasses& classes);

/// "ground"; empty for classes without a name.
SANSMESH_API std::string_view point_class_name(unsigned number);

/// From what the signs of normals are taken, in the order in which it is trusted.
enum class OrientBy {
  automatic,    ///< the first of the following that there is
  scanner,      ///< the positions of scanners (PointSet::scanners)
  rows,         ///< rows and columns of a frame (PointSet::grid_normals)
  flight,       ///< the flight lines of a survey (`directions_to_flight`)
  up,           ///< z: terrain is seen from above
  propagation,  ///< neighbours agree, and each connected part looks outward
};

/// What the signs were taken from: "by scanner position", "upward, as terrain".
SANSMESH_API std::string_view orientation_words(OrientBy by);

/// Where the input is a mesh or a polygon soup: its vertices as samples, or samples spread over its faces; automatic:
/// the faces where the vertices are too few or far apart to describe the surface; vertices: these, however few or flat,
/// and only the sides and normals of the faces, for what is asked at the vertices themselves.
enum class FaceUse { automatic, ignore, sample, vertices };

/// Given normals are used, and turned where they are not consistent, point inward or away from known scanners;
/// as_given: not even looked at; estimate: they are replaced.
enum class NormalUse { automatic, as_given, estimate };

/// What is done to the samples before any method.
struct SANSMESH_API CloudUse {
  FaceUse faces = FaceUse::automatic;
  NormalUse normals = NormalUse::automatic;
  /// From what normals that need it get their signs. Other than automatic: given ones get them anew, too, and DataError
  /// is thrown where nothing of the kind is known.
  OrientBy orient_by = OrientBy::automatic;
  /// Move scans that do not quite fit together onto each other (`find_scan_motions`). Where false, a warning tells of
  /// scans that disagree.
  bool align = false;
  /// Leave out samples that belong to no surface (`find_outliers`), with a warning that counts them.
  bool remove_outliers = false;
  /// Only points of these classes (`keep_classes`), the others being left out before anything else.
  std::optional<PointClasses> classes = {};

  static const OptionSchema& schema();  ///< a row a field
};

struct SANSMESH_API NormalOptions {
  enum class Method {
    covariance,  ///< plane through the neighbours: direction of least variance (Hoppe et al. 1992)
    jet          ///< quadratic height function over that plane (Cazals & Pouget 2005): unbiased by curvature
  };
  Method method = Method::jet;
  /// Samples in a neighbourhood, 6..500; default: `choose_neighbours` of the estimated spacing and noise.
  std::optional<int> neighbours = {};
  /// Rounds of reweighting, 0..10, that reduce the weight of samples off the fitted plane: outliers, the other side of
  /// a crease or of a thin sheet. Sharper at creases, a little less steady under noise, half as fast.
  int reweightings = 0;
  /// Known spacing and noise (lengths), to save their estimation; used where `neighbours` is absent.
  std::optional<double> spacing = {}, noise = {};

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What can be known of the noise of a cloud (lengths).
struct SANSMESH_API NoiseEstimate {
  double deviation = 0;  ///< as `estimate_noise`
  /// It is no more than this: what the nearest neighbours leave of the samples' heights, shape and noise together.
  double most = 0;
  /// There are neighbourhoods that show the noise by itself, or too little of either to matter. False where shape and
  /// noise look the same, as of few samples, and where steps hide what is smaller.
  bool known = false;
  /// Coordinates come in steps of this height, whole neighbourhoods at the same: depths of a sensor with few digits.
  double step = 0;

  static const ReportSchema& schema();
};

/// "0.0039", "less than 0.0002", "unknown: 0.02 at most, of shape or noise", "unknown: too few samples", …; `spacing`
/// of the samples (length).
SANSMESH_API std::string noise_words(const NoiseEstimate& noise, double spacing);

enum class OrientationCheck {
  missing,     ///< no normals, or hardly any
  oriented,    ///< consistent and outward as far as can be told
  inward,      ///< consistent but pointing into the shape
  unoriented,  ///< neighbouring normals disagree in sign systematically
};

/// What `check_orientation` sees, in numbers.
struct SANSMESH_API OrientationReport {
  OrientationCheck check = OrientationCheck::missing;
  /// What neighbouring normals say of each other's signs, by its weight: the share that confirms those they have.
  /// 1: no contradiction; about ½: signs, or normals, at random.
  double agreement = 0;
  /// Share of the samples whose normals have to do with those of their neighbours at all: hardly any of normals at
  /// random.
  double related = 0;
  /// Shares of the samples: in closed parts whose normals point outward, or inward, and in parts that are so far from
  /// closed that they have no outside. They add up to 1.
  double outward = 0, inward = 0, open = 0;
  /// Share of the samples, in closed parts, around which the normals do not enclose what they should (`winding_doubt`):
  /// seen from afar, where agreement is between neighbours.
  double doubt = 0;

  /// Whether signs that are consistent are right, too, for all but a few of the samples: agreement is the better the
  /// smoother normals are, and noise as large as the shape is thin hides which side is out.
  bool certain() const;
};

struct SANSMESH_API GivenNormals {
  bool oriented = false;     ///< surely, be it inward
  std::string words;         ///< "none", "oriented outward", "not oriented consistently: …"
  OrientationReport report;  ///< by how neighbours agree and where closed parts look
  /// The sensor that all but a few look to, where one is known, and the share that looks away from it: it outweighs
  /// what neighbours say.
  std::optional<OrientBy> oriented_by = {};
  double looking_away = 0;

  static const ReportSchema& schema();
};

}  // namespace sansmesh::inline v1
