// Picture of an inspection map, with a scale of distances beside it.
#pragma once

#include <string>

#include "sansmesh/image.h"
#include "sansmesh/inspect.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/render_options.h"

namespace sansmesh::inline v1 {

struct MapPicture {
  Image image;
  RenderOptions look;  ///< what the map was drawn with
};

/// Throws ArgumentError where a picture is too narrow for itself and any scale, whose `unit` is that of lengths.
void check_map_picture(const RenderOptions& look, const std::string& unit);

/// The mesh in the colours of its map, on light gray and without shadows, so that they can be read; its scale, with
/// marks at the tolerance, is in the width of the picture.
MapPicture draw_map(const CompareResult& compared, const CompareOptions& options, const RenderOptions& look,
                    const std::string& unit, Progress& progress);

}  // namespace sansmesh::inline v1
