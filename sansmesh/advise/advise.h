// Which method suits these samples? What is measured, and what follows from it.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/advise/traits.h"
#include "sansmesh/note.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct Recommendation {
  enum class Aim { mesh, picture, curvature, points, solid, deformation } aim;
  std::string surface;           ///< by name
  bool sharp = false;            ///< SurfaceOptions::sharp
  bool remove_outliers = false;  ///< CloudUse::remove_outliers
  std::string why;               ///< one sentence, which names options as errors do (sansmesh/error.h)
};

struct Advice {
  CloudTraits traits;
  /// What was seen, one line each, in the order of importance.
  std::vector<std::string> findings;
  /// What to do, the first choice first; one entry at least for a mesh, a picture, curvatures, solids (editing, CSG)
  /// and deformation each.
  std::vector<Recommendation> recommendations;
  std::vector<Note> notes;  ///< "preparation": what there is to say of the samples

  static const ReportSchema& schema();
};

/// What METHODS §8 and docs/methods/which-method.md say of such traits.
Advice advise(const CloudTraits& traits);

/// Both.
Advice advise(const PointSet& points, Progress& progress);

/// mesh, picture, …
const char* aim_word(Recommendation::Aim aim);

}  // namespace sansmesh::inline v1
