// Mean of the samples of a pixel, and its colour.
#pragma once

#include "sansmesh/image.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Means over the samples on the surface, and over those with a query for `dark`.
struct Pixel {
  float cover = 0;               // share of samples on the surface
  Vec3f position, normal;        // the sum of unit normals is shorter than 1 if they differ
  Vec3f color;                   // share of light reflected
  Vec3f ambient;                 // light from all directions; the fields from here to `dark` are noisy with few rays
  float open = 0;                // unoccluded share of the sky
  float lit = 0, lit_asked = 0;  // unoccluded share of the key light; number of its samples
  float dark = 0;                // loss of light on the ground
  float asked = 0;               // number of samples of `dark`
  float facing = 0, fill = 0;    // cosines to the key and fill light
  float shine = 0, sheen = 0;    // mirrored key light; sky light at grazing angles
  float access = -1;             // accessibility shading if >= 0: the light is this times `open`, and nothing else
  Vec3f beyond;                  // light from mirrors and clear bodies
};

/// Linear light from the surface, regardless of its cover.
Vec3f surface_light(const Pixel& pixel);

/// Colour over `background` (linear light).
Rgba opaque_color(const Pixel& pixel, const Vec3f& background);

/// Colour with alpha; the shadow on the ground is a transparent black.
Rgba transparent_color(const Pixel& pixel);

/// The colour rounded to bytes with dither at pixel (x, y), because wide gradients would show steps.
Rgba dithered(const Rgba& color, int x, int y);

}  // namespace sansmesh::inline v1
