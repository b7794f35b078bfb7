// What a picture is to look like.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "sansmesh/box.h"
#include "sansmesh/field/curvature_field.h"
#include "sansmesh/option.h"
#include "sansmesh/placement.h"
#include "sansmesh/render/camera.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// From where a picture is taken, how large it is, and which part of what there is it shows.
struct PictureView {
  int width = 1280, height = 960;  ///< pixels, 1..16384
  ViewDirection direction = {};    ///< degrees; `named_view` gives the usual ones
  UpAxis up = UpAxis::y;
  double field_of_view = 30;  ///< degrees over the shorter side, 1..120
  bool orthographic = false;  ///< parallel rays: what is equally large is seen equally large at any depth
  /// Place in the middle of the picture, in the coordinates of what is drawn; the view keeps its direction. Default:
  /// the middle of what there is to see.
  std::optional<Vec3> look_at = {};
  double zoom = 1;  ///< so many times as large as what shows everything, 0.001..100000
  /// Instead of `zoom`: a ball of this radius around `look_at` fills the picture. > 0, in the unit of what is drawn.
  std::optional<double> look_radius = {};
  /// Only what lies in this box is shown, in the coordinates of what is drawn. (Mirrors and clear bodies still show
  /// the rest.)
  std::optional<Box3> clip_box = {};
  bool steady = false;  ///< does not zoom with the direction: frames of a turntable fit together

  static const OptionSchema& schema();
};

/// Colours, light and lines.
struct PictureLook {
  enum class Background : std::uint8_t { gradient, solid, transparent } background = Background::gradient;
  Vec3f background_color{1, 1, 1};           ///< sRGB 0..1, for a solid background
  Vec3f surface_color{0.87f, 0.84f, 0.80f};  ///< sRGB 0..1, where there are no vertex colours
  bool use_colors = true;                    ///< take the vertex colours where there are some
  /// Edges of triangles as lines, over the shaded surface or alone: then the surface is clear, but hides what of the
  /// same mesh is behind it.
  enum class Wireframe : std::uint8_t { none, over, only } wireframe = Wireframe::none;
  double wire_width = 1;                  ///< pixels, 0.1..50
  Vec3f wire_color{0.10f, 0.12f, 0.15f};  ///< sRGB 0..1
  /// Silhouettes, borders, creases, ridges, valleys and suggestive contours (line_drawing.h), over the lit surface or
  /// alone, on white unless the background is transparent.
  enum class Lines : std::uint8_t { none, over, only } lines = Lines::none;
  double line_width = 1.5;                ///< pixels, 0.1..50
  double line_strength = 20;              ///< curvature times the diagonal from which on ridges are drawn, 0.1..1e6
  Vec3f line_color{0.08f, 0.08f, 0.10f};  ///< sRGB 0..1
  /// Light is how open a place is, and nothing else: the share of the sky that nothing of what is drawn hides, weighted
  /// by the cosine to the normal, times a factor for whether it is bent outwards or inwards (Miller 1994). What is
  /// farther away than this, over the diagonal, hides nothing: 1e-6..10.
  std::optional<double> accessibility = {};
  double bend_light = 0.3;  ///< most that the factor differs from 1, 0..1; 0: only what is hidden counts
  /// In the coordinates of what is drawn; null: no ridges, valleys and bends. Must outlive the pictures.
  const CurvatureField* curvature = nullptr;
  bool smooth = true;   ///< interpolate normals over the triangles, except across creases
  bool shadows = true;  ///< of the key light, on the surface itself
  bool ground = true;   ///< let a shadow fall on the ground below
  /// Radius of points, in the unit of the cloud; default: from their spacing.
  std::optional<double> point_radius = {};

  static const OptionSchema& schema();
};

/// How many rays a picture takes.
struct PictureQuality {
  int samples = 3;         ///< samples per pixel in each direction, 1..8
  int occlusion_rays = 1;  ///< rays towards the sky a sample, 0..64; 0: none is blocked

  static const OptionSchema& schema();
};

/// What is written into a picture.
struct PictureAnnotation {
  /// Of orthographic pictures: a bar of a round length in the lower left corner, with this unit (may be empty).
  std::optional<std::string> scale_bar = {};
  double input_length = 1;  ///< of 1 in the coordinates of what is drawn, in the unit of the scale bar; > 0

  static const OptionSchema& schema();
};

/// What all pictures have: `{.view = {.width = 800}, .look = {.ground = false}}`.
struct RenderOptions {
  PictureView view = {};
  PictureLook look = {};
  PictureQuality quality = {};
  PictureAnnotation annotation = {};

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// The view's places and lengths, given in coordinates of the input, in those of a placement.
void move_from_input(RenderOptions& options, const Placement& place);

/// Pictures of surfaces without a mesh.
struct SurfaceRenderOptions {
  RenderOptions picture = {};  ///< as of meshes; `smooth` and `point_radius` mean nothing here
  /// Share of the light that a mirror would send, 0..1. Mirror rays are cast on the surface itself.
  double reflection = 0;
  /// Share of the light that comes through, 0..1: the surface bounds a clear body. reflection + transmission <= 1.
  double transmission = 0;
  /// Of the body against what is around it, 1..4: 1.33 water, 1.5 glass. Mirrors what Fresnel's formulas say on top.
  double refraction_index = 1.5;
  /// Mirror and refraction rays in sequence, 1..16.
  int bounces = 4;
  /// Shadows fall from the surface itself, not from discs around the samples: exact and slow.
  bool exact_shadows = false;
  /// For quick frames: no shadows, no occlusion, no ground, one sample a pixel, whatever else is set.
  bool plain = false;
  /// What mirrors and glass show where a ray leaves: linear light (1 is white) from a unit direction. Default: the
  /// background in front, a bright sky elsewhere.
  std::function<Vec3f(const Vec3f& direction)> environment = {};

  /// All but those of `picture`.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

}  // namespace sansmesh::inline v1
