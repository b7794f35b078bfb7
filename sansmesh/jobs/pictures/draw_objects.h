// Several objects in one picture, each with its own colour.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/note.h"
#include "sansmesh/pictures.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Draws all objects side by side, lines as tubes, with a legend. Throws DataError that begins with an object's name.
void draw_objects(std::vector<PictureObject> objects, const PictureOptions& options, const UsePicture& use,
                  RenderResult& result, Progress& progress);

/// Removes stray samples and notes how many: "outliers". Throws DataError if none remains.
void leave_out_outliers(PointSet& points, const std::string& name, std::vector<Note>& notes, Progress& progress);

}  // namespace sansmesh::inline v1
