#include "sansmesh/flow_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <tuple>
#include <utility>

#include "sansmesh/core/median.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/flow/flow_model.h"
#include "sansmesh/jobs/pictures/color_bar.h"
#include "sansmesh/jobs/volumes/volume_subject.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/mesh/edit/arrows.h"
#include "sansmesh/render/annotate/picture_notes.h"
#include "sansmesh/render/scene/flow_texture.h"
#include "sansmesh/render/surface/picture_surfaces.h"
#include "sansmesh/render/volume/transfer_presets.h"
#include "sansmesh/render/volume/volume_picture.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kDark = 0.45;          // dark part of the range that is not used for colours
constexpr double kScaleEnd = 0.01;      // share of the particles clipped at each end of the colour scale
constexpr double kMostTurn = 3600;      // degrees
constexpr double kArrowSpacing = 0.06;  // share of the surface's diagonal
constexpr double kArrowLength = 0.7;    // share of their distance
constexpr Vec3f kArrowColor{0.13f, 0.12f, 0.12f};

/// Array of the colours, if it is one. Throws ArgumentError.
std::optional<ArrayChoice> color_array(const FlowModel& flow, const std::string& by) {
  if (by == "time" || by == "speed" || by == "seed" || by == "none") return std::nullopt;
  if (!flow.volume()) throw ArgumentError("`color_by` an array needs a steady flow of a file");
  return flow.volume()->scalar_choice(by, "color_by");
}

/// Ends of the scale without rare values, which would compress all other colours.
std::pair<double, double> scale_ends(std::vector<double> values) {
  const double lower = quantile(values, kScaleEnd), upper = quantile(values, 1 - kScaleEnd);
  return lower < upper ? std::pair(lower, upper) : std::pair(quantile(values, 0), quantile(values, 1));
}

/// Colours of the preset "flow" without the darkest, on which shading and streaks would be invisible.
TransferFunction light_colors(const ValueHistogram& values) {
  TransferFunction colors = transfer_function_preset("flow", values);
  const auto [lower, upper] = colors.range();
  const TransferFunction wide = colors.over(lower - kDark * (upper - lower), upper);
  for (ColorPoint& p : colors.colors) p.color = wide.color(p.value);
  return colors;
}

/// Arrows along the flow, half sunk into the surface, so that both sides show them.
TriangleMesh arrows_on(const FlowSurface& surface, double spacing) {
  const double size = bounds(surface.mesh).diagonal();
  if (spacing > size)
    throw ArgumentError(fmt::format("`arrows = {:g}` is more than the surface's diagonal, {:.6g}", spacing, size));
  if (spacing == 0) spacing = kArrowSpacing * size;
  std::vector<Vec3> positions, vectors;
  for (const std::uint32_t v : spread_vertices(surface.mesh, spacing)) {
    const FlowPoint& p = surface.points[v];
    vectors.push_back(p.velocity);
    positions.push_back(p.position - normalized(p.velocity) * (0.5 * kArrowLength * spacing));
  }
  ArrowOptions options;
  options.length = kArrowLength * spacing;
  return arrows(positions, vectors, options);
}

/// Volume rendered around the surface, with iso-surfaces.
class VolumeAround {
 public:
  VolumeAround(const FlowPictureOptions& o, const VolumeModel& volume, const std::string& vectors,
               std::vector<Note>& notes, Progress& progress)
      : samples_(volume.samples(progress)) {
    // As a scalar, vectors are represented by their length, the speed.
    const std::string name = o.volume_array.empty() ? vectors : o.volume_array;
    field_ = volume.field(volume.scalar_choice(name, "volume_array"), progress, notes);
    options_.color_title = name;
    options_.color_bar = o.bar && !o.volume_array.empty() && o.opacity_factor > 0;
    options_.opacity_factor = o.volume_array.empty() ? 0 : o.opacity_factor;
    options_.isos = o.isos;
    options_.validate();
    VolumeSubject subject = volume_subject(*samples_, boundary_);
    subject.field = field_.get();
    subject.image = false;
    with_name(volume.name(), [&] { picture_.emplace(std::move(subject), progress); });
    const ValueHistogram& values = picture_->histogram();
    options_.transfer = o.preset.empty() ? suggest_transfer_function(values, false).function
                                         : transfer_function_preset(o.preset, values);
  }
  Image render(const RenderOptions& picture, std::vector<SceneFactory> surfaces, Progress& progress) {
    options_.picture = picture;
    picture_->set_surfaces(std::move(surfaces));
    return picture_->render(options_, progress);
  }
  /// Width of its colour bar in pixels.
  int bar_width(int height) const {
    return options_.color_bar ? color_bar_width(height, *options_.transfer, options_.color_title) : 0;
  }

 private:
  std::shared_ptr<const SampledVolume> samples_;
  std::shared_ptr<const VolumeField> field_;
  TriangleMesh boundary_;
  VolumePictureOptions options_;
  std::optional<VolumePicture> picture_;
};

/// Data that the pictures of one surface share.
class SurfacePictures {
 public:
  SurfacePictures(const FlowModel& flow, const FlowPictureOptions& options, Progress& progress)
      : flow_(flow), options_(options), picture_(options.picture), progress_(progress) {
    const std::optional<ArrayChoice> color = color_array(flow, options.color_by);
    if (options.in_volume())
      around_ = std::make_unique<VolumeAround>(options, *flow.volume(), flow.vectors(), result_.notes, progress);
    TraceSurfaceResult traced = trace_surface(flow, options.trace, progress);
    for (Note& note : traced.notes) result_.notes.push_back(std::move(note));
    surface_ = std::move(traced.surface);
    if (surface_.mesh.triangles.empty()) throw in_flow(flow, DataError("the surface is empty"));
    result_.surface = surface_.report;
    Box3 box;
    for (const FlowPoint& p : surface_.points) points_.push_back(p.position), box.extend(p.position);
    if (options.default_view)
      if (const auto view = view_of_layer(box, picture_.view.up)) picture_.view.direction = *view;
    color_surface(color);
    result_.width = picture_.view.width, result_.height = picture_.view.height;
    const int height = picture_.view.height;
    reserve_width(picture_, (bar_ ? bar_->width(height) : 0) + (around_ ? around_->bar_width(height) : 0),
                  "colour bars", "bar");
    sheet_ = std::make_unique<DrawnFlow>(std::move(subject_), picture_);
  }

  void draw_beside(std::vector<SceneFactory> beside) {
    beside_ = std::move(beside);
    if (!options_.arrows) return;
    RenderOptions dark = picture_;
    dark.look.surface_color = kArrowColor;
    beside_.push_back(scene_factory(arrows_on(surface_, *options_.arrows), dark));
  }

  Image at(int frame) {
    const double share = options_.frames ? static_cast<double>(frame) / *options_.frames : 0;
    RenderOptions picture = picture_;
    picture.view.direction.azimuth += std::remainder(options_.turn * share, 360);
    FlowLook of_surface{.texture = std::nullopt, .opacity = options_.opacity, .splats = options_.splats};
    if (options_.textured) of_surface.texture = options_.streaks;
    if (of_surface.texture && options_.frames) of_surface.texture->phase = share;
    std::vector<SceneFactory> surfaces = beside_;
    surfaces.push_back(sheet_->surface(of_surface));
    picture.view.steady = options_.turn != 0;
    Image image = around_ ? around_->render(picture, std::move(surfaces), progress_)
                          : render_surfaces(surfaces, points_, options_.opacity < 1, picture, progress_);
    if (!options_.title.empty()) draw_title(image, options_.title);
    return beside_bar(image, bar_, picture);
  }

  const RenderOptions& picture() const { return picture_; }
  FlowPicturesResult result() { return std::move(result_); }

 private:
  /// Values of the colours; empty without.
  std::vector<double> color_values(const std::optional<ArrayChoice>& array) {
    const std::string& by = options_.color_by;
    std::vector<double> values;
    if (by == "none") return values;
    values.resize(surface_.points.size());
    if (array) {
      flow_.volume()->field(*array, progress_, result_.notes)->query({.points = points_}, {.values = values});
      return values;
    }
    std::transform(surface_.points.begin(), surface_.points.end(), values.begin(), [&](const FlowPoint& p) {
      return by == "time" ? p.t : by == "seed" ? p.s : norm(p.velocity);
    });
    return values;
  }

  void color_surface(const std::optional<ArrayChoice>& array) {
    const std::string& by = options_.color_by;
    subject_ = {surface_.mesh, {}, {}};
    double fastest = 0;
    for (const FlowPoint& p : surface_.points) fastest = std::max(fastest, norm(p.velocity));
    for (const FlowPoint& p : surface_.points) {
      subject_.vectors.push_back(fastest > 0 ? Vec3f(p.velocity / fastest) : Vec3f{});
      subject_.fronts.push_back(p.front);
    }
    const std::vector<double> values = color_values(array);
    subject_.mesh.colors.clear();
    if (values.empty()) return;
    ValueHistogram histogram = value_histogram(values);
    if (by != "time" && by != "seed") {
      std::tie(histogram.lower, histogram.upper) = scale_ends(values);
      histogram.least = std::max(histogram.least, histogram.lower);
      histogram.most = std::min(histogram.most, histogram.upper);
    }
    const bool signs = histogram.least < 0 && histogram.most > 0 && by != "time";
    const TransferFunction colors = signs ? transfer_function_preset("diverging", histogram) : light_colors(histogram);
    for (const double v : values) subject_.mesh.colors.push_back(to_bytes(colors.color(v)));
    if (options_.bar) bar_ = {colors, with_unit(options_.label.empty() ? by : options_.label, options_.unit)};
  }

  const FlowModel& flow_;
  const FlowPictureOptions& options_;
  RenderOptions picture_;
  Progress& progress_;
  std::unique_ptr<VolumeAround> around_;
  FlowSurface surface_;
  std::vector<Vec3> points_;
  FlowSubject subject_;
  std::optional<ColorBar> bar_;
  std::vector<SceneFactory> beside_;
  std::unique_ptr<DrawnFlow> sheet_;
  FlowPicturesResult result_;
};

}  // namespace

const OptionSchema& FlowPictureOptions::schema() {
  using O = FlowPictureOptions;
  static const OptionRow rows[] = {
      option_group<&O::picture>(RenderOptions::schema().rows),
      option_group<&O::trace>(TraceSurfaceOptions::schema().rows),
      option<&O::textured>(
          {.text = "Omit streaks along the flow (line integral convolution)", .name = "streaks", .old_name = "smooth"}),
      option_group<&O::streaks>(FlowTextureOptions::schema().rows),
      option<&O::splats>({.text = "Draw particles as blended discs instead of the mesh"}),
      option<&O::opacity>({.text = "Opacity of the surface seen perpendicularly", .unit = "share", .range = {0, 1}}),
      option<&O::arrows>({.text = "Draw arrows along the flow at this distance (`arrows`=0.1); 0: from the surface's "
                                  "size",
                          .unit = "length",
                          .range = at_least(0),
                          .implied = "0"}),
      option<&O::color_by>(
          {.text = "Quantity: time, speed, seed (position on the curve), none, or another array", .unit = "name"}),
      option<&O::frames>({.text = "Number of pictures, NAME_000.png, …, in which the streaks move with the flow",
                          .range = {2, 100000}}),
      option<&O::turn>({.text = "With `frames`: total rotation of the view",
                        .unit = "degrees",
                        .range = {-kMostTurn, kMostTurn},
                        .needs = "frames"}),
      option<&O::volume_array>(
          {.text = "Array rendered as a volume around the surface", .unit = "name", .old_name = "volume"}),
      option<&O::preset>({.text = "Colours and opacities of the volume",
                          .unit = "name",
                          .needs = "volume_array",
                          .suggestions = transfer_function_presets(),
                          .old_name = "volume_preset"}),
      option<&O::opacity_factor>({.text = "Factor of the volume's opacity",
                                  .unit = "factor",
                                  .range = {0, 1000},
                                  .needs = "volume_array",
                                  .old_name = "volume_opacity"}),
      option<&O::isos>({.text = "Iso-surface of that array (or of the speed): V, V:#rrggbb, "
                                "V:#rrggbb:OPACITY; may be repeated",
                        .unit = "value",
                        .name = "iso"}),
      option<&O::bar>({.text = "Omit the colour bar"}),
      option<&O::label>({.text = "Label of the colour bar", .from_data = "that of `color_by`"}),
      option<&O::unit>({.text = "Unit at the colour bar", .unit = "unit"}),
      option<&O::title>({.text = "Title above the picture"})};
  return option_schema<rows>();
}

void FlowPictureOptions::validate() const {
  trace.validate();
  static const FlowPictureOptions defaults{};  // g++ 12 warns that a local one is uninitialized
  validate_options(schema(), this, &defaults);
  picture.validate();
  if (const auto known = transfer_function_presets();
      !preset.empty() && std::find(known.begin(), known.end(), preset) == known.end())
    throw ArgumentError(ArgumentFault{.field = "preset",
                                      .value = "'" + printable(preset, 60) + "'",
                                      .allowed = fmt::format("one of {}", fmt::join(known, ", "))});
  if (!textured && !options_set(streaks).empty())
    throw ArgumentError(fmt::format("`{}` needs `streaks`", options_set(streaks)[0]));
  if (frames && !textured && turn == 0)
    throw ArgumentError("`frames` moves streaks: with `streaks = false` it needs `turn`");
  if ((!label.empty() || !unit.empty()) && (!bar || color_by == "none"))
    throw ArgumentError("`label` and `unit` are for the colour bar: not with `bar = false` or `color_by = none`");
}

void check_colors(const FlowModel& flow, const FlowPictureOptions& options) {
  if (options.in_volume() && !flow.volume())
    throw ArgumentError("`volume_array` and `iso` need a flow of a file, and a steady one");
  color_array(flow, options.color_by);
}

FlowPicturesResult flow_pictures(const FlowModel& flow, const FlowPictureOptions& options,
                                 std::vector<SceneFactory> beside, const UsePicture& use, Progress& progress) {
  options.validate();
  check_colors(flow, options);
  SurfacePictures pictures(flow, options, progress);
  pictures.draw_beside(std::move(beside));
  for (int k = 0; k < options.frames.value_or(1); ++k) {
    const Image image = [&] {
      try {
        return pictures.at(k);
      } catch (const DataError& error) {
        throw in_flow(flow, error);
      }
    }();
    use(static_cast<std::size_t>(k), image, pictures.picture());
  }
  return pictures.result();
}

const ReportSchema& FlowPicturesResult::schema() {
  static constexpr ReportRow rows[] = {reported<&FlowPicturesResult::surface>({.text = "Traced surface"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
