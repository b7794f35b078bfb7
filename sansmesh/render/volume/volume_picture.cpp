#include "sansmesh/render/volume/volume_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <utility>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/render/annotate/picture_notes.h"
#include "sansmesh/render/scene/color_space.h"
#include "sansmesh/render/scene/lighting.h"
#include "sansmesh/render/scene/painter.h"
#include "sansmesh/render/scene/pixel.h"
#include "sansmesh/render/volume/baked_volume.h"
#include "sansmesh/render/volume/pixel_means.h"
#include "sansmesh/render/volume/transfer_presets.h"
#include "sansmesh/render/volume/value_histogram.h"
#include "sansmesh/render/volume/volume_cells.h"
#include "sansmesh/render/volume/volume_intervals.h"
#include "sansmesh/render/volume/volume_tracer.h"

namespace sansmesh::inline v1 {
namespace {

using LightMap = PixelMap<std::array<float, 4>>;

constexpr int kVolumeTile = 32;
constexpr int kCheckEvery = 16;  // one pixel is checked per square of this side
constexpr std::size_t kHistogramPoints = 60000;

/// Adds the ray through a point in pixels.
void add_ray(CameraRays& rays, const VolumePictureOptions& options, float x, float y) {
  rays.add(2 * x / static_cast<float>(options.picture.view.width) - 1,
           1 - 2 * y / static_cast<float>(options.picture.view.height));
}

/// Adds the visible box as cuts to the options of a volume with bounds `box`; faces that coincide with these bounds
/// need no cut.
VolumePictureOptions with_box_cut(VolumePictureOptions options, const Box3& box) {
  if (!options.picture.view.clip_box) return options;
  const double same = 1e-6 * box.diagonal();
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3 axis{};
    axis[k] = 1;
    if (options.picture.view.clip_box->upper[k] < box.upper[k] - same)
      options.clips.push_back({axis, options.picture.view.clip_box->upper[k]});
    if (options.picture.view.clip_box->lower[k] > box.lower[k] + same)
      options.clips.push_back({-axis, -options.picture.view.clip_box->lower[k]});
  }
  return options;
}

/// The colour of a ray on white, as displayed.
Vec3f on_white(const TracedLight& l) {
  return srgb_color(Vec3f{std::min(1.0f, l.light.x + l.left), std::min(1.0f, l.light.y + l.left),
                          std::min(1.0f, l.light.z + l.left)});
}

/// The background behind the volume as a picture.
Image behind(const VolumePictureOptions& options) {
  Image image(options.picture.view.width, options.picture.view.height, Rgba{0, 0, 0, 0});
  if (options.picture.look.effective_background().kind == Background::Kind::transparent) return image;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const float fx = (static_cast<float>(x) + 0.5f) / static_cast<float>(options.picture.view.width);
      const float fy = (static_cast<float>(y) + 0.5f) / static_cast<float>(options.picture.view.height);
      const Vec3f c = srgb_color(background_light(options.picture, fx, fy));
      image.at(x, y) = {c.x, c.y, c.z, 1};
    }
  return image;
}

/// Light over a background, as a colour with straight alpha.
Rgba in_front(const std::array<float, 4>& p, const Rgba& back) {
  const Vec3f light = Vec3f{p[0], p[1], p[2]} + linear_color({back[0], back[1], back[2]}) * (p[3] * back[3]);
  const float alpha = 1 - p[3] * (1 - back[3]);
  const Vec3f c = alpha > 0 ? srgb_color(light / alpha) : Vec3f{};
  return {c.x, c.y, c.z, std::max(0.0f, alpha)};
}

}  // namespace

class VolumePicture::Work {
 public:
  Work(VolumeSubject subject, Progress& progress)
      : subject_(std::move(subject)),
        frame_(framed()),
        cells_(*subject_.field, subject_.opacity, progress),
        intervals_(*subject_.field, subject_.boundary, frame_) {}

  Camera camera(const VolumePictureOptions& options) const { return picture_camera(outline_, frame_, options.picture); }

  SuggestedTransferFunction transfer(const VolumePictureOptions& options) const {
    if (options.transfer) return {*options.transfer, {}};
    const auto of = [&](const ValueHistogram& values) {
      return options.preset.empty() ? suggest_transfer_function(values, subject_.image)
                                    : SuggestedTransferFunction{transfer_function_preset(options.preset, values), {}};
    };
    SuggestedTransferFunction found = of(histogram());
    if (subject_.opacity) found.function.opacities = of(opacity_histogram()).function.opacities;
    return found;
  }

  LightMap light(const Camera& camera, const VolumePictureOptions& given, Progress& progress,
                 VolumePictureReport* report, bool check) const {
    given.validate();
    const VolumePictureOptions options = with_box_cut(given, box_);
    const SuggestedTransferFunction chosen = transfer(options);
    std::vector<std::unique_ptr<PictureScene>> scenes;
    TracedVolume volume = traced();
    for (const SceneFactory& surface : subject_.surfaces) {
      scenes.push_back(surface(frame_, camera));
      volume.surfaces.push_back(scenes.back().get());
    }
    std::vector<std::unique_ptr<ClippedScene>> parts;
    for (std::size_t k = 0; options.picture.view.clip_box && k < scenes.size(); ++k) {
      const Box3f box{frame_.to_picture(options.picture.view.clip_box->lower),
                      frame_.to_picture(options.picture.view.clip_box->upper)};
      parts.push_back(std::make_unique<ClippedScene>(*scenes[k], box));
      volume.surfaces[k] = parts.back().get();
    }
    const VolumeTracer tracer(volume, camera, chosen.function, options);
    LightMap map(options.picture.view.width, options.picture.view.height);
    VolumePictureReport own;
    draw(tracer, camera, options, map, progress, own);
    if (check) check_steps(tracer, volume, camera, chosen.function, options, own);
    if (report) {
      own.transfer = chosen.function, own.why = chosen.why;
      own.notes = notes(options);
      *report = own;
    }
    return map;
  }

  void set_surfaces(std::vector<SceneFactory> surfaces) { subject_.surfaces = std::move(surfaces); }
  const Box3& box() const { return box_; }
  const PictureFrame& frame() const { return frame_; }
  /// Computed on first use: not needed if colours are given.
  const ValueHistogram& histogram() const {
    std::call_once(histogram_once_, [&] { histogram_ = histogram_of(*subject_.field, subject_.values); });
    return histogram_;
  }

 private:
  const ValueHistogram& opacity_histogram() const {
    std::call_once(opacity_once_, [&] { opacity_histogram_ = histogram_of(*subject_.opacity, {}); });
    return opacity_histogram_;
  }

  ValueHistogram histogram_of(const VolumeField& field, const std::optional<ValueRange>& held) const {
    const TriangleMesh* mesh = subject_.boundary;
    if (!subject_.samples.empty() || !mesh) return value_histogram(field, kHistogramPoints, subject_.samples, held);
    std::vector<Vec3> vertices;
    vertices.reserve(mesh->vertices.size());
    for (const Vec3f& p : mesh->vertices) vertices.push_back(mesh->origin + Vec3(p));
    return value_histogram(field, kHistogramPoints, vertices, held);
  }

  std::vector<std::string> notes(const VolumePictureOptions& options) const {
    std::vector<std::string> found;
    for (const IsoSurface& iso : options.isos)
      if (iso.value < histogram().least || iso.value > histogram().most)
        found.push_back(
            fmt::format("the iso-surface of {:g} may be empty: values found in the volume are between {:g} and {:g}",
                        iso.value, histogram().least, histogram().most));
    for (const bool opacity : {false, true}) {
      const auto* baked = dynamic_cast<const BakedVolume*>(opacity ? subject_.opacity : subject_.field);
      if (!baked || baked->report().finished) continue;
      found.push_back(fmt::format(
          "the baked field{} is coarser than requested: its error is {:.3g} % of its range on average, {:.3g} % at "
          "most at the tested points",
          opacity ? " of the opacities" : "", 100 * baked->report().error_mean, 100 * baked->report().error_most));
    }
    return found;
  }

  TracedVolume traced() const {
    TracedVolume volume;
    volume.field = subject_.field, volume.opacity = subject_.opacity, volume.gap = subject_.gap;
    volume.bounded = subject_.boundary && !subject_.boundary->triangles.empty();
    volume.intervals = &intervals_, volume.cells = &cells_, volume.frame = frame_;
    return volume;
  }

  /// Checks the subject and returns the frame of the picture.
  PictureFrame framed() {
    if (!subject_.field) throw ArgumentError("a picture needs a field");
    if (subject_.field->components() != 1 || (subject_.opacity && subject_.opacity->components() != 1))
      throw ArgumentError("pictures need a field of one component: choose a component, or the length");
    Box3& box = box_;
    const TriangleMesh* mesh = subject_.boundary;
    if (mesh && !mesh->triangles.empty()) {
      for (const Vec3f& p : mesh->vertices) box.extend(mesh->origin + Vec3(p));
    } else {
      box = subject_.field->bounds();
    }
    if (box.empty() || !is_finite(box.lower) || !is_finite(box.upper) || !(box.diagonal() > 0))
      throw DataError("nothing to draw: the volume has no extent");
    const PictureFrame frame{box.center(), box.diagonal()};
    for (const Vec3& p : subject_.framed)
      if (is_finite(p)) outline_.push_back(frame.to_picture(p));
    if (!outline_.empty()) return frame;
    if (mesh && !mesh->triangles.empty()) {
      for (const Vec3f& p : mesh->vertices) outline_.push_back(frame.to_picture(mesh->origin + Vec3(p)));
    } else {
      for (int c = 0; c < 8; ++c) outline_.push_back(frame.to_picture(box_corner(box, c)));
    }
    return frame;
  }

  /// Mean light of all pixels.
  static void draw(const VolumeTracer& tracer, const Camera& camera, const VolumePictureOptions& options, LightMap& map,
                   Progress& progress, VolumePictureReport& report) {
    const int across = (map.width + kVolumeTile - 1) / kVolumeTile, down = (map.height + kVolumeTile - 1) / kVolumeTile;
    const auto tiles = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
    std::atomic<std::uint64_t> evaluations{0}, rays{0};
    progress.begin("rendering", tiles);
    parallel_for(0, tiles, 1, [&](std::size_t tile) {
      const int left = static_cast<int>(tile) % across * kVolumeTile,
                top = static_cast<int>(tile) / across * kVolumeTile;
      const PixelTile pixels{left, top, std::min(left + kVolumeTile, map.width),
                             std::min(top + kVolumeTile, map.height)};
      const auto trace = [&](std::span<const std::array<float, 2>> points, std::span<TracedLight> lights) {
        CameraRays going(camera);
        for (const auto& [x, y] : points) add_ray(going, options, x, y);
        evaluations += tracer.trace(going.rays(), lights);
      };
      rays += pixel_means(pixels, {options.picture.quality.samples, options.pixel_error}, trace, map);
      progress.advance();
    });
    progress.finish();
    report.rays = rays, report.evaluations = evaluations;
  }

  static void check_steps(const VolumeTracer& whole, const TracedVolume& volume, const Camera& camera,
                          const TransferFunction& transfer, const VolumePictureOptions& options,
                          VolumePictureReport& report) {
    VolumePictureOptions halved = options;
    halved.step = 0.5 * options.step;
    const VolumeTracer tracer(volume, camera, transfer, halved);
    CameraRays going(camera);
    for (int y = kCheckEvery / 2; y < options.picture.view.height; y += kCheckEvery)
      for (int x = kCheckEvery / 2; x < options.picture.view.width; x += kCheckEvery)
        add_ray(going, options, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    if (going.size() == 0) return;
    std::vector<TracedLight> before(going.size()), lights(going.size());
    whole.trace(going.rays(), before);
    tracer.trace(going.rays(), lights);
    double sum = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
      const Vec3f a = on_white(before[i]), b = on_white(lights[i]);
      const double d =
          255 * static_cast<double>(std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)}));
      sum += d, report.step_error_most = std::max(report.step_error_most, d);
    }
    report.step_error_mean = sum / static_cast<double>(lights.size());
  }

  VolumeSubject subject_;
  Box3 box_;                    // box of the boundary
  std::vector<Vec3f> outline_;  // points that frame the picture
  PictureFrame frame_;
  VolumeCells cells_;
  VolumeIntervals intervals_;
  mutable std::once_flag histogram_once_, opacity_once_;
  mutable ValueHistogram histogram_, opacity_histogram_;
};

VolumePicture::VolumePicture(VolumeSubject subject, Progress& progress) {
  progress.begin("preparing");
  work_ = std::make_unique<Work>(std::move(subject), progress);
  progress.finish();
}
VolumePicture::~VolumePicture() = default;

void VolumePicture::set_surfaces(std::vector<SceneFactory> surfaces) { work_->set_surfaces(std::move(surfaces)); }
const PictureFrame& VolumePicture::frame() const { return work_->frame(); }
const ValueHistogram& VolumePicture::histogram() const { return work_->histogram(); }
TransferFunction VolumePicture::transfer(const VolumePictureOptions& options) const {
  return work_->transfer(options).function;
}
Camera VolumePicture::camera(const VolumePictureOptions& options) const {
  options.validate();
  return work_->camera(options);
}
LightMap VolumePicture::light(const Camera& camera, const VolumePictureOptions& options, Progress& progress,
                              VolumePictureReport* report) const {
  return work_->light(camera, options, progress, report, false);
}

Image VolumePicture::render(const VolumePictureOptions& options, Progress& progress, VolumePictureReport* report,
                            bool check_steps) const {
  options.validate();
  const Camera camera = work_->camera(options);
  VolumePictureReport own;
  const LightMap map = work_->light(camera, options, progress, &own, check_steps);
  Image image = behind(options);
  const bool axes = options.axes;
  if (axes) draw_box_edges(image, work_->box(), work_->frame(), camera);
  const bool dither = options.picture.look.effective_background().kind == Background::Kind::gradient;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto& p = map.at(x, y);
      Rgba& color = image.at(x, y);
      if (p[3] < 1) color = in_front(p, color);
      if (dither && p[3] > 0) color = dithered(color, x, y);
    }
  if (axes) draw_box_ticks(image, work_->box(), work_->frame(), camera, options.unit);
  if (options.picture.annotation.scale_bar)
    draw_scale_bar(image, work_->frame(), camera, options.picture.annotation.input_length,
                   *options.picture.annotation.scale_bar);
  if (!options.title.empty()) draw_title(image, options.title);
  if (options.color_bar) {
    std::vector<double> marks;
    marks.reserve(options.isos.size());
    for (const IsoSurface& iso : options.isos) marks.push_back(iso.value);
    const Image paper = behind(options);
    const auto [lower, upper] = own.transfer.range();
    const bool below = work_->histogram().least<lower, above = work_->histogram().most> upper;
    const BarEnds ends{below, above};
    image = with_color_bar(image, own.transfer, options.color_title, marks, &paper, ends);
  }
  if (report) *report = own;
  return image;
}

Image render_volume(const VolumeSubject& subject, const VolumePictureOptions& options, Progress& progress,
                    VolumePictureReport* report) {
  options.validate();
  const VolumePicture picture(subject, progress);
  return picture.render(options, progress, report);
}

namespace {

constexpr ReportRow kVolumePictureReportRows[] = {
    reported<[](const VolumePictureReport& r) { return r.transfer.range().first; }>(
        {.name = "colors.lower", .text = "Value of the first colour", .unit = "unit of the array"}),
    reported<[](const VolumePictureReport& r) { return r.transfer.range().second; }>(
        {.name = "colors.upper", .text = "Value of the last colour", .unit = "unit of the array"}),
    reported<[](const VolumePictureReport& r) { return value_if(!r.why.empty(), r.why); }>(
        {.name = "why", .text = "Reason for these colours, if they were chosen"}),
    reported<&VolumePictureReport::rays>({.text = "Rays"}),
    reported<&VolumePictureReport::evaluations>({.text = "Evaluations of the field"}),
    reported<&VolumePictureReport::notes>({.text = "Remarks on the result"})};

}  // namespace

const ReportSchema& VolumePictureReport::schema() {
  static constexpr ReportSchema schema{kVolumePictureReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
