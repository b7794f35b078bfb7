// Pictures of a surface without a mesh, directly from samples or from a function.
#pragma once

#include <cstdint>

#include "sansmesh/pictures.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Crest lines come from the surface itself or from estimates at its samples.
enum class CrestsFrom : std::uint8_t { surface, samples };

/// Draws by ray casting or by splats. Throws DataError that begins with the object's name.
void draw_surface(PictureObject object, const PictureOptions& options, CrestsFrom crests, const UsePicture& use,
                  RenderResult& result, Progress& progress);

}  // namespace sansmesh::inline v1
