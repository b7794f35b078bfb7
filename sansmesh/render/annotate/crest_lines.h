// Ridges, valleys and suggestive contours, from curvature at the pixels of a picture.
#pragma once

#include "sansmesh/image.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

/// How much of each pixel these lines cover, 0..1; with `curvature` of the options:
/// - ridges, where the larger principal curvature is positive and most along its own direction;
/// - valleys, where the smaller one is negative and least along its own direction (Ohtake, Belyaev & Seidel 2004),
///
/// each only where it is the one of larger size, times the diagonal exceeds `line_strength`, and falls off to both
/// sides. And always suggestive contours: where the cosine to the direction of sight is least along that direction's
/// image in the tangent plane (DeCarlo et al. 2003, section 4.2). Places between pixels follow from parabolas through
/// three.
PixelMap<float> crest_ink(const PictureScene& scene, const Camera& camera, const PictureFrame& frame,
                          const RenderOptions& options);

}  // namespace sansmesh::inline v1
