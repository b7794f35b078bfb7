// Several objects in one picture, each with its own colour.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/core/note.h"
#include "sansmesh/core/progress.h"
#include "sansmesh/data/point_set.h"
#include "sansmesh/jobs/picture_options.h"
#include "sansmesh/jobs/picture_report.h"

namespace sansmesh {

/// All objects side by side, lines as tubes, with a list of them. Throws DataError that begins with an object's name.
void draw_objects(std::vector<PictureObject> objects, const PictureOptions& options, const UsePicture& use,
                  RenderResult& result, Progress& progress);

/// Removes samples that belong to no surface, and notes how many: "outliers". Throws DataError where none is left.
void leave_out_outliers(PointSet& points, const std::string& name, std::vector<Note>& notes, Progress& progress);

}  // namespace sansmesh
