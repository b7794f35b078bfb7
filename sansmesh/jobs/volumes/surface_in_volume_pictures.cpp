#include "sansmesh/volume_pictures.h"

#include <algorithm>
#include <span>
#include <utility>

#include "sansmesh/dataset/volume_surface.h"
#include "sansmesh/error.h"
#include "sansmesh/isosurfaces.h"
#include "sansmesh/jobs/pictures/color_bar.h"
#include "sansmesh/jobs/pictures/turntable.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/render/annotate/picture_notes.h"
#include "sansmesh/render/surface/surface_caster.h"
#include "sansmesh/render/surface/surface_picture.h"
#include "sansmesh/render/volume/transfer_presets.h"
#include "sansmesh/surface/bilateral_normals.h"
#include "sansmesh/surface/curvature_colors.h"
#include "sansmesh/surface/curvature_words.h"
#include "sansmesh/volumes.h"

namespace sansmesh::inline v1 {
namespace {

/// Colours by another array of the volume; positions in coordinates of the surface.
class ArrayColors : public ColorField {
 public:
  /// The colours span the range of the array at the points `seen`.
  ArrayColors(std::shared_ptr<const VolumeField> field, const LocalFrame& frame, std::span<const Vec3> seen)
      : field_(std::move(field)), frame_(frame) {
    const std::vector<double> there = values(seen);
    colors_ = transfer_function_preset("flow", value_histogram(there));
    const auto [lower, upper] = colors_.range();
    for (const double v : there) ends_.below = ends_.below || v < lower, ends_.above = ends_.above || v > upper;
  }
  const TransferFunction& colors() const { return colors_; }
  BarEnds ends() const { return ends_; }
  void evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const override {
    const std::vector<double> v = values(x);
    for (std::size_t i = 0; i < x.size(); ++i) colors[i] = colors_.color(v[i]);
  }

 private:
  std::vector<double> values(std::span<const Vec3> x) const {
    std::vector<Vec3> input(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) input[i] = frame_.to_input(x[i]);
    std::vector<double> v(x.size());
    field_->query({.points = input}, {.values = v});
    return v;
  }

  std::shared_ptr<const VolumeField> field_;
  LocalFrame frame_;
  TransferFunction colors_;
  BarEnds ends_;
};

}  // namespace

struct SurfaceInVolumePictures::State {
  std::shared_ptr<const VolumeSurface> surface;
  std::unique_ptr<ColorField> colors;
  std::optional<ShownColors> shown;
  std::optional<BilateralNormals> normals;
  std::optional<SurfaceCaster> caster;
};

const OptionSchema& SurfaceInVolumeLook::schema() {
  using O = SurfaceInVolumeLook;
  static constexpr OptionRow rows[] = {
      option<&O::color_by>({.text = "Array of the volume, or curvature: mean, gaussian, k1, k2", .unit = "name"}),
      option<&O::color_range>({.text = "Curvature with the full colour, 1/length or, for gaussian, 1/length²",
                               .unit = "value",
                               .from_data = "from data",
                               .range = positive(),
                               .needs = "color_by"}),
      option<&O::sharp>({.text = "Draw sharp edges and corners"}),
      option<&O::quick>({.text = "Use one ray per pixel and no shadows"}),
      option<&O::frames>(kTurntable),
      option<&O::bar>({.text = "Omit the colour bar", .needs = "color_by"}),
      option<&O::unit>({.text = "Unit at the colour bar: of the array, or of lengths in curvatures",
                        .unit = "unit",
                        .needs = "color_by"})};
  return option_schema<rows>();
}

std::optional<CurvatureQuantity> SurfaceInVolumeLook::curvature() const {
  const auto* const word = std::find(std::begin(kCurvatureWords), std::end(kCurvatureWords), color_by);
  if (word == std::end(kCurvatureWords)) return std::nullopt;
  return static_cast<CurvatureQuantity>(word - std::begin(kCurvatureWords));
}

void SurfaceInVolumeLook::validate() const {
  validate_options(*this);
  if (color_range && !curvature()) throw ArgumentError("`color_range` needs `color_by` with a curvature");
}

SurfaceInVolumePictures::SurfaceInVolumePictures(const SurfaceInVolume& of, const VolumeModel& volume,
                                                 const SurfaceInVolumeLook& look, Progress& progress,
                                                 std::vector<Note>& notes)
    : state_(std::make_unique<State>(State{of.surface, {}, {}, {}, {}})) {
  look.validate();
  State& s = *state_;
  const LocalFrame& frame = of.surface->frame();
  PointSet points;
  if (!look.color_by.empty() || look.sharp) points = of.surface->feet();
  if (const auto quantity = look.curvature()) {
    // Curvatures of the input (1/length or 1/length²) in coordinates of the surface.
    const double unit = *quantity == CurvatureQuantity::gaussian ? frame.unit * frame.unit : frame.unit;
    CurvatureColorOptions o;
    o.quantity = *quantity;
    if (look.color_range) o.range = *look.color_range * unit;
    auto colors = with_name(volume.name(), [&] { return std::make_unique<CurvatureColors>(points, o, progress); });
    s.shown =
        ShownColors{.array = {}, .curvature = quantity, .range = colors->range() / unit, .colors = {}, .ends = {}};
    s.colors = std::move(colors);
  } else if (!look.color_by.empty()) {
    auto field = volume.field(volume.scalar_choice(look.color_by, "color_by"), progress, notes);
    const std::vector<Vec3> seen(points.positions.begin(), points.positions.end());
    auto colors = std::make_unique<ArrayColors>(std::move(field), frame, seen);
    s.shown = ShownColors{
        .array = look.color_by, .curvature = {}, .range = 0, .colors = colors->colors(), .ends = colors->ends()};
    s.colors = std::move(colors);
  }
  SurfaceCastOptions cast;
  if (look.sharp) {
    s.normals.emplace(prepare_samples(points, progress), BilateralOptions{});
    cast.normals = &*s.normals;
  }
  with_name(volume.name(), [&] { s.caster.emplace(of.surface->field(), of.surface->balls(), cast); });
}

SurfaceInVolumePictures::~SurfaceInVolumePictures() = default;
SurfaceInVolumePictures::SurfaceInVolumePictures(SurfaceInVolumePictures&&) noexcept = default;

const std::optional<ShownColors>& SurfaceInVolumePictures::colors() const { return state_->shown; }

Image SurfaceInVolumePictures::render(const SurfaceRenderOptions& options, Progress& progress) const {
  options.validate();
  const State& s = *state_;
  SurfaceRenderOptions own = options;
  move_from_input(own.picture, s.surface->frame());
  return render_surface(*s.caster, s.surface->balls().centers, s.colors.get(), own, progress);
}

CastCounts SurfaceInVolumePictures::counts() const { return state_->caster->counts(); }

namespace {

/// Colour bar beside the pictures.
std::optional<ColorBar> bar_beside(const SurfaceInVolumeLook& look, const std::optional<ShownColors>& shown) {
  if (!shown || !look.bar) return std::nullopt;
  if (shown->curvature) return curvature_bar(*shown->curvature, shown->range, look.unit, true);
  return ColorBar{shown->colors, with_unit(shown->array, look.unit), shown->ends};
}

}  // namespace

DrawnSurfaceInVolume draw_surface_in_volume(const SurfaceInVolume& surface, const VolumeModel& volume,
                                            const SurfaceInVolumeLook& look, const RenderOptions& picture,
                                            const UsePicture& use, Progress& progress) {
  SurfaceRenderOptions options;
  options.picture = picture;
  options.plain = look.quick, options.picture.view.steady = look.frames.has_value();
  options.validate();
  DrawnSurfaceInVolume drawn;
  const SurfaceInVolumePictures pictures(surface, volume, look, progress, drawn.notes);
  drawn.colors = pictures.colors();
  const std::optional<ColorBar> bar = bar_beside(look, drawn.colors);
  reserve_width(options.picture, bar);
  draw_turntable(options.picture, look.frames, use, [&](const RenderOptions& one) {
    options.picture = one;
    return beside_bar(pictures.render(options, progress), bar, one);
  });
  drawn.rays = pictures.counts();
  return drawn;
}

const ReportSchema& ShownColors::schema() {
  static constexpr ReportRow rows[] = {
      reported<&ShownColors::array>({.text = "Array shown by colours"}),
      reported<[](const ShownColors& r) { return r.colors.range().first; }>(
          {.name = "lower", .text = "Value of the first colour", .unit = "unit of the array"}),
      reported<[](const ShownColors& r) { return r.colors.range().second; }>(
          {.name = "upper", .text = "Value of the last colour", .unit = "unit of the array"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
