// Options of pictures (camera, size, colours, light, lines), and pictures of meshes.
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

/// The axis that points up in the picture. The front view looks from +z if y is up and from −y if z is up.
enum class UpAxis { y, z };

/// Viewing direction in degrees: azimuth 0 is the front, 90 the right side (from +x); elevation 90 is above.
struct ViewDirection {
  double azimuth = 35;    ///< around the up axis, degrees
  double elevation = 20;  ///< above the horizon, degrees
};

/// `name` is front, back, left, right, top, bottom or iso. Throws ArgumentError naming the view and the choices.
SANSMESH_API ViewDirection named_view(const std::string& name);

/// Viewing direction that faces a surface with the normal `direction` (any length but 0).
SANSMESH_API ViewDirection view_from(const Vec3& direction, UpAxis up);

/// Viewing direction perpendicular to a box that is a single layer: its width and height are at least 50 times its
/// thickness. Empty for other boxes.
SANSMESH_API std::optional<ViewDirection> view_of_layer(const Box3& box, UpAxis up);

/// `frames` (at least 1) directions at equal angles around the up axis, beginning with `view`.
SANSMESH_API std::vector<ViewDirection> turntable(const ViewDirection& view, int frames);

/// Camera, size and visible part of a picture.
struct SANSMESH_API PictureView {
  int width = 1280, height = 960;  ///< pixels, 1..16384
  ViewDirection direction = {};    ///< degrees; `named_view` returns the usual ones
  UpAxis up = UpAxis::y;           ///< axis that points up
  double field_of_view = 30;       ///< degrees over the shorter side, 1..120
  bool orthographic = false;       ///< parallel rays: apparent size does not depend on depth
  /// Point at the centre of the picture, in the coordinates of the scene; the viewing direction stays. Default: the
  /// centre of the scene.
  std::optional<Vec3> look_at = {};
  double zoom = 1;  ///< magnification relative to the picture that shows everything, 0.001..100000
  /// Instead of `zoom`: a ball of this radius around `look_at` fills the picture. > 0, in the unit of the scene.
  std::optional<double> look_radius = {};
  /// Only the part inside this box is shown, in the coordinates of the scene. (Mirrors and clear bodies still show the
  /// rest.)
  std::optional<Box3> clip_box = {};
  bool steady = false;  ///< the scale does not depend on the direction, so that the frames of a turntable match

  static const OptionSchema& schema();  ///< one row per field
};

/// Background of a picture.
struct Background {
  /// A gradient of light grays, one colour, or transparent pixels.
  enum class Kind : std::uint8_t { gradient, solid, transparent };
  Kind kind = Kind::gradient;  ///< which of them
  Vec3f color{1, 1, 1};        ///< sRGB 0..1, for `solid`

  /// One colour, sRGB 0..1.
  static Background solid(const Vec3f& color) { return {Kind::solid, color}; }
  /// Transparent pixels.
  static Background transparent() { return {Kind::transparent}; }
};

/// Colours, light and lines.
struct SANSMESH_API PictureLook {
  std::optional<Background> background = {};  ///< default: a gradient; for line drawings light gray
  Vec3f surface_color{0.87f, 0.84f, 0.80f};   ///< sRGB 0..1, for meshes without vertex colours
  bool use_colors = true;                     ///< use vertex colours if the mesh has them
  /// Edges of triangles as lines, over the shaded surface or alone. Alone, the surface is clear but still hides the
  /// lines behind it.
  enum class Wireframe : std::uint8_t { none, over, only };
  Wireframe wireframe = Wireframe::none;  ///< none: no edges
  double wire_width = 1;                  ///< pixels, 0.1..50
  Vec3f wire_color{0.10f, 0.12f, 0.15f};  ///< sRGB 0..1
  /// Silhouettes, borders, creases, ridges, valleys and suggestive contours, over the lit surface or alone. Alone, on
  /// white unless the background is transparent.
  enum class Lines : std::uint8_t { none, over, only };
  Lines lines = Lines::none;  ///< none: no lines
  double line_width = 1.5;    ///< pixels, 0.1..50
  double line_strength = 20;  ///< curvature times the scene's diagonal above which ridges are drawn, 0.1..1e6
  Vec3f line_color{0.08f, 0.08f, 0.10f};  ///< sRGB 0..1
  /// Accessibility shading instead of light: the unoccluded share of the sky, weighted by the cosine to the normal,
  /// times a factor for convex or concave curvature (Miller 1994). The value is the distance beyond which surfaces
  /// occlude nothing, as a share of the scene's diagonal, 1e-6..10.
  std::optional<double> accessibility = {};
  double curvature_shading = 0.3;  ///< largest deviation of the factor from 1, 0..1; 0: occlusion only
  /// In the coordinates of the scene. Null: no ridges, valleys and curvature shading. Jobs compute it if needed.
  std::shared_ptr<const CurvatureField> curvature = nullptr;
  bool smooth = true;   ///< interpolate normals over the triangles, except across creases
  bool shadows = true;  ///< cast by the key light on the surface itself
  bool ground = true;   ///< draw a shadow on the ground below
  /// Radius of points, in the unit of the cloud; default: from their spacing.
  std::optional<double> point_radius = {};

  /// The chosen background; default: a gradient.
  Background effective_background() const { return background.value_or(Background{}); }

  static const OptionSchema& schema();  ///< one row per field
};

/// Number of rays of a picture.
struct SANSMESH_API PictureQuality {
  int samples = 3;         ///< samples per pixel in each direction, 1..8
  int occlusion_rays = 1;  ///< rays towards the sky per sample, 0..64; 0: no occlusion

  static const OptionSchema& schema();  ///< one row per field
};

/// Text in a picture.
struct SANSMESH_API PictureAnnotation {
  /// Unit of the scale bar (may be empty): a bar of a round length in the lower left corner of orthographic pictures.
  std::optional<std::string> scale_bar = {};
  double input_length = 1;  ///< length of 1 in the coordinates of the scene, in the unit of the scale bar; > 0

  static const OptionSchema& schema();  ///< one row per field
};

/// Options of all pictures: `{.view = {.width = 800}, .look = {.ground = false}}`.
struct SANSMESH_API RenderOptions {
  PictureView view = {};              ///< camera and size
  PictureLook look = {};              ///< colours, light and lines
  PictureQuality quality = {};        ///< number of rays
  PictureAnnotation annotation = {};  ///< text in the picture

  static const OptionSchema& schema();  ///< one row per field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Converts the view's points and lengths from input coordinates to the local frame.
SANSMESH_API void move_from_input(RenderOptions& options, const LocalFrame& frame);

/// Options of pictures of surfaces without a mesh.
struct SANSMESH_API SurfaceRenderOptions {
  RenderOptions picture = {};  ///< as for meshes; `smooth` and `point_radius` are ignored
  /// Share of the light that a mirror would reflect, 0..1. Mirror rays are cast on the surface itself.
  double reflection = 0;
  /// Share of the light that is transmitted, 0..1: the surface bounds a clear body. reflection + transmission <= 1.
  double transmission = 0;
  /// Refraction index of the body relative to its surroundings, 1..4: 1.33 water, 1.5 glass. Fresnel reflection is
  /// added.
  double refraction_index = 1.5;
  /// Largest number of mirror and refraction rays in sequence, 1..16.
  int bounces = 4;
  /// Shadows are cast by the surface itself instead of discs around the samples: exact and slow.
  bool exact_shadows = false;
  /// For quick frames: no shadows, no occlusion, no ground, one sample per pixel, whatever the other options are.
  bool plain = false;
  /// Light that rays from mirrors and glass meet when they leave the scene: linear light (1 is white) from a unit
  /// direction. Default: the background in front, a bright sky elsewhere.
  std::function<Vec3f(const Vec3f& direction)> environment = {};

  /// The rows of these options, including those of `picture`.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Named viewing directions. The front view looks from +z if y is up and from −y if z is up.
enum class NamedView : std::uint8_t { front, back, left, right, top, bottom, iso };

/// Rectangle of a picture in pixels; `left` and `top` are its offset from the upper left corner.
struct PixelBox {
  int left = 0, top = 0, width = 0, height = 0;                        ///< pixels
  friend bool operator==(const PixelBox&, const PixelBox&) = default;  ///< equal in all fields
};

/// Part of a picture: a rectangle, or all that is not background.
struct PictureCrop {
  std::optional<PixelBox> box = {};                                          ///< none: all that is not background
  friend bool operator==(const PictureCrop&, const PictureCrop&) = default;  ///< equal in all fields
};
// As an option: "LEFT,TOP,WIDTH,HEIGHT" or "content".
SANSMESH_API std::string text_of_option(const PictureCrop& crop);
SANSMESH_API void option_of_text(std::string_view text, PictureCrop& crop);
/// Viewing direction and crop as options of the command line.
struct SANSMESH_API ViewOptions {
  std::optional<NamedView> view = {};    ///< a named direction
  std::optional<double> azimuth = {};    ///< not with `view`; default: as in RenderOptions
  std::optional<double> elevation = {};  ///< the same
  bool z_up = false;                     ///< the z axis points up, not y
  std::optional<PictureCrop> crop = {};  ///< the part to keep

  static const OptionSchema& schema();  ///< one row per field
  /// Whether a direction was chosen.
  bool has_direction() const { return view || azimuth || elevation; }
  /// The options with this view applied. Throws ArgumentError if the crop is not inside the picture.
  RenderOptions applied_to(RenderOptions options) const;
  /// Throws ArgumentError if several pictures would differ in size.
  void check_frames(bool several) const;
  /// Crops a picture that was made with these options. Throws ArgumentError if the crop is not inside the picture.
  Image part_of(const Image& image, const RenderOptions& made_with) const;
};

/// Streaks along a flow.
struct SANSMESH_API FlowTextureOptions {
  double streak_length = 40;     ///< pixels, 1..1000 (on surfaces that face the viewer)
  double streak_width = 1.5;     ///< pixels, 0.5..100
  double streak_contrast = 0.4;  ///< 0..1
  /// Waves run along the streaks with the flow: one period as this increases from 0 to 1. Default: none.
  std::optional<double> phase = {};

  /// One row per field except `phase`.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Statistics of ray casting on surfaces without a mesh.
struct SANSMESH_API CastCounts {
  std::uint64_t rays = 0, hits = 0;    ///< all rays, and those that met the surface
  std::uint64_t hit_evaluations = 0;   ///< evaluations of the field or projection for rays that hit
  std::uint64_t miss_evaluations = 0;  ///< the same for rays that missed
  std::uint64_t ball_queries = 0;      ///< queries for balls along a ray

  static const ReportSchema& schema();  ///< one row per value
};

/// Perspective picture of a mesh, framed to fill the picture. Meshes without triangles are clouds: discs if they have
/// normals, else balls. Non-finite vertices are left out. The picture does not depend on the number of threads. Throws
/// DataError if nothing is visible, ArgumentError for bad options.
SANSMESH_API Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options, Progress& progress);
/// The same without progress.
SANSMESH_API Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options = {});

/// Receives each picture when it is complete, from frame 0 on; `made_with` are its options.
using UsePicture = std::function<void(std::size_t frame, const Image& image, const RenderOptions& made_with)>;

/// A surface that can be added to a picture, made by scene_factory(). It owns its data and prepares a scene for
/// the frame and camera of a picture; both types are private to the library.
using SceneFactory = std::function<std::unique_ptr<PictureScene>(const PictureFrame& frame, const Camera& camera)>;

/// A mesh, or a cloud as discs or balls. Copies the mesh. Throws DataError if there is nothing to draw.
SANSMESH_API SceneFactory scene_factory(const TriangleMesh& mesh, const RenderOptions& options);
/// A translucent version of a surface, with all sheets visible: `opacity` 0..1 is the share of light that a sheet
/// blocks where it faces the viewer. `apart`: sheets closer together than this, in the coordinates of the scene, count
/// as one; default: the resolution of floats.
SANSMESH_API SceneFactory translucent(SceneFactory surface, double opacity, double apart = 0);

}  // namespace sansmesh::inline v1
