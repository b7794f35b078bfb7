// Pictures as they are handed over.
#pragma once

#include <cstddef>
#include <functional>

#include "sansmesh/image.h"
#include "sansmesh/render/render_options.h"

namespace sansmesh::inline v1 {

/// Takes a picture as it is made, from frame 0 on; `made_with` are its options.
using UsePicture = std::function<void(std::size_t frame, const Image& image, const RenderOptions& made_with)>;

}  // namespace sansmesh::inline v1
