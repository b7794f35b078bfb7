#include "sansmesh/measure/section.h"
#include "sansmesh/inspect.h"
#include "sansmesh/option.h"
#include "sansmesh/triangle_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::string_view kSectionAxes[] = {"x", "y", "z"};
constexpr int kMostPlanesOfSeries = 100000;

std::vector<CutPlane> series_of(const SectionOptions& o, const Box3& box) {
  const int axis = static_cast<int>(*o.axis);
  const auto k = static_cast<std::size_t>(axis);
  if (!o.first && !o.interval) return spread_planes(box, axis, o.count.value_or(1));
  if (o.interval && !o.count) {
    // As many planes as fit into the box.
    const double start =
        o.first.value_or(*o.interval > 0 ? box.lower[k] + 0.5 * *o.interval : box.upper[k] + 0.5 * *o.interval);
    const double left = ((*o.interval > 0 ? box.upper[k] : box.lower[k]) - start) / *o.interval;
    return plane_series(axis, start, *o.interval, 1 + index_in<int>(left, 0, 1000000));
  }
  return plane_series(axis, o.first.value_or(box.lower[k] + 0.5 * o.interval.value_or(0)), o.interval.value_or(1),
                      o.count.value_or(1));
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
      option<&O::interval>({.text = "Distance between planes",
                            .unit = "length",
                            .from_data = "spread over the box",
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
  if (first && !interval && count.value_or(1) != 1)
    throw ArgumentError("several planes from `start` on need `interval`");
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
