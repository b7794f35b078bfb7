// A picture, or a turntable of pictures, of meshes, points, lines and functions.
#pragma once

#include <vector>

#include "sansmesh/jobs/picture_options.h"
#include "sansmesh/jobs/picture_report.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Bars of colours and the list of several objects are in the width of the picture. Lines of a cloud are those of a
/// surface of its samples, if they make one. Throws ArgumentError for bad options, and for such as what is drawn would
/// not heed; DataError that begins with a name where there is nothing to draw; Cancelled.
RenderResult render(std::vector<PictureObject> objects, const PictureOptions& options, const UsePicture& use,
                    Progress& progress);

}  // namespace sansmesh::inline v1
