// Pictures of a surface without a mesh, straight from samples or of a function.
#pragma once

#include <cstdint>

#include "sansmesh/pictures.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Crests are those of the surface itself, or of estimates at its samples.
enum class CrestsFrom : std::uint8_t { surface, samples };

/// By rays, or by splats. Throws DataError that begins with the object's name.
void draw_surface(PictureObject object, const PictureOptions& options, CrestsFrom crests, const UsePicture& use,
                  RenderResult& result, Progress& progress);

}  // namespace sansmesh::inline v1
