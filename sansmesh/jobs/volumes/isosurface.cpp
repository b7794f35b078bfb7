// Isosurfaces of volumes as meshes.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/error.h"
#include "sansmesh/isosurfaces.h"
#include "sansmesh/jobs/volumes/volume_state.h"
#include "sansmesh/jobs/with_name.h"

namespace sansmesh::inline v1 {
namespace {

/// Arrays of `carry`. Throws ArgumentError for unknown names.
std::vector<std::string> arrays_to_carry(const VolumeModel& volume, const std::string& carry) {
  std::vector<std::string> wanted;
  if (carry == "none") return wanted;
  const VolumeDataset& dataset = dataset_of(volume);
  if (carry == "all") {
    for (const DatasetArray& array : dataset.arrays())
      if (array.of == volume.array().of && array.name != volume.choice().array) wanted.push_back(array.name);
  } else {
    wanted = between_commas(carry);
  }
  for (const std::string& name : wanted) dataset.array(name, "carry");
  return wanted;
}

/// Interpolates as the grid does; integer arrays are labels and are not interpolated.
void carry_along(const std::vector<std::string>& wanted, const VolumeModel& volume, VolumeIsosurfaceResult& result,
                 Progress& progress) {
  TriangleMesh& mesh = result.mesh;
  const std::vector<Vec3> x = world_points(mesh.origin, mesh.vertices);
  for (const std::string& name : wanted) {
    VolumeReconstructionOptions options;
    options.method = is_real(dataset_of(volume).array(name).type) ? "linear" : "nearest";
    const auto field = with_name(volume.name(), [&] {
      return dataset_of(volume).field({name, {}, false}, options, progress);
    });
    std::vector<double> values(x.size() * field->components());
    field->query({.points = x}, {.values = values});
    // Between samples linear interpolation is within their range: what is beyond is extrapolated at the surface.
    const DatasetArray& array = dataset_of(volume).array(name);
    const std::size_t components = array.components;
    for (std::size_t i = 0; components == field->components() && i < values.size(); ++i)
      if (const std::size_t c = i % components; !std::isnan(array.least[c]))
        values[i] = std::clamp(values[i], array.least[c], array.most[c]);
    constexpr double kMost = std::numeric_limits<float>::max();
    if (std::any_of(values.begin(), values.end(), [](double v) { return std::abs(v) > kMost; })) {
      result.notes.push_back(
          {.code = "not_carried",
           .text = fmt::format("{} is not carried: its values do not fit into floats", printable(name, 60)),
           .of = volume.name()});
      continue;
    }
    mesh.attributes.set(name, std::vector<float>(values.begin(), values.end()), field->components());
  }
}

}  // namespace

const OptionSchema& VolumeIsosurfaceOptions::schema() {
  using O = VolumeIsosurfaceOptions;
  static const OptionRow rows[] = {
      option<&O::value>({.text = "Isovalue", .from_data = "the middle of the array's range"}),
      option<&O::carry>({.text = "Arrays sampled at the vertices: all, none, or names with commas", .unit = "names"}),
      option_group<&O::mesh>(IsosurfaceOptions::schema().rows)};
  return option_schema<rows>();
}

void VolumeIsosurfaceOptions::validate() const {
  validate_options(*this);
  mesh.validate();
}

VolumeIsosurfaceResult isosurface(const VolumeModel& volume, const VolumeIsosurfaceOptions& options,
                                  Progress& progress) {
  options.validate();
  const std::shared_ptr<const SampledVolume> samples = volume.samples(progress);
  VolumeIsosurfaceResult result;
  VolumeIsosurfaceReport& r = result.report;
  r.value = volume.value_or_middle(options.value);
  const std::vector<std::string> wanted = arrays_to_carry(volume, options.carry);
  const auto surface = volume.isosurface(r.value, progress, result.notes);
  result.mesh = with_name(volume.name(), [&] { return mesh_isosurface(*surface, options.mesh, progress, &r.mesh); });
  progress.begin("carry arrays");
  carry_along(wanted, volume, result, progress);
  add_notes(result.notes, r.mesh.notes, volume.name());
  r.reconstruction = volume.report();
  return result;
}

const ReportSchema& VolumeIsosurfaceReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<&VolumeIsosurfaceReport::value>({.text = "Isovalue", .unit = "unit of the array"}),
      reported_inline<&VolumeIsosurfaceReport::mesh>()};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
