// Pictures of meshes and point clouds without a display: ray cast, softly lit, the same on every run.
#pragma once

#include <optional>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/image.h"
#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/render/camera.h"

namespace sansmesh {

struct RenderOptions {
  int width = 1280, height = 960;  ///< pixels, 1..16384
  ViewDirection view;              ///< degrees; `named_view` gives the usual ones
  UpAxis up = UpAxis::y;
  double field_of_view = 30;  ///< degrees over the shorter side, 1..120
  enum class Background { gradient, solid, transparent } background = Background::gradient;
  Vec3f background_color{1, 1, 1};           ///< sRGB 0..1, for a solid background
  Vec3f surface_color{0.87f, 0.84f, 0.80f};  ///< sRGB 0..1, where there are no vertex colours
  bool use_colors = true;                    ///< take the vertex colours where there are some
  bool smooth = true;                        ///< interpolate normals over the triangles, except across creases
  bool shadows = true;                       ///< of the key light, on the surface itself
  bool ground = true;                        ///< let a shadow fall on the ground below
  int samples = 3;                           ///< samples per pixel in each direction, 1..8
  int occlusion_rays = 1;                    ///< rays towards the sky a sample, 0..64; 0: none is blocked
  /// Radius of points, in the unit of the cloud; default: from their spacing.
  std::optional<double> point_radius;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// The mesh seen in perspective, framed to fill the picture. Meshes without triangles are clouds: discs where there are
/// normals, else balls. Vertices that are not finite are left out. The picture does not depend on the number of
/// threads. Throws DataError where there is nothing to see, ArgumentError for bad options.
Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options, Progress& progress);
Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options = {});

}  // namespace sansmesh
