// Smoothed samples of volumes on their own grid.
#include <fmt/core.h>

#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/grids/write_cells.h"
#include "sansmesh/io/grids/write_volume.h"
#include "sansmesh/io/names.h"
#include "sansmesh/jobs/volumes/volume_state.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/volume/grid/volume_boundary.h"
#include "sansmesh/volume/smoothed_values.h"

namespace sansmesh::inline v1 {
namespace {

/// Arrays to smooth: the selected one, or all real ones of the same samples.
std::vector<std::string> arrays_to_smooth(const VolumeModel& volume, bool all) {
  if (!all) return {volume.choice().array};
  std::vector<std::string> names;
  for (const DatasetArray& a : volume.arrays())
    if (a.of == volume.array().of) names.push_back(a.name);
  return names;
}

/// Corners of the cells of a lattice: its samples, or the planes between them if these are in cells.
Lattice corner_lattice(const SampledVolume& volume) {
  Lattice lattice = *volume.lattice;
  for (std::size_t k = 0; k < 3; ++k) lattice.axes[k] = cell_borders(*volume.lattice, k, volume.in_cells);
  return lattice;
}

CellList hexahedra_of(const Lattice& lattice) {
  const std::size_t nx = lattice.axes[0].size(), ny = lattice.axes[1].size(), nz = lattice.axes[2].size();
  const auto at = [&](std::size_t i, std::size_t j, std::size_t k) {
    return static_cast<std::uint32_t>(i + nx * (j + ny * k));
  };
  // Mirroring axes turn cells inside out.
  const bool mirrored = dot(cross(lattice.directions[0], lattice.directions[1]), lattice.directions[2]) < 0;
  CellList cells;
  for (std::size_t k = 0; k + 1 < nz; ++k)
    for (std::size_t j = 0; j + 1 < ny; ++j)
      for (std::size_t i = 0; i + 1 < nx; ++i) {
        std::array<std::uint32_t, 8> c{
            at(i, j, k),     at(i + 1, j, k),     at(i + 1, j + 1, k),     at(i, j + 1, k),
            at(i, j, k + 1), at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)};
        if (mirrored)
          for (std::size_t v = 0; v < 4; ++v) std::swap(c[v], c[v + 4]);
        cells.add(CellShape::hexahedron, c);
      }
  return cells;
}

void write_as_cells(const std::string& file, const SampledVolume& volume) {
  if (volume.lattice) {
    const Lattice lattice = corner_lattice(volume);
    std::vector<Vec3> points(lattice.size());
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = lattice.position(i);
    const AttributeTable none;
    return write_cells(file, points, hexahedra_of(lattice), volume.in_cells ? none : volume.attributes,
                       volume.in_cells ? volume.attributes : none);
  }
  if (volume.corners.empty()) return write_cells(file, volume.positions, volume.cells, volume.attributes, {});
  write_cells(file, volume.corners, volume.cells, {}, volume.attributes.taken(volume.cell_sample));
}

/// Images hold uniform grids with values at points.
void check_image(const SampledVolume& volume) {
  check_argument(volume.lattice && volume.lattice->uniform && !volume.in_cells,
                 "images hold uniform grids with values at points: write other grids to a .vtu");
}

}  // namespace

void check_smoothed_writable(const std::string& file, const VolumeModel& volume, const SmoothVolumeOptions& options,
                             Progress& progress) {
  const std::string e = io::ending(file);
  if (e == "vtu") return check_writable(file, "text");
  check_volume_writable(file);
  check_image(*volume.samples(progress));
  const std::size_t arrays = arrays_to_smooth(volume, options.all_arrays).size() * (options.deviations ? 2 : 1);
  if (e != "vti" && arrays > 1)
    throw ArgumentError(fmt::format("`{}`: a .{} holds one array, not {}: choose .vti or .vtu",
                                    options.deviations ? "deviations" : "all_arrays", e, arrays));
}

SmoothVolumeResult smooth_volume(const VolumeModel& volume, const SmoothVolumeOptions& options, Progress& progress) {
  VolumeReconstructionOptions by = volume.options().reconstruction;
  const std::optional<double> factor = std::exchange(by.smoothing, {});
  check_argument(options_set(by).empty(),
                 "samples are smoothed before any reconstruction: of its options only "
                 "`smoothing` counts");
  const auto samples = volume.samples(progress);
  auto result = std::make_shared<SampledVolume>(*samples);
  SmoothVolumeResult smoothed;
  result->attributes.clear();
  bool changed = false, too_many = false;
  for (const std::string& name : arrays_to_smooth(volume, options.all_arrays)) {
    SmoothedValues smooth = with_name(volume.name(), [&] {
      VolumeValues values = volume_values(*samples, name);
      const bool asked = factor && *factor == 0;
      const SampleNoise* const noise = asked ? nullptr : &dataset_of(volume).noise(name, values, progress);
      return smoothed_values(*samples, std::move(values), factor, progress, noise);
    });
    const std::size_t components = smooth.values.components;
    // Missing values were filled in for the fits only.
    for (const std::uint32_t s : smooth.values.filled)
      for (std::size_t m = 0; m < components; ++m)
        smooth.values.values[s * components + m] = std::numeric_limits<double>::quiet_NaN();
    changed = changed || (smooth.smoothing > 0 && smooth.noise > 0);
    too_many = too_many || smooth.too_many;
    if (smooth.smoothing > 0)
      result->attributes.set(name, std::move(smooth.values.values), components);
    else
      result->attributes.set(*samples->attributes.find(name));
    if (options.deviations) {
      smooth.deviations.resize(samples->size() * components, 0.0f);
      result->attributes.set(name + "_deviation", std::move(smooth.deviations), components);
    }
    smoothed.report.arrays.push_back({name, smooth.smoothing, smooth.noise, smooth.kind});
  }
  if (too_many)
    smoothed.notes.push_back(
        {.code = "too_many",
         .text = fmt::format("noise was found, but {} take minutes to smooth: values are unchanged",
                             counted(samples->size(), "sample")),
         .remedy = "`smoothing` 1 smooths them",
         .severity = Note::Severity::warning,
         .of = volume.name()});
  else if (!changed)
    smoothed.notes.push_back(
        {.code = "no_noise",
         .text = "no noise was found: the values are unchanged",
         .remedy = factor.value_or(0) > 0 ? "" : "`smoothing` 1 smooths by the largest noise that there may be",
         .severity = Note::Severity::information,
         .of = volume.name()});
  smoothed.report.samples = samples->size();
  smoothed.samples = std::move(result);
  return smoothed;
}

void write_smoothed(const std::string& file, const SmoothVolumeResult& smoothed) {
  const SampledVolume& volume = *smoothed.samples;
  if (io::ending(file) == "vtu") return write_as_cells(file, volume);
  check_image(volume);
  check_argument(io::ending(file) == "vti" || volume.attributes.size() == 1,
                 "images other than .vti hold one array: choose .vti or .vtu");
  GridBlock block;
  block.kind = GridKind::lattice;
  block.axes = volume.lattice->axes, block.origin = volume.lattice->origin;
  block.directions = volume.lattice->directions;
  block.point_arrays = volume.attributes;
  write_volume(file, block);
}

std::vector<std::string> summary_of(const SmoothVolumeReport& report) {
  std::vector<std::string> lines;
  lines.reserve(report.arrays.size());
  for (const SmoothedArray& a : report.arrays) {
    const std::string name = printable(a.name, 60);
    if (a.noise == 0)
      lines.push_back(name + ": no noise found, unchanged");
    else if (a.smoothing == 0)
      lines.push_back(fmt::format("{}: {} noise of {:.3g}, unchanged", name, a.kind, a.noise));
    else
      lines.push_back(fmt::format("{}: {}noise of {:.3g}{}{}", name, a.kind.empty() ? "" : a.kind + " ", a.noise,
                                  a.kind == "Rician" ? ", means corrected" : "",
                                  a.smoothing == 1 ? "" : fmt::format(", smoothed by {:g} times that", a.smoothing)));
  }
  return lines;
}

const OptionSchema& SmoothVolumeOptions::schema() {
  using O = SmoothVolumeOptions;
  static constexpr OptionRow rows[] = {
      option<&O::all_arrays>({.text = "Smooth all arrays of the same samples"}),
      option<&O::deviations>({.text = "Add an array NAME_deviation: the estimated remaining deviation"})};
  return option_schema<rows>();
}

const ReportSchema& SmoothedArray::schema() {
  static constexpr ReportRow rows[] = {
      reported<&SmoothedArray::name>({.text = "Array"}),
      reported<&SmoothedArray::smoothing>({.text = "Factor of the noise; 0: unchanged"}),
      reported<&SmoothedArray::noise>({.text = "Deviation of the noise, 0 if none is found", .unit = "value"}),
      reported<[](const SmoothedArray& r) { return value_if(!r.kind.empty(), r.kind); }>(
          {.name = "kind", .text = "Kind of the noise: white, correlated or Rician (whose mean is corrected)"})};
  return report_schema<rows>();
}

const ReportSchema& SmoothVolumeReport::schema() {
  static constexpr ReportRow rows[] = {reported<&SmoothVolumeReport::samples>({.text = "Samples"}),
                                       reported<&SmoothVolumeReport::arrays>({.text = "Smoothed arrays"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
