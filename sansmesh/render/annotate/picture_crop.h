// Crops pictures to their content.
#pragma once

#include "sansmesh/image.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

/// The part of a picture that is not background, given the options it was made with, plus a margin as far as the
/// picture reaches. Annotation beside the picture (a colour bar) counts as content. The whole picture if there is no
/// content.
PixelBox picture_content(const Image& image, const RenderOptions& options, int margin);
/// Throws ArgumentError unless the part, of at least one pixel, is inside a picture of that size.
void check_crop(const PixelBox& part, int width, int height);
/// Throws ArgumentError unless the part, of at least one pixel, is inside the picture.
Image cropped(const Image& image, const PixelBox& part);

}  // namespace sansmesh::inline v1
