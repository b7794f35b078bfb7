#include "sansmesh/volume_pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/jobs/pictures/color_bar.h"
#include "sansmesh/jobs/pictures/turntable.h"
#include "sansmesh/jobs/volumes/volume_state.h"
#include "sansmesh/jobs/volumes/volume_subject.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/mesh/edit/tubes.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/surface/picture_surfaces.h"
#include "sansmesh/render/volume/baked_volume.h"
#include "sansmesh/render/volume/volume_picture.h"
#include "sansmesh/volume/grid/volume_boundary.h"
#include "sansmesh/volumes.h"

namespace sansmesh::inline v1 {
namespace {

/// Outer edges of the grid's cells, about 1.5 pixels wide; thinner for small cells.
SceneFactory grid_lines(const SampledVolume& samples, const RenderOptions& options) {
  RenderOptions own = options;
  own.look.surface_color = options.look.wire_color;
  TubeOptions tube;
  tube.sides = 5;
  const double seen =
      options.view.look_radius ? 2 * *options.view.look_radius : samples.bounds().diagonal() / options.view.zoom;
  tube.radius = 0.75 * seen / std::min(options.view.width, options.view.height);
  // Dense lines would hide the volume, so they may cover only a share of its sides, whose area is estimated from the
  // box.
  constexpr double kCovered = 0.3;
  const PolylineSet lines = boundary_edges(samples);
  const Vec3 size = samples.bounds().size();
  const double sides = 2 * (size.x * size.y + size.y * size.z + size.z * size.x);
  double length = 0;
  for (std::size_t i = 0; i < lines.size(); ++i)
    length += norm(Vec3(lines.positions[lines.offsets[i] + 1] - lines.positions[lines.offsets[i]]));
  if (length > 0) tube.radius = std::min(tube.radius, kCovered * sides / (2 * length));
  return scene_factory(tubes(lines, tube), own);
}

}  // namespace

struct VolumePictures::State {
  std::string name;
  VolumePictureOptions look;
  std::shared_ptr<const SampledVolume> samples;
  std::shared_ptr<const VolumeField> field, opacity;
  std::unique_ptr<BakedVolume> baked, baked_opacity;
  TriangleMesh boundary;
  std::unique_ptr<VolumePicture> picture;
  VolumePictureReport report;
  std::vector<Note> notes;
  std::optional<int> frames;
};

const OptionSchema& VolumePicturesOptions::schema() {
  using O = VolumePicturesOptions;
  static const OptionRow rows[] = {
      option<&O::opacity_by>({.text = "Array for the opacity; colours show the selected array", .unit = "name"}),
      option_group<&O::look>(VolumePictureOptions::schema().rows),
      option<&O::grid>({.text = "Draw cell edges on the boundary of the volume; with an opacity of 0 only "
                                "these"}),
      option<&O::quick>({.text = "Quick: one ray per pixel, longer steps"}),
      option<&O::baked>(
          {.text = "Quick: render the field baked into bricks, and report the error", .old_name = "interactive"}),
      option<&O::bake_error>({.text = "For `baked`: error above which bricks are split, share of the range",
                              .unit = "share",
                              .range = positive(1),
                              .needs = "baked"}),
      option<&O::bar>({.text = "Omit the colour bar"}),
      option<&O::unit>({.text = "Unit of the array at the colour bar"}),
      option<&O::frames>(kTurntable)};
  return option_schema<rows>();
}

void VolumePicturesOptions::validate() const {
  validate_options(*this);
  look.validate();
  if (const int samples = look.picture.quality.samples;
      (quick || baked) && samples != RenderOptions().quality.samples && samples != 1)
    throw ArgumentError(
        fmt::format("`antialiasing` excludes `{}`, which has one ray per pixel", quick ? "quick" : "baked"));
  if (!bar && (!look.color_title.empty() || !unit.empty()))
    throw ArgumentError("`label` and `unit` are for the colour bar: not with `bar = false`");
}

VolumePictures::VolumePictures(const VolumeModel& volume, const VolumePicturesOptions& options,
                               std::vector<SceneFactory> surfaces, Progress& progress)
    : state_(std::make_unique<State>()) {
  options.validate();
  State& s = *state_;
  s.name = volume.name();
  s.look = options.look;
  VolumePictureOptions& look = s.look;
  look.color_bar = options.bar, look.picture.view.steady = options.frames.has_value();
  s.frames = options.frames;
  if (options.baked || options.quick) look.picture.quality.samples = 1, look.step = 1.5, look.least_light = 0.01;
  s.samples = volume.samples(progress);
  s.field = volume.field(volume.as_scalar(volume.choice()), progress, s.notes);
  if (!options.opacity_by.empty())
    s.opacity = volume.field(volume.scalar_choice(options.opacity_by, "opacity_by"), progress, s.notes);
  VolumeSubject subject = volume_subject(*s.samples, s.boundary);
  subject.field = s.field.get(), subject.opacity = s.opacity.get();
  subject.values = range_of_samples(volume, progress);
  if (options.baked) {
    BakeOptions bake;
    bake.tolerance = options.bake_error;
    bake.samples = s.samples->positions;
    progress.begin("bake");
    const auto baked = [&](const VolumeField& field) {
      return with_name(volume.name(), [&] { return std::make_unique<BakedVolume>(field, bake, progress); });
    };
    s.baked = baked(*s.field);
    subject.field = s.baked.get();
    if (s.opacity) {
      s.baked_opacity = baked(*s.opacity);
      subject.opacity = s.baked_opacity.get();
    }
  }
  if (options.default_view)
    if (const auto view = view_of_layer(s.samples->bounds(), look.picture.view.up)) look.picture.view.direction = *view;
  subject.surfaces = std::move(surfaces);
  if (options.grid) subject.surfaces.push_back(grid_lines(*s.samples, look.picture));
  if (look.color_title.empty()) look.color_title = volume.array_name() + (volume.is_vector() ? " (magnitude)" : "");
  if (!options.unit.empty()) look.color_title += " [" + options.unit + "]";
  s.picture = with_name(volume.name(), [&] { return std::make_unique<VolumePicture>(std::move(subject), progress); });
  if (look.color_bar) reserve_width(look.picture, ColorBar{s.picture->transfer(look), look.color_title, {}});
}

VolumePictures::~VolumePictures() = default;
VolumePictures::VolumePictures(VolumePictures&&) noexcept = default;

const VolumePictureOptions& VolumePictures::look() const { return state_->look; }

Image VolumePictures::render(const ViewDirection& view, Progress& progress) {
  VolumePictureOptions look = state_->look;
  look.picture.view.direction = view;
  return with_name(state_->name, [&] { return state_->picture->render(look, progress, &state_->report); });
}

void VolumePictures::render(const UsePicture& use, Progress& progress) {
  draw_turntable(look().picture, state_->frames, use,
                 [&](const RenderOptions& one) { return render(one.view.direction, progress); });
}

const VolumePictureReport& VolumePictures::report() const { return state_->report; }

const BakeReport* VolumePictures::baked() const { return state_->baked ? &state_->baked->report() : nullptr; }

std::vector<Note> VolumePictures::notes() const {
  std::vector<Note> notes = state_->notes;
  add_notes(notes, "picture", state_->report.notes, state_->name);
  return notes;
}

}  // namespace sansmesh::inline v1
