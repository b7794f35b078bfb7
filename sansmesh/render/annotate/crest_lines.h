// Ridges, valleys and suggestive contours, from curvature at the pixels of a picture.
#pragma once

#include "sansmesh/image.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

/// Share of each pixel that these lines cover, 0..1. With `curvature` of the options:
/// - ridges: the larger principal curvature is positive and maximal along its own direction;
/// - valleys: the smaller one is negative and minimal along its own direction (Ohtake, Belyaev & Seidel 2004).
///
/// Both only if that curvature is the larger one in size, times the diagonal exceeds `line_strength`, and decreases to
/// both sides. Always suggestive contours: minima of the cosine to the viewing direction along the projection of that
/// direction to the tangent plane (DeCarlo et al. 2003, section 4.2). Positions between pixels follow from parabolas
/// through three values.
PixelMap<float> crest_ink(const PictureScene& scene, const Camera& camera, const PictureFrame& frame,
                          const RenderOptions& options);

}  // namespace sansmesh::inline v1
