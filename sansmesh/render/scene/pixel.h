// What the rays of a pixel found, and the colour that it takes.
#pragma once

#include "sansmesh/image.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// What the samples of a pixel saw: means over those on the surface, and over those that asked for `dark`.
struct Pixel {
  float cover = 0;               // share of samples on the surface
  Vec3f position, normal;        // sums of unit normals are shorter than 1 where they differ
  Vec3f color;                   // share of light reflected
  Vec3f ambient;                 // light from all around; this down to `dark` is what few rays make noisy
  float open = 0;                // share of the sky that is not blocked
  float lit = 0, lit_asked = 0;  // share of the key light that is not blocked; number of samples for that
  float dark = 0;                // loss of light on the ground
  float asked = 0;               // number of samples for that
  float facing = 0, fill = 0;    // cosines to the key and fill light
  float shine = 0, sheen = 0;    // mirrored key light; sky at grazing angles
  float access = -1;             // from 0 on: the light is so many times `open`, and nothing else
  Vec3f beyond;                  // light from mirrors and clear bodies
};

/// Linear light that comes from the surface, whatever its cover.
Vec3f surface_light(const Pixel& pixel);

/// In front of `background` (linear light).
Rgba opaque_color(const Pixel& pixel, const Vec3f& background);

/// With alpha instead; the shadow on the ground is black that lets the rest through.
Rgba transparent_color(const Pixel& pixel);

}  // namespace sansmesh::inline v1
