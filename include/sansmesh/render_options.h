// Options of pictures: from where they are taken, how large they are, colours, light and lines; and pictures of meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/image.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

class CurvatureField;
class PictureScene;
struct Camera;
struct PictureFrame;

/// The axis that points up in the picture. The front looks from +z where y is up and from −y where z is up.
enum class UpAxis { y, z };

/// A direction to look from, in degrees: azimuth 0 is the front, 90 the right side (from +x); elevation 90 is above.
struct ViewDirection {
  double azimuth = 35;    ///< around the up axis, degrees
  double elevation = 20;  ///< above the horizon, degrees
};

/// front, back, left, right, top, bottom or iso. Throws ArgumentError naming the view and the choices.
SANSMESH_API ViewDirection named_view(const std::string& name);

/// The direction to look from at a place that `direction` leads away from (of any length but 0), such as the normal of
/// a surface there.
SANSMESH_API ViewDirection view_from(const Vec3& direction, UpAxis up);

/// The direction that looks straight at a box that is a single layer, 50 times as wide and high as thick at least;
/// nothing of others.
SANSMESH_API std::optional<ViewDirection> view_of_layer(const Box3& box, UpAxis up);

/// `frames` views (at least 1) evenly around the up axis, the first of them `view`.
SANSMESH_API std::vector<ViewDirection> turntable(const ViewDirection& view, int frames);

/// From where a picture is taken, how large it is, and which part of what there is it shows.
struct SANSMESH_API PictureView {
  int width = 1280, height = 960;  ///< pixels, 1..16384
  ViewDirection direction = {};    ///< degrees; `named_view` gives the usual ones
  UpAxis up = UpAxis::y;           ///< axis that points up
  double field_of_view = 30;       ///< degrees over the shorter side, 1..120
  bool orthographic = false;       ///< parallel rays: what is equally large is seen equally large at any depth
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

  static const OptionSchema& schema();  ///< a row a field
};

/// What pictures have behind all that is drawn.
struct Background {
  /// A gradient of light grays; one colour; or nothing, where pixels are transparent.
  enum class Kind : std::uint8_t { gradient, solid, transparent };
  Kind kind = Kind::gradient;  ///< which of them
  Vec3f color{1, 1, 1};        ///< sRGB 0..1, of a solid one

  /// One colour, sRGB 0..1.
  static Background solid(const Vec3f& color) { return {Kind::solid, color}; }
  /// Nothing.
  static Background transparent() { return {Kind::transparent}; }
};

/// Colours, light and lines.
struct SANSMESH_API PictureLook {
  std::optional<Background> background = {};  ///< behind what is drawn; default: a gradient, of lines light gray
  Vec3f surface_color{0.87f, 0.84f, 0.80f};   ///< sRGB 0..1, where there are no vertex colours
  bool use_colors = true;                     ///< take the vertex colours where there are some
  /// Edges of triangles as lines, over the shaded surface or alone: then the surface is clear, but hides what of the
  /// same mesh is behind it.
  enum class Wireframe : std::uint8_t { none, over, only };
  Wireframe wireframe = Wireframe::none;  ///< none: no edges
  double wire_width = 1;                  ///< pixels, 0.1..50
  Vec3f wire_color{0.10f, 0.12f, 0.15f};  ///< sRGB 0..1
  /// Silhouettes, borders, creases, ridges, valleys and suggestive contours, over the lit surface or alone,
  /// on white unless the background is transparent.
  enum class Lines : std::uint8_t { none, over, only };
  Lines lines = Lines::none;              ///< none: no lines
  double line_width = 1.5;                ///< pixels, 0.1..50
  double line_strength = 20;              ///< curvature times the diagonal from which on ridges are drawn, 0.1..1e6
  Vec3f line_color{0.08f, 0.08f, 0.10f};  ///< sRGB 0..1
  /// Light is how open a place is, and nothing else: the share of the sky that nothing of what is drawn hides, weighted
  /// by the cosine to the normal, times a factor for whether it is bent outwards or inwards (Miller 1994). What is
  /// farther away than this, over the diagonal, hides nothing: 1e-6..10.
  std::optional<double> accessibility = {};
  double curvature_shading = 0.3;  ///< most that the factor differs from 1, 0..1; 0: only what is hidden counts
  /// In the coordinates of what is drawn; null: no ridges, valleys and bends. Jobs find it where it is needed.
  std::shared_ptr<const CurvatureField> curvature = nullptr;
  bool smooth = true;   ///< interpolate normals over the triangles, except across creases
  bool shadows = true;  ///< of the key light, on the surface itself
  bool ground = true;   ///< let a shadow fall on the ground below
  /// Radius of points, in the unit of the cloud; default: from their spacing.
  std::optional<double> point_radius = {};

  /// The background; a gradient where none was chosen.
  Background behind() const { return background.value_or(Background{}); }

  static const OptionSchema& schema();  ///< a row a field
};

/// How many rays a picture takes.
struct SANSMESH_API PictureQuality {
  int samples = 3;         ///< samples per pixel in each direction, 1..8
  int occlusion_rays = 1;  ///< rays towards the sky a sample, 0..64; 0: none is blocked

  static const OptionSchema& schema();  ///< a row a field
};

/// What is written into a picture.
struct SANSMESH_API PictureAnnotation {
  /// Of orthographic pictures: a bar of a round length in the lower left corner, with this unit (may be empty).
  std::optional<std::string> scale_bar = {};
  double input_length = 1;  ///< of 1 in the coordinates of what is drawn, in the unit of the scale bar; > 0

  static const OptionSchema& schema();  ///< a row a field
};

/// What all pictures have: `{.view = {.width = 800}, .look = {.ground = false}}`.
struct SANSMESH_API RenderOptions {
  PictureView view = {};              ///< from where
  PictureLook look = {};              ///< colours, light and lines
  PictureQuality quality = {};        ///< how many rays
  PictureAnnotation annotation = {};  ///< what is written

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// The view's places and lengths, given in coordinates of the input, in those of a placement.
SANSMESH_API void move_from_input(RenderOptions& options, const LocalFrame& frame);

/// Pictures of surfaces without a mesh.
struct SANSMESH_API SurfaceRenderOptions {
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

  /// The rows of these options, those of `picture` among them.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Directions by name: the front looks from +z where y is up and from −y where z is up.
enum class NamedView : std::uint8_t { front, back, left, right, top, bottom, iso };

/// Part of a picture in pixels, from its left and its top.
struct PixelBox {
  int left = 0, top = 0, width = 0, height = 0;                        ///< pixels
  friend bool operator==(const PixelBox&, const PixelBox&) = default;  ///< equal in all
};

/// A part of a picture: the box, or what is not background.
struct PictureCrop {
  std::optional<PixelBox> box = {};                                          ///< none: what is not background
  friend bool operator==(const PictureCrop&, const PictureCrop&) = default;  ///< equal in all
};
// As an option: "LEFT,TOP,WIDTH,HEIGHT" or "content".
SANSMESH_API std::string text_of_option(const PictureCrop& crop);
SANSMESH_API void option_of_text(std::string_view text, PictureCrop& crop);
/// From where a picture is taken, in words, and which part of it is kept.
struct SANSMESH_API ViewOptions {
  std::optional<NamedView> view = {};    ///< a direction by its name
  std::optional<double> azimuth = {};    ///< without `view`; default: that of RenderOptions
  std::optional<double> elevation = {};  ///< the same
  bool z_up = false;                     ///< the z axis points up, not y
  std::optional<PictureCrop> crop = {};  ///< what is kept

  static const OptionSchema& schema();  ///< a row a field
  /// Tells whether a direction was chosen.
  bool has_direction() const { return view || azimuth || elevation; }
  /// The options as seen so. Throws ArgumentError for a part that does not lie in the picture.
  RenderOptions applied_to(RenderOptions options) const;
  /// Throws ArgumentError where several pictures would differ in size.
  void check_frames(bool several) const;
  /// Of a picture that was made with these options the part that was asked for. Throws ArgumentError where that does
  /// not lie in it.
  Image part_of(const Image& image, const RenderOptions& made_with) const;
};

/// Streaks that run along a flow.
struct SANSMESH_API FlowTextureOptions {
  double streak_length = 40;     ///< pixels, 1..1000 (where the surface is seen at right angles)
  double streak_width = 1.5;     ///< pixels, 0.5..100
  double streak_contrast = 0.4;  ///< 0..1
  /// Waves run along the streaks with the flow, by one wave as this goes from 0 to 1. Default: none.
  std::optional<double> phase = {};

  /// Without `phase`.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// How rays at a surface without a mesh fared.
struct SANSMESH_API CastCounts {
  std::uint64_t rays = 0, hits = 0;    ///< all, and those that met the surface
  std::uint64_t hit_evaluations = 0;   ///< of the field or projection, for rays that hit
  std::uint64_t miss_evaluations = 0;  ///< for rays that did not
  std::uint64_t ball_queries = 0;      ///< for balls along a ray

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// The mesh seen in perspective, framed to fill the picture. Meshes without triangles are clouds: discs where there are
/// normals, else balls. Vertices that are not finite are left out. The picture does not depend on the number of
/// threads. Throws DataError where there is nothing to see, ArgumentError for bad options.
SANSMESH_API Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options, Progress& progress);
/// The same without a word of its progress.
SANSMESH_API Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options = {});

/// Takes a picture as it is made, from frame 0 on; `made_with` are its options.
using UsePicture = std::function<void(std::size_t frame, const Image& image, const RenderOptions& made_with)>;

/// Something that stands in a picture, as surface_in_picture() makes it: it owns what it needs. Gets ready for a
/// picture with this frame and camera, both of which only the library knows.
using PictureSurface = std::function<std::unique_ptr<PictureScene>(const PictureFrame& frame, const Camera& camera)>;

/// A mesh, or a cloud as discs or balls. The mesh is copied. Throws DataError where there is nothing to draw.
SANSMESH_API PictureSurface surface_in_picture(const TriangleMesh& mesh, const RenderOptions& options);
/// The same with light from behind coming through, sheet after sheet: `opacity` 0..1 is the share that is kept back
/// where the surface is seen at right angles. `apart`: sheets nearer to each other than this, in the coordinates of the
/// picture, are one; default: what floats can tell apart.
SANSMESH_API PictureSurface translucent(PictureSurface surface, double opacity, double apart = 0);

}  // namespace sansmesh::inline v1
