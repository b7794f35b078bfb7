// Line drawings of surfaces from the picture: silhouettes, borders, creases and curvature lines.
#pragma once

#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

/// Share of each pixel that lines cover, 0..1. At silhouettes and borders neighbouring rays (`samples` per pixel and
/// direction) hit and miss, or hit different sheets. At creases their normals differ by a jump. Ridges, valleys and
/// suggestive contours are those of crest_ink(). Does not depend on the number of threads.
PixelMap<float> line_ink(const PictureScene& scene, const Camera& camera, const PictureFrame& frame,
                         const RenderOptions& options, Progress& progress);

/// Draws lines of a colour (sRGB) over a picture.
void draw_ink(Image& image, const PixelMap<float>& ink, const Vec3f& color);

}  // namespace sansmesh::inline v1
