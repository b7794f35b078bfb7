// Pictures as large as what they show.
#pragma once

#include "sansmesh/image.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

/// What of a picture is not background, as a picture made with these options has it, with a margin around it as far as
/// the picture goes. What stands beside the picture (a bar of colours) counts. All of the picture where there is
/// nothing else.
PixelBox picture_content(const Image& image, const RenderOptions& options, int margin);
/// Throws ArgumentError unless the part, of at least one pixel, lies in a picture of that size.
void check_crop(const PixelBox& part, int width, int height);
/// Throws ArgumentError unless the part, of at least one pixel, lies in the picture.
Image cropped(const Image& image, const PixelBox& part);

}  // namespace sansmesh::inline v1
