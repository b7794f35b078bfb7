#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sansmesh/convert.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/names.h"
#include "sansmesh/measure/contours.h"
#include "sansmesh/measure/mesh_heights.h"
#include "sansmesh/measure/section_text.h"
#include "sansmesh/points/ground/classify_ground.h"
#include "sansmesh/points/ground/ground_grid.h"
#include "sansmesh/points/ground/ground_heights.h"
#include "sansmesh/points/point_classes.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kGapSpacings = 40;
/// Number of contour heights, and of cells of the longer side of a mesh.
constexpr double kContourHeights = 15, kMeshCells = 1000;
constexpr std::size_t kGroundClass = 2;

/// The smallest of 1, 2 or 5 times a power of ten that is at least `length`.
double rounded_up(double length) {
  const double power = std::pow(10, std::floor(std::log10(length)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= length * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

/// Samples of the ground.
PointSet ground_of(const PointSet& points, std::vector<Note>& notes, Progress& progress) {
  PointSet ground;
  ground.origin = points.origin, ground.positions = points.positions, ground.reference = points.reference;
  if (const Attribute* const given = find_point_classes(points)) {
    ground.attributes.set(*given);
    const auto counts = count_point_classes(*given);
    const bool others =
        std::any_of(counts.begin() + kGroundClass + 1, counts.end(), [](std::size_t n) { return n > 0; });
    if (counts[kGroundClass] == 0 && others) return ground;
  }
  PointClasses only;
  only.set(kGroundClass);
  notes = select_classes(ground, only, progress);
  return ground;
}

HeightGrid grid_of_points(const PointSet& points, const HeightGridOptions& options, HeightGridResult& result,
                          Progress& progress) {
  const PointSet ground = ground_of(points, result.notes, progress);
  result.report.ground = ground.size();
  const auto extent = measure_survey(ground);
  if (!extent) throw DataError("the ground covers no area over x and y");
  return make_ground_heights(ground,
                             {.cell = options.cell.value_or(rounded_up(extent->spacing)),
                              .spacing = extent->spacing,
                              .gap = options.gap.value_or(kGapSpacings * extent->spacing)},
                             progress);
}

HeightGrid grid_of_mesh(const TriangleMesh& mesh, const HeightGridOptions& options, Progress& progress) {
  const Vec3f size = bounds(mesh).size();
  const auto longer = static_cast<double>(std::max(size.x, size.y));
  if (!(longer > 0)) throw DataError("the mesh covers no area over x and y");
  return make_mesh_heights(mesh, options.cell.value_or(rounded_up(longer / kMeshCells)), progress);
}

}  // namespace

const OptionSchema& HeightGridOptions::schema() {
  using O = HeightGridOptions;
  static constexpr OptionRow rows[] = {
      option<&O::cell>({.text = "Edge of the cells of a height grid",
                        .unit = "length",
                        .from_data = "the spacing of the ground, rounded up",
                        .range = positive()}),
      option<&O::gap>({.text = "Fill gaps in the ground up to this width; heights in wider ones are unknown",
                       .unit = "length",
                       .from_data = "40 spacings",
                       .range = at_least(0)}),
      option<&O::interval>({.text = "Difference in height of contour lines",
                            .unit = "length",
                            .from_data = "about 15 heights",
                            .range = positive()})};
  return option_schema<rows>();
}

void HeightGridOptions::validate() const { validate_options(*this); }

const ReportSchema& HeightGridReport::schema() {
  using R = HeightGridReport;
  static constexpr ReportRow rows[] = {reported<&R::ground>({.text = "Samples of the ground"}),
                                       reported<&R::columns>({.text = "Columns of cells"}),
                                       reported<&R::rows>({.text = "Rows of cells"}),
                                       reported<&R::cell>({.text = "Edge of the cells", .unit = "length"}),
                                       reported<&R::unknown>({.text = "Share of cells without a height, 0 to 1"}),
                                       reported<&R::lowest>({.text = "Least height", .unit = "length"}),
                                       reported<&R::highest>({.text = "Largest height", .unit = "length"}),
                                       reported<&R::interval>({.text = "Interval of contour lines", .unit = "length"})};
  return report_schema<rows>();
}

HeightGridResult make_height_grid(const CloudOrMesh& data, const HeightGridOptions& options, Progress& progress) {
  options.validate();
  HeightGridResult result;
  result.grid = data.is_mesh ? grid_of_mesh(data.mesh, options, progress)
                             : grid_of_points(data.points, options, result, progress);
  HeightGridReport& r = result.report;
  const std::vector<float>& heights = result.grid.heights.pixels;
  r.columns = static_cast<std::size_t>(result.grid.heights.width),
  r.rows = static_cast<std::size_t>(result.grid.heights.height);
  r.cell = result.grid.cell;
  float lowest = INFINITY, highest = -INFINITY;
  std::size_t known = 0;
  for (const float h : heights)
    if (std::isfinite(h)) lowest = std::min(lowest, h), highest = std::max(highest, h), ++known;
  if (known == 0) throw DataError("no cell has a height: `cell` is too large for the samples of the ground");
  r.unknown = 1 - static_cast<double>(known) / static_cast<double>(heights.size());
  r.lowest = static_cast<double>(lowest), r.highest = static_cast<double>(highest);
  const double range = std::max(r.highest - r.lowest, 1e-6 * r.cell);
  r.interval = options.interval.value_or(rounded_up(range / kContourHeights));
  return result;
}

void check_contours_writable(const std::string& file) {
  const std::string ending = io::ending(file);
  if (ending == "svg" || ending == "dxf" || is_written(file, "lines")) return;
  throw FileError(file, "contour lines are written as .svg, .dxf, .vtp, .ply or .csv");
}

std::size_t write_contours(const std::string& file, const HeightGrid& grid, double interval) {
  check_contours_writable(file);
  const PolylineSet lines = contours_of(grid, interval);
  const std::string ending = io::ending(file);
  if (ending == "svg")
    write_text(file, contours_svg(lines, interval));
  else if (ending == "dxf")
    write_text(file, contours_dxf(lines, interval));
  else
    write_lines(file, lines);
  return lines.size();
}

Image hillshade_of(const HeightGrid& grid) {
  const int width = grid.heights.width, height = grid.heights.height;
  Image image(width, height, Rgba{0, 0, 0, 0});
  const Vec3 light = normalized(Vec3{-1, 1, std::numbers::sqrt2});
  parallel_for(0, static_cast<std::size_t>(height), 16, [&](std::size_t row) {
    const auto r = static_cast<int>(row);
    for (int c = 0; c < width; ++c) {
      if (!std::isfinite(grid.heights.at(c, r))) continue;
      // Differences over two cells; over one beside unknown heights.
      const auto rise = [&](int dc, int dr) {
        const auto at = [&](int sign) {
          const int k = c + sign * dc, j = r + sign * dr;
          const bool inside = k >= 0 && j >= 0 && k < width && j < height && std::isfinite(grid.heights.at(k, j));
          return inside ? std::pair{grid.heights.at(k, j), 1} : std::pair{grid.heights.at(c, r), 0};
        };
        const auto [after, a] = at(1);
        const auto [before, b] = at(-1);
        return a + b > 0 ? static_cast<double>(after - before) / ((a + b) * grid.cell) : 0.0;
      };
      const Vec3 normal = normalized(Vec3{-rise(1, 0), rise(0, 1), 1});
      const auto shade = static_cast<float>(std::max(0.0, dot(normal, light)));
      image.at(c, r) = {shade, shade, shade, 1};
    }
  });
  return image;
}

std::vector<std::string> summary_of(const HeightGridReport& r) {
  return {fmt::format("{} × {} cells of {:.6g}, heights {:.6g} to {:.6g}{}{}", grouped(r.columns), grouped(r.rows),
                      r.cell, r.lowest, r.highest,
                      r.unknown > 0 ? fmt::format(", {:.1f} % unknown", 100 * r.unknown) : "",
                      r.ground > 0 ? ", from " + counted(r.ground, "sample") + " of the ground" : "")};
}

}  // namespace sansmesh::inline v1
