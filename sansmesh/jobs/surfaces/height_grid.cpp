#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

#include "sansmesh/convert.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/names.h"
#include "sansmesh/jobs/files/tile_names.h"
#include "sansmesh/measure/contours.h"
#include "sansmesh/measure/mesh_heights.h"
#include "sansmesh/points/cleaning/point_classes.h"
#include "sansmesh/points/ground/classify_ground.h"
#include "sansmesh/points/ground/ground_grid.h"
#include "sansmesh/points/ground/ground_heights.h"

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

/// Least edge of cells that a tile has a whole number of; `wanted` without tiles.
double cell_of_tiles(double wanted, std::optional<double> tile) {
  return tile ? *tile / std::max(1.0, std::floor(*tile / wanted * (1 + 1e-9))) : wanted;
}

/// Largest number of cells of a tile: 400 MB in a file.
constexpr double kMostTileCells = 1e8;

/// Number of cells of an edge of a tile. Throws ArgumentError unless it is whole, and if there are too many.
std::int64_t cells_of_tile(double tile, double cell) {
  const double cells = tile / cell;
  if (!(cells >= 0.5 && std::abs(cells - std::round(cells)) <= 1e-9 * cells))
    throw ArgumentError(fmt::format("`tile_size` {:.6g} must be a multiple of `cell` {:.6g}", tile, cell));
  if (!(cells * cells <= kMostTileCells))
    throw ArgumentError(fmt::format("a tile of {:.6g} would have {:.6g} cells of {:.6g}: at most {:.0f} are possible",
                                    tile, cells * cells, cell, kMostTileCells));
  return std::llround(cells);
}

GroundHeights grid_of_points(const TerrainSamples& samples, const HeightGridOptions& options, const HeightGridUse& use,
                             Progress& progress) {
  if (!(samples.spacing > 0)) throw DataError("the ground covers no area over x and y");
  return make_ground_heights(samples.points,
                             {.cell = options.cell.value_or(cell_of_tiles(rounded_up(samples.spacing), use.tile_size)),
                              .spacing = samples.spacing,
                              .gap = options.gap.value_or(kGapSpacings * samples.spacing),
                              .breaklines = &use.breaklines},
                             progress);
}

HeightGrid grid_of_mesh(const TriangleMesh& mesh, double spacing, const HeightGridOptions& options,
                        std::optional<double> tile, Progress& progress) {
  const Vec3f size = bounds(mesh).size();
  const auto longer = static_cast<double>(std::max(size.x, size.y));
  if (!(longer > 0)) throw DataError("the mesh covers no area over x and y");
  const double wanted = rounded_up(spacing > 0 ? spacing : longer / kMeshCells);
  return make_mesh_heights(mesh, options.cell.value_or(cell_of_tiles(wanted, tile)), progress);
}

void check_no_breaklines(const HeightGridUse& use) {
  if (use.breaklines.size() > 0) throw ArgumentError("`breaklines` are for grids of samples, not of a surface");
}

HeightGridResult with_report(HeightGrid grid, std::size_t samples, const HeightGridOptions& options) {
  HeightGridResult result{std::move(grid), {}, {}};
  HeightGridReport& r = result.report;
  const std::vector<float>& heights = result.grid.heights.pixels;
  r.samples = samples;
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

void HeightGridUse::validate(const HeightGridOptions& options) const {
  if (tile_size && !(*tile_size > 0 && std::isfinite(*tile_size))) throw ArgumentError("`tile_size` must be positive");
  if (tile_size && options.cell) cells_of_tile(*tile_size, *options.cell);
}

const ReportSchema& HeightGridReport::schema() {
  using R = HeightGridReport;
  static constexpr ReportRow rows[] = {reported<&R::samples>({.text = "Samples of the ground, or of chosen classes"}),
                                       reported<&R::breaklines>({.text = "Breaklines over the samples"}),
                                       reported<&R::columns>({.text = "Columns of cells"}),
                                       reported<&R::rows>({.text = "Rows of cells"}),
                                       reported<&R::cell>({.text = "Edge of the cells", .unit = "length"}),
                                       reported<&R::unknown>({.text = "Share of cells without a height, 0 to 1"}),
                                       reported<&R::lowest>({.text = "Least height", .unit = "length"}),
                                       reported<&R::highest>({.text = "Largest height", .unit = "length"}),
                                       reported<&R::interval>({.text = "Interval of contour lines", .unit = "length"})};
  return report_schema<rows>();
}

TerrainSamples terrain_samples(PointSet points, bool all, Progress& progress) {
  TerrainSamples made{std::move(points), 0, 0, {}};
  if (!all) {
    bool only_others = false;
    if (const Attribute* const given = find_point_classes(made.points)) {
      const auto counts = count_point_classes(*given);
      only_others = counts[kGroundClass] == 0 &&
                    std::any_of(counts.begin() + kGroundClass + 1, counts.end(), [](std::size_t n) { return n > 0; });
    }
    PointClasses ground;
    ground.set(kGroundClass);
    if (!only_others) made.notes = select_classes(made.points, ground, progress);
  }
  made.count = made.points.size();
  if (const auto extent = measure_survey(made.points)) made.spacing = extent->spacing;
  return made;
}

HeightGridResult make_height_grid(const CloudOrMesh& data, const HeightGridOptions& options, Progress& progress,
                                  const HeightGridUse& use) {
  options.validate();
  use.validate(options);
  if (data.is_mesh) {
    check_no_breaklines(use);
    return with_report(grid_of_mesh(data.mesh, 0, options, use.tile_size, progress), 0, options);
  }
  PointSet bare;
  bare.origin = data.points.origin, bare.positions = data.points.positions, bare.reference = data.points.reference;
  if (const Attribute* const given = find_point_classes(data.points)) bare.attributes.set(*given);
  const TerrainSamples samples = terrain_samples(std::move(bare), false, progress);
  GroundHeights made = grid_of_points(samples, options, use, progress);
  HeightGridResult result = with_report(std::move(made.grid), samples.count, options);
  result.notes = samples.notes;
  const std::size_t lines = use.breaklines.size();
  if (lines > 0) result.report.breaklines = made.breaklines;
  if (made.breaklines < lines)
    result.notes.push_back({.code = "breaklines_outside",
                            .text = fmt::format("{} of {} not over the samples of the ground",
                                                grouped(lines - made.breaklines), counted(lines, "breakline"))});
  return result;
}

HeightGridResult make_height_grid(const TriangleMesh& surface, const TerrainSamples& samples,
                                  const HeightGridOptions& options, Progress& progress, const HeightGridUse& use) {
  options.validate();
  use.validate(options);
  if (options.gap) throw ArgumentError("`gap` is for grids of samples: `fill_holes` closes gaps of a surface");
  check_no_breaklines(use);
  return with_report(grid_of_mesh(surface, samples.spacing, options, use.tile_size, progress), samples.count, options);
}

std::vector<HeightTile> split_height_grid(const HeightGrid& grid, double tile_size) {
  const std::int64_t cells = cells_of_tile(tile_size, grid.cell);
  const std::int64_t left = std::llround(grid.left / grid.cell), top = std::llround(grid.top / grid.cell);
  const auto below = [&](std::int64_t k) { return k / cells - (k % cells < 0 ? 1 : 0); };
  const std::int64_t first = below(left), last = below(left + grid.heights.width - 1);
  const std::int64_t lowest = below(top - grid.heights.height), highest = below(top - 1);
  check_tile_count(static_cast<double>(last - first + 1) * static_cast<double>(highest - lowest + 1),
                   static_cast<double>(kMostTiles));
  std::vector<HeightTile> tiles;
  for (std::int64_t row = lowest; row <= highest; ++row)
    for (std::int64_t column = first; column <= last; ++column) {
      // Tiles are complete squares, so that they fit; those without heights are left out.
      HeightTile tile{corner_words(static_cast<double>(column) * tile_size, static_cast<double>(row) * tile_size),
                      {{static_cast<int>(cells), static_cast<int>(cells), std::numeric_limits<float>::quiet_NaN()},
                       grid.cell,
                       static_cast<double>(column) * tile_size,
                       static_cast<double>(row + 1) * tile_size,
                       grid.reference}};
      bool known = false;
      for (std::int64_t r = 0; r < cells; ++r)
        for (std::int64_t c = 0; c < cells; ++c) {
          const std::int64_t k = column * cells + c - left, j = top - (row + 1) * cells + r;
          if (k < 0 || j < 0 || k >= grid.heights.width || j >= grid.heights.height) continue;
          const float h = grid.heights.at(static_cast<int>(k), static_cast<int>(j));
          tile.grid.heights.at(static_cast<int>(c), static_cast<int>(r)) = h;
          known = known || std::isfinite(h);
        }
      if (known) tiles.push_back(std::move(tile));
    }
  std::vector<std::string> places;
  places.reserve(tiles.size());
  for (const HeightTile& tile : tiles) places.push_back(tile.place);
  check_corners(std::move(places));
  return tiles;
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
  return {fmt::format("{} × {} cells of {:.6g}, heights {:.6g} to {:.6g}{}{}{}", grouped(r.columns), grouped(r.rows),
                      r.cell, r.lowest, r.highest,
                      r.unknown > 0 ? fmt::format(", {:.1f} % unknown", 100 * r.unknown) : "",
                      r.samples > 0 ? ", from " + counted(r.samples, "sample") : "",
                      r.breaklines ? " and " + counted(*r.breaklines, "breakline") : "")};
}

}  // namespace sansmesh::inline v1
