// Surfaces computed directly from the samples of a volume.
#include <fmt/core.h>

#include <memory>
#include <span>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/dataset/mesh_volume_surface.h"
#include "sansmesh/isosurfaces.h"
#include "sansmesh/jobs/volumes/volume_state.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/volume/smoothed_values.h"

namespace sansmesh::inline v1 {
namespace {

using Kind = VolumeSurfaceOptions::Kind;

/// One finite value per sample: of a component, or lengths of vectors.
std::vector<double> scalar_values(const VolumeValues& all, const ArrayChoice& choice) {
  if (all.components == 1) return all.values;
  std::vector<double> values(all.values.size() / all.components);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::span<const double> v = all.of(i);
    values[i] = choice.component ? v[*choice.component] : vector_length(v);
  }
  return values;
}

/// Standard deviation of the noise that was found, which what remains of it is correlated with: surfaces need widths
/// for all of it. Otherwise the residual of local parabolas, if that of planes is no larger; 0 for resolved volumes.
double noise_of_surface(const VolumeTraits& traits) {
  return traits.resolved() && !traits.noisy ? 0 : traits.noise * traits.range;
}

}  // namespace

const OptionSchema& SurfaceInVolumeOptions::schema() {
  using O = SurfaceInVolumeOptions;
  static const OptionRow rows[] = {
      option<&O::value>(
          {.text = "Isovalue", .from_data = "the middle of the array's range", .excludes = "high_gradient"}),
      option_group<&O::surface>(VolumeSurfaceOptions::schema().rows)};
  return option_schema<rows>();
}

void SurfaceInVolumeOptions::validate() const {
  validate_options(*this);
  VolumeSurfaceOptions own = surface;
  own.value = value.value_or(0);
  own.validate();
}

SurfaceInVolume surface_in_volume(const VolumeModel& volume, const SurfaceInVolumeOptions& options,
                                  Progress& progress) {
  options.validate();
  VolumeSurfaceOptions own = options.surface;
  if (own.kind == Kind::isovalue) own.value = volume.value_or_middle(options.value);
  const auto samples = volume.samples(progress);
  const VolumeTraits& traits = volume.traits(progress);
  bool too_many = false;
  auto surface = std::make_shared<const VolumeSurface>(with_name(volume.name(), [&] {
    const VolumeValues values = volume_values(*samples, volume.choice().array);
    const auto smoothed = [&]() -> std::optional<std::vector<double>> {
      const SampleNoise& noise = dataset_of(volume).noise(volume.choice().array, values, progress);
      const auto& factor = volume.options().reconstruction.smoothing;
      const SmoothedValues made = smoothed_values(*samples, values, factor, progress, &noise);
      too_many = made.too_many;
      if (!(made.smoothing > 0)) return {};
      return scalar_values(made.values, volume.choice());
    };
    return make_volume_surface(samples, scalar_values(values, volume.choice()), noise_of_surface(traits), own, progress,
                               smoothed);
  }));
  SurfaceInVolume result{surface, surface->report(), own.value, volume.name(), {}};
  if (too_many)
    result.notes.push_back(
        {.code = "too_many",
         .text =
             fmt::format("noise moves the surface by a quarter of a spacing or more, but {} take minutes to smooth: "
                         "the samples are used as they are",
                         counted(samples->size(), "sample")),
         .remedy = "smooth them first (sansmesh volume smooth, with `smoothing` 1)",
         .severity = Note::Severity::warning,
         .of = volume.name()});
  if (!samples->lattice && traits.resolved())
    result.notes.push_back({.code = "resolved",
                            .text = "the values are smooth between samples",
                            .remedy = "an isosurface of the reconstruction follows them more closely",
                            .severity = Note::Severity::information,
                            .of = volume.name()});
  return result;
}

const OptionSchema& MeshInVolumeOptions::schema() {
  using O = MeshInVolumeOptions;
  static constexpr OptionRow rows[] = {
      option<&O::mesh_error>(
          {.text = "Accepted mean distance between mesh and surface", .unit = "length", .range = positive()}),
      option<&O::triangles>({.text = "At most this many triangles", .range = at_least(4)}),
      option<&O::components>(
          {.text = "Components to keep: auto (all that the weights resolve), all, largest or a number",
           .unit = "choice"})};
  return option_schema<rows>();
}

void MeshInVolumeOptions::validate() const { validate_options(*this); }

MeshInVolume mesh_of_surface(const SurfaceInVolume& surface, const MeshInVolumeOptions& options, Progress& progress) {
  options.validate();
  MeshOptions meshing;
  meshing.mesh_error = options.mesh_error, meshing.triangles = options.triangles;
  meshing.components = options.components;
  MeshInVolume result;
  MeshInVolumeReport& r = result.report;
  result.mesh =
      with_name(surface.name, [&] { return mesh_volume_surface(*surface.surface, meshing, progress, &r.mesh); });
  add_notes(result.notes, r.mesh.notes, surface.name);
  const MeshSize size = measure_size(result.mesh);
  r.area = size.area;
  if (!r.mesh.open) r.volume = size.volume;
  return result;
}

PointSet points_of_surface(const SurfaceInVolume& surface, std::optional<double> distance, Progress& progress) {
  return with_name(surface.name, [&] { return sample_volume_surface(*surface.surface, distance, progress); });
}

const ReportSchema& MeshInVolumeReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<&MeshInVolumeReport::area>({.text = "Area of the mesh", .unit = "length²"}),
      reported<&MeshInVolumeReport::volume>({.text = "Volume of the mesh, if it is closed", .unit = "length³"}),
      reported<[](const MeshInVolumeReport& r) { return r.mesh.components; }>(
          {.name = "components", .text = "Connected components of the mesh"}),
      reported<[](const MeshInVolumeReport& r) { return r.volume.has_value(); }>(
          {.name = "closed", .text = "Whether the mesh is closed"})};
  return report_schema<rows>();
}

namespace {

bool is_steep(const SurfaceInVolume& made) {
  return made.surface->options().kind == VolumeSurfaceOptions::Kind::high_gradient;
}

}  // namespace

std::vector<std::string> summary_of(const SurfaceInVolume& s, const VolumeModel& volume, Progress& progress) {
  const VolumeSurfaceReport& r = s.report;
  const auto samples = volume.samples(progress);
  return {
      fmt::format("{}: {}, {} of {} ({})", volume.name(),
                  is_steep(s)
                      ? fmt::format("steepest {}, from {:.4g} per length", volume.array_name(), r.least_gradient)
                      : fmt::format("{} = {:.6g}", volume.array_name(), s.value),
                  counted(r.samples, "sample"), grouped(samples->size()), samples->facts.grid),
      fmt::format("spacing {}, weights {:.2f} spacings wide{}{}", length_words(r.spacing), r.smoothing,
                  r.noise_distance > 0 ? fmt::format(", noise moves the surface by {}", length_words(r.noise_distance))
                                       : std::string(),
                  r.smoothed >= 1  ? ", samples smoothed by their noise first"
                  : r.smoothed > 0 ? fmt::format(", {:.0f} % of it smoothed in the samples first", 100 * r.smoothed)
                                   : std::string())};
}

const ReportSchema& SurfaceInVolume::schema() {
  static constexpr ReportRow rows[] = {
      reported<[](const SurfaceInVolume& r) { return value_if(!is_steep(r), r.value); }>(
          {.name = "value", .text = "Isovalue", .unit = "unit of the array"}),
      reported<&SurfaceInVolume::report>({.name = "surface", .text = "Surface and its samples"}),
      reported<[](const SurfaceInVolume& r) { return is_steep(r) ? "high-gradient" : "isovalue"; }>(
          {.name = "surface.kind", .text = "Kind of the surface"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
