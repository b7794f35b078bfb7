// Drawings of surfaces by lines, found in the picture: where the surface ends, turns away, folds, and is bent most.
#pragma once

#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

/// How much of each pixel lines cover, 0..1. Silhouettes and borders are where neighbouring rays, so many as there are
/// samples, hit and miss, or hit sheets one behind the other; creases where their normals differ by a jump; ridges,
/// valleys and suggestive contours as crest_ink() has them. Does not depend on the number of threads.
PixelMap<float> line_ink(const PictureScene& scene, const Camera& camera, const PictureFrame& frame,
                         const RenderOptions& options, Progress& progress);

/// Lines of a colour (sRGB) over a picture.
void draw_ink(Image& image, const PixelMap<float>& ink, const Vec3f& color);

}  // namespace sansmesh::inline v1
