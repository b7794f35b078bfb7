// Traits of a cloud, and recommended methods.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/cloud_options.h"
#include "sansmesh/note.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

/// Traits that determine the choice of a method. All but the outliers are estimated at some hundred points of the
/// cloud.
struct SANSMESH_API CloudTraits {
  std::size_t samples = 0;    ///< number of valid samples, outliers included
  double diagonal = 0;        ///< diagonal of the bounding box (length, unit of the input)
  double spacing = 0;         ///< side of the square that one sample represents (length)
  double noise = 0;           ///< standard deviation of the samples from the surface (length)
  double most_noise = 0;      ///< upper bound of the noise (length)
  bool noise_known = true;    ///< false where shape or quantised coordinates look like noise (NoiseEstimate)
  double step = 0;            ///< quantisation step of the coordinates, where it hides the noise (length)
  double density_ratio = 1;   ///< local spacing: 95 % quantile over 5 % quantile, by area
  double evenness = 1;        ///< distance to the nearest sample over spacing: 1 for a lattice, 0.5 at random
  double outliers = 0;        ///< share of samples that belong to no surface
  double creases = 0;         ///< share of points next to an edge of more than 40°
  double crease_length = 0;   ///< approximate total length of these edges, relative to the diagonal
  double borders = 0;         ///< share of points next to a border or hole
  double border_length = 0;   ///< approximate total length of the borders, relative to the diagonal
  bool creases_known = true;  ///< false where noise hides them
  /// Share of the surface area that bounds no solid and ends where the samples end, from a partition of unity fitted to
  /// at most 60,000 samples; 0 if they are too few for a fit.
  double open = 0;
  bool faces = false;          ///< the input has faces
  std::size_t open_edges = 0;  ///< edges of one face after joining equal positions; 0 where most edges are open
  std::size_t open_loops = 0;  ///< connected sets of these edges: borders and holes
  OrientationCheck normals = OrientationCheck::missing;  ///< presence and orientation of the normals
  OrientationReport orientation;                         ///< the same in numbers

  /// Noise over spacing; 0 without a spacing.
  double noise_ratio() const { return spacing > 0 ? noise / spacing : 0; }

  static const ReportSchema& schema();  ///< one row per figure
};

/// Measures the samples in O(n). The outliers take most of the time, about 2 µs of CPU per sample; openness takes up to
/// a second. Notes on the samples replace `notes`, if that is not null. Throws DataError if no method can
/// reconstruct the points.
SANSMESH_API CloudTraits measure_traits(PointSet points, Progress& progress, std::vector<Note>* notes = nullptr);

/// One method for one aim.
struct Recommendation {
  /// Intended result: a mesh, a picture without a mesh, curvatures, denoised or new points, a solid (editing, CSG), or
  /// a deformation.
  enum class Aim { mesh, picture, curvature, points, solid, deformation };
  Aim aim = Aim::mesh;           ///< intended result
  std::string surface;           ///< name of the method (SurfaceOptions::method)
  bool sharp = false;            ///< SurfaceOptions::sharp
  bool remove_outliers = false;  ///< CloudPreparation::remove_outliers
  std::string why;               ///< one sentence; names options as errors do (sansmesh/error.h)
};

/// Traits and the conclusions from them.
struct SANSMESH_API Advice {
  CloudTraits traits;  ///< traits that the advice is based on
  /// Observations, one line each, by descending importance.
  std::vector<std::string> findings;
  /// Recommended methods, the first choice first; at least one each for a mesh, a picture, curvatures, solids (editing,
  /// CSG) and deformation.
  std::vector<Recommendation> recommendations;
  std::vector<Note> notes;  ///< on the preparation of the samples

  static const ReportSchema& schema();  ///< one row per figure
};

/// Samples, spacing, noise and findings as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const Advice& advice);

/// Advice from traits, by tejada2008, ch. 7, and docs/methods/which-method.md.
SANSMESH_API Advice advise(const CloudTraits& traits);

/// Measures the traits, then advises. Throws as measure_traits.
SANSMESH_API Advice advise(const PointSet& points, Progress& progress);

/// "mesh", "picture", "curvature", "points", "solid", "deform".
SANSMESH_API const char* aim_word(Recommendation::Aim aim);

}  // namespace sansmesh::inline v1
