// The sign of normals: is it consistent, and how to make it so.
#pragma once

#include <optional>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/point_set.h"

namespace sansmesh {

enum class OrientationCheck {
  missing,     ///< no normals, or hardly any
  oriented,    ///< consistent and outward as far as can be told
  inward,      ///< consistent but pointing into the shape
  unoriented,  ///< neighbouring normals disagree in sign systematically
};

/// Judges points.normals on a fixed subsample: orients it anew and asks whether that makes whole regions agree with
/// their surroundings that disagreed before. Single wrong signs (noise) and thin parts do not count.
/// `noise` (length), where it is known, saves its estimation.
OrientationCheck check_orientation(const PointSet& points, std::optional<double> noise = {});

struct OrientationOptions {
  /// Samples each sample is compared with, 4..100.
  int neighbours = 10;
  /// Known noise (length), to save its estimation.
  std::optional<double> noise = {};
  /// Turn the normals towards the scanners where points.scanners and points.scan_of_point are known.
  bool use_scanners = true;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Flips points.normals so that neighbours agree and each connected part points outward. Signs are propagated along a
/// graph of neighbours from the safest relations to the least safe ones (after Hoppe et al. 1992): first the smooth
/// patches, then patch to patch by the vote of all relations between them, with the rule of König & Gumhold 2009 across
/// creases. Each part's sign follows from its extremal points and its volume; where scanners are known, from those.
/// Zero normals stay zero. Throws DataError if there are no normals.
void orient_normals(PointSet& points, const OrientationOptions& options, Progress& progress);

}  // namespace sansmesh
