// The sign of normals: is it consistent, and how to make it so.
#pragma once

#include <optional>
#include <span>

#include "sansmesh/cloud_options.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/sights.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

class KdTree;

/// Normals with less agreement, or of which fewer are related, are not oriented.
inline constexpr double kLeastAgreement = 0.9, kLeastRelated = 0.5;

OrientationReport measure_orientation(const PointSet& points, std::optional<double> noise = {});

/// Judges points.normals on a fixed subsample: orients it anew and asks whether that makes whole regions agree with
/// their surroundings that disagreed before. Single wrong signs (noise) and thin parts do not count. Parts that are far
/// from closed, such as terrain, have no outside: their normals are never `inward`.
/// `noise` (length), where it is known, saves its estimation.
OrientationCheck check_orientation(const PointSet& points, std::optional<double> noise = {});

struct OrientationOptions {
  /// Samples each sample is compared with, 4..100.
  int neighbours = 10;
  /// Known noise (length), to save its estimation.
  std::optional<double> noise = {};
  /// From what the signs are taken. Automatic: the first in the order of OrientBy that is known and with which the
  /// smooth parts of the cloud agree. Others: that one, whatever the normals are like.
  OrientBy by = OrientBy::automatic;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Flips points.normals so that neighbours agree and each connected part looks to where it was seen from or, where that
/// is not known, outward. Signs are propagated along a graph of neighbours from the safest relations to the least safe
/// ones (after Hoppe et al. 1992): first the smooth patches, then patch to patch by the vote of all relations between
/// them, with the rule of König & Gumhold 2009 across creases. Samples that clearly face from where they were seen, or
/// clearly look away, are certain from the start; parts without any get their sign from their extremal points and their
/// volume. Zero normals stay zero. Returns from what the signs were taken. Throws DataError if there are no normals, or
/// nothing is known of what `options.by` asks for.
OrientBy orient_normals(PointSet& points, const OrientationOptions& options, Progress& progress);

/// The same with a tree of the positions at hand.
OrientBy orient_normals(PointSet& points, const KdTree& tree, const OrientationOptions& options, Progress& progress);

/// Share of the normals that look away from where their samples were seen, of those that clearly look there or away (by
/// more than 15° from across). `sights`: as find_sights. 0 where none does.
double share_looking_away(const PointSet& points, std::span<const Vec3f> sights);

}  // namespace sansmesh::inline v1
