// Classes of survey points from the ground filter, and selection by class where nothing is classified.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sansmesh/cloud_options.h"
#include "sansmesh/note.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

struct GroundClassification {
  std::size_t ground = 0;   ///< points that became class 2
  std::size_t others = 0;   ///< points that became class 1
  std::size_t kept = 0;     ///< points with a class of their own, which they keep
  bool had_ground = false;  ///< there was ground among these: nothing was changed

  /// "1,234 of 2,345 points are ground"
  std::string words() const;
};

/// Stores class 2 (ground) or 1 (unclassified) in the attribute `classification` of points that have class 0, 1 or
/// none. Points of other classes keep them, and those of noise do not take part. Does nothing if there are points of
/// class 2. Throws DataError as find_ground.
GroundClassification classify_ground(PointSet& points, Progress& progress);

/// Keeps the points of these classes, as keep_classes. If they include ground, no point has a class but 0 and 1, and
/// the cloud is a terrain, the ground is found first, with a note "ground_found".
std::vector<Note> select_classes(PointSet& points, const PointClasses& classes, Progress& progress);

/// Removes noise, and vegetation if there is ground: a terrain is without them. With a note "classes_left_out".
std::vector<Note> leave_out_vegetation(PointSet& points);

/// Note "unclassified_survey" for airborne surveys without classes, normals and scanners that have a tenth of their
/// samples or more above the ground. Judges 20,000 samples.
std::vector<Note> suggest_ground(const PointSet& points);

}  // namespace sansmesh::inline v1
