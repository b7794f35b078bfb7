// Traits of a cloud, and the methods that suit it.
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

/// What matters for the choice. Everything but the outliers is told from some hundred places of the cloud.
struct SANSMESH_API CloudTraits {
  std::size_t samples = 0;    ///< that can be used, outliers among them
  double diagonal = 0;        ///< of the box (length, unit of the input)
  double spacing = 0;         ///< edge of the square that one sample stands for (length)
  double noise = 0;           ///< standard deviation of the samples off the surface (length)
  double most_noise = 0;      ///< it is no more than this (length)
  bool noise_known = true;    ///< false where shape, or steps of the coordinates, look the same (NoiseEstimate)
  double step = 0;            ///< of the coordinates, where it hides the noise (length)
  double density_ratio = 1;   ///< local spacing: its 95 % quantile over its 5 % quantile, by area
  double evenness = 1;        ///< distance to the nearest sample over spacing: 1 for a lattice, 0.5 at random
  double outliers = 0;        ///< share of samples that belong to no surface
  double creases = 0;         ///< share of places next to an edge of more than 40°
  double crease_length = 0;   ///< about how long these edges are together, over the diagonal
  double borders = 0;         ///< share of places next to a border or hole
  double border_length = 0;   ///< about how long the borders are together, over the diagonal
  bool creases_known = true;  ///< false where the noise hides them
  /// Share of the surface's area that bounds no solid, and would end where the samples end: of the partition of unity
  /// of these samples, or of 60,000 of them; 0 where they are too few for a fit.
  double open = 0;
  bool faces = false;          ///< the input has faces
  std::size_t open_edges = 0;  ///< of the faces, sewn at equal places: edges of one triangle; 0 where most are
  std::size_t open_loops = 0;  ///< connected sets of these: borders and holes
  OrientationCheck normals = OrientationCheck::missing;  ///< whether there are normals, and how they point
  OrientationReport orientation;                         ///< the same in numbers

  /// Noise over spacing; 0 without a spacing.
  double noise_ratio() const { return spacing > 0 ? noise / spacing : 0; }

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Measures the samples: O(n), most of it for the outliers, about 2 µs of CPU per sample, and the openness, up to a
/// second. What there is to say of the samples replaces what is in `warnings`, if that is not null. Throws DataError
/// where the points cannot be reconstructed at all.
SANSMESH_API CloudTraits measure_traits(PointSet points, Progress& progress,
                                        std::vector<std::string>* warnings = nullptr);

/// One method for one aim.
struct Recommendation {
  /// What is to be made: a mesh, a picture without one, curvatures, denoised or new points, a solid (editing, CSG), or
  /// a deformation.
  enum class Aim { mesh, picture, curvature, points, solid, deformation };
  Aim aim = Aim::mesh;           ///< what this is a recommendation for
  std::string surface;           ///< the method, by name (SurfaceOptions::method)
  bool sharp = false;            ///< SurfaceOptions::sharp
  bool remove_outliers = false;  ///< CloudPreparation::remove_outliers
  std::string why;               ///< one sentence, which names options as errors do (sansmesh/error.h)
};

/// Traits, and what follows from them.
struct SANSMESH_API Advice {
  CloudTraits traits;  ///< that it is made from
  /// What was seen, one line each, in the order of importance.
  std::vector<std::string> findings;
  /// What to do, the first choice first; one entry at least for a mesh, a picture, curvatures, solids (editing, CSG)
  /// and deformation each.
  std::vector<Recommendation> recommendations;
  std::vector<Note> notes;  ///< "preparation": what there is to say of the samples

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Samples, spacing, noise and findings, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const Advice& advice);

/// Advice from traits: what METHODS §8 and docs/methods/which-method.md say of such traits.
SANSMESH_API Advice advise(const CloudTraits& traits);

/// Measures the traits, then advises. Throws as measure_traits.
SANSMESH_API Advice advise(const PointSet& points, Progress& progress);

/// "mesh", "picture", "curvature", "points", "solid", "deform".
SANSMESH_API const char* aim_word(Recommendation::Aim aim);

}  // namespace sansmesh::inline v1
