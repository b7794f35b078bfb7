#include "sansmesh/measure/section.h"
#include "sansmesh/inspect.h"
#include "sansmesh/option.h"
#include "sansmesh/triangle_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::string_view kSectionAxes[] = {"x", "y", "z"};
constexpr int kMostPlanesOfSeries = 100000;

/// Planes from `first` on, evenly to the upper end of the box, in front of which the last one is.
std::vector<CutPlane> spread_from(int axis, double first, double end, int count) {
  if (count > 1 && !(first < end))
    throw ArgumentError(fmt::format(
        "`first = {}` is not below {}, the upper end of the box: several planes from there on need `interval`",
        length_words(first), length_words(end)));
  return plane_series(axis, first, (end - first) / count, count);
}

std::vector<CutPlane> series_of(const SectionOptions& o, const Box3& box) {
  const int axis = static_cast<int>(*o.axis);
  const auto k = static_cast<std::size_t>(axis);
  if (!o.interval) {
    if (o.first) return spread_from(axis, *o.first, box.upper[k], o.count.value_or(1));
    return spread_planes(box, axis, o.count.value_or(1));
  }
  const bool up = *o.interval > 0;
  const double size = box.size()[k], half = 0.5 * std::clamp(*o.interval, -size, size);
  const double start = o.first.value_or((up ? box.lower[k] : box.upper[k]) + half);
  if (o.count) return plane_series(axis, start, *o.interval, *o.count);
  // As many planes as fit into the box.
  const double more = std::floor(std::max(0.0, ((up ? box.upper[k] : box.lower[k]) - start) / *o.interval));
  if (!(more < kMostPlanesOfSeries))
    throw ArgumentError(
        fmt::format("`interval = {}` makes more than {} planes in the box: `count` or a larger one limits them",
                    length_words(*o.interval), grouped(kMostPlanesOfSeries)));
  return plane_series(axis, start, *o.interval, 1 + static_cast<int>(more));
}

std::vector<CutPlane> planes_of(const SectionOptions& o, const Box3& box) {
  std::vector<CutPlane> planes = o.planes;
  if (!o.axis) return planes.empty() ? middle_planes(box) : planes;
  const std::vector<CutPlane> series = series_of(o, box);
  planes.insert(planes.end(), series.begin(), series.end());
  return planes;
}

FieldSectionOptions lattice_of(const SectionOptions& o) {
  FieldSectionOptions lattice;
  if (o.resolution) lattice.resolution = *o.resolution;
  return lattice;
}

}  // namespace

const OptionSchema& SectionOptions::schema() {
  using O = SectionOptions;
  static constexpr OptionRow rows[] = {
      option<&O::planes>({.text = "z=0.5, or nx,ny,nz,d for the points with n·x = d; may be repeated",
                          .unit = "plane",
                          .name = "plane"}),
      option<&O::axis>({.text = "Planes perpendicular to x, y or z", .unit = "axis", .choices = kSectionAxes}),
      option<&O::first>({.text = "Position of the first plane",
                         .unit = "length",
                         .from_data = "half an interval inside the box",
                         .needs = "axis",
                         .old_name = "start"}),
      option<&O::interval>({.text = "Distance between planes; negative: downwards",
                            .unit = "length",
                            .from_data = "spread over the box, from the first on",
                            .needs = "axis",
                            .old_name = "step"}),
      option<&O::count>({.text = "Number of planes",
                         .from_data = "1, or as many as `interval` fits into the box",
                         .range = {1, kMostPlanesOfSeries},
                         .needs = "axis"}),
      option<&O::resolution>(
          {.text = "For functions: lattice squares along the longer side", .from_data = "512", .range = {2, 4096}})};
  return option_schema<rows>();
}

void SectionOptions::validate() const {
  validate_options(*this);
  if (interval && *interval == 0) throw ArgumentError("`interval` must not be 0");
}

SectionResult section(const AnySurface& surface, const SectionOptions& options, Progress& progress) {
  options.validate();
  SectionResult result;
  const ScalarField* const field = surface.field();
  if (options.resolution && !field) throw ArgumentError("`resolution` is for functions: meshes are cut exactly");
  if (surface.kind() == AnySurface::Kind::points)
    throw DataError(surface.name() + ": has no faces to cut: reconstruct a surface first");
  const Box3 box = surface.bounds();
  if (box.empty()) throw DataError(surface.name() + ": has no finite points");
  const std::vector<CutPlane> planes = planes_of(options, box);
  result.sections = field ? section_field(*field, planes, lattice_of(options), progress)
                          : section_mesh(*surface.mesh(progress, result.notes), planes, progress);
  SectionReport& r = result.report;
  for (const Section& s : result.sections) {
    r.curves += s.curves.size();
    r.open_curves += s.open_curves();
  }
  if (r.open_curves > 0)
    result.notes.push_back({.code = "open_curves",
                            .text = fmt::format("{} of {} open: the surface has borders there, which enclose no area",
                                                grouped(r.open_curves), counted(r.curves, "curve"))});
  return result;
}

const ReportSchema& SectionResult::schema() {
  static constexpr ReportRow rows[] = {
      reported<&SectionResult::sections>({.name = "planes", .text = "Planes with their sections"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
