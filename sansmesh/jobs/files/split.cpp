#include "sansmesh/convert.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/files/tile_names.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/points/cleaning/close_points.h"
#include "sansmesh/points/statistics/spacing.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kSpacingsApart = 4;
/// Number of parts below which no note on triangle soup is given.
constexpr std::size_t kFewParts = 10;

std::size_t large_enough(const std::vector<std::size_t>& sizes, const SplitOptions& options) {
  return static_cast<std::size_t>(
      std::count_if(sizes.begin(), sizes.end(), [&](std::size_t n) { return n >= options.min_size; }));
}

/// Throws DataError if there are no parts, or too many. `of`: "triangles".
void check_parts(std::size_t parts, const SplitOptions& options, const std::string& of, SplitResult& result) {
  const bool tiles = result.tile_size.has_value();
  const std::string all = tiles ? "there are " + counted(result.found, "tile")
                                : fmt::format("`split` finds {}", counted(result.found, "part"));
  if (parts == 0)
    throw DataError(fmt::format("{}, none of them with {} {} or more", all, grouped(options.min_size), of));
  if (parts > options.most_parts)
    throw DataError(fmt::format("{}, more than {}: {}", all, grouped(options.most_parts),
                                of == "triangles"
                                    ? "`weld = 0` before it joins coincident vertices, `min_size` drops small parts"
                                    : "a larger `split_distance` joins more, `min_size` drops small parts"));
  if (parts < result.found)
    result.notes.push_back(
        {.code = "small_parts",
         .text = fmt::format("{} of fewer than {} {} dropped", counted(result.found - parts, tiles ? "tile" : "part"),
                             grouped(options.min_size), of)});
}

SplitResult split_mesh(const TriangleMesh& mesh, const SplitOptions& options) {
  SplitResult result;
  const MeshComponents components = find_components(mesh);
  std::vector<std::size_t> triangles(components.size());
  for (const std::uint32_t c : components.of_triangle) ++triangles[c];
  const std::size_t parts = large_enough(triangles, options);
  result.found = components.size();
  check_parts(parts, options, "triangles", result);
  if (parts > kFewParts && 2 * parts > mesh.triangles.size())
    result.notes.push_back({.code = "soup",
                            .text = fmt::format("{} of {}: triangles that share no vertex are separate parts",
                                                counted(parts, "part"), counted(mesh.triangles.size(), "triangle")),
                            .remedy = "`weld = 0` before `split` joins coincident vertices"});
  std::vector<TriangleMesh> meshes = split_components(mesh, components);
  std::size_t vertices = 0;
  for (const TriangleMesh& m : meshes) vertices += m.vertices.size();
  if (vertices < mesh.vertices.size())
    result.notes.push_back(
        {.code = "loose_points",
         .text = fmt::format("{} without triangles dropped", counted(mesh.vertices.size() - vertices, "point"))});
  for (std::size_t c = 0; c < meshes.size(); ++c) {
    if (triangles[c] < options.min_size) continue;
    CloudOrMesh part{PointSet{}};
    part.is_mesh = true;
    part.mesh = std::move(meshes[c]);
    result.parts.push_back(std::move(part));
  }
  return result;
}

SplitResult split_cloud(const PointSet& points, const SplitOptions& options, Progress& progress) {
  SplitResult result;
  result.distance = options.split_distance ? *options.split_distance : kSpacingsApart * estimate_spacing(points);
  const CloudComponents components = find_cloud_components(points.positions, *result.distance, progress);
  const std::size_t parts = large_enough(components.points, options);
  result.found = components.size();
  check_parts(parts, options, "points", result);
  std::vector<std::vector<std::uint32_t>> rows(components.size());
  for (std::size_t i = 0; i < components.of_point.size(); ++i)
    rows[components.of_point[i]].push_back(static_cast<std::uint32_t>(i));
  for (std::size_t c = 0; c < parts; ++c)  // sorted by size
    result.parts.emplace_back(take_samples(points, rows[c]));
  return result;
}

/// Tile of a coordinate, in multiples of the size. One below a border by no more than its rounding is on the border.
double tile_of(double origin, float position, double size) {
  const double x = origin + static_cast<double>(position);
  const double rounding = std::abs(static_cast<double>(position)) * 0x1p-24 + std::abs(x) * 0x1p-50;
  const double tile = std::floor(x / size);
  return (tile + 1) * size - x <= rounding ? tile + 1 : tile;
}

SplitResult split_into_tiles(const PointSet& points, const SplitOptions& options) {
  const double size = *options.tile_size;
  std::map<std::pair<double, double>, std::vector<std::uint32_t>> rows;  // by row and column
  std::vector<std::uint32_t>* last = nullptr;
  std::pair<double, double> cell;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3f& p = points.positions[i];
    if (!is_finite(p)) throw DataError("there are positions that are not finite: they are in no tile");
    const std::pair at{tile_of(points.origin.y, p.y, size), tile_of(points.origin.x, p.x, size)};
    if (!last || at != cell) {
      last = &rows[at], cell = at;
      check_tile_count(static_cast<double>(rows.size()), static_cast<double>(options.most_parts));
    }
    last->push_back(static_cast<std::uint32_t>(i));
  }
  SplitResult result;
  result.tile_size = size;
  result.found = rows.size();
  std::vector<std::size_t> sizes;
  sizes.reserve(rows.size());
  for (const auto& [at, samples] : rows) sizes.push_back(samples.size());
  check_parts(large_enough(sizes, options), options, "points", result);
  for (const auto& [at, samples] : rows) {
    if (samples.size() < options.min_size) continue;
    result.parts.emplace_back(take_samples(points, samples));
    result.places.push_back(corner_words(at.second * size, at.first * size));
  }
  check_corners(result.places);
  return result;
}

}  // namespace

const OptionSchema& SplitOptions::schema() {
  using O = SplitOptions;
  static constexpr OptionRow rows[] = {
      option<&O::tile_size>({.text = "Write square tiles of this size as separate files, named by their lower left "
                                     "corner: NAME_512000_5403000.laz. Their borders are multiples of the size",
                             .unit = "length",
                             .from_data = "one file",
                             .range = positive()}),
      option<&O::split_distance>({.text = "For clouds: points no farther apart than this are connected",
                                  .unit = "length",
                                  .from_data = "4 spacings",
                                  .range = positive()}),
      option<&O::min_size>({.text = "Drop parts of fewer triangles (or points)", .range = at_least(0)})};
  return option_schema<rows>();
}

void SplitOptions::validate() const {
  validate_options(*this);
  if (tile_size && split_distance) throw ArgumentError("`split_distance` is for connected parts, not for tiles");
}

SplitResult split(const CloudOrMesh& data, const SplitOptions& options, Progress& progress) {
  options.validate();
  progress.begin("split");
  if (options.tile_size) {
    if (data.is_mesh) throw DataError("`tile_size` is for points and height grids; `box` cuts meshes");
    return split_into_tiles(data.points, options);
  }
  return data.is_mesh ? split_mesh(data.mesh, options) : split_cloud(data.points, options, progress);
}

const ReportSchema& SplitResult::schema() {
  static constexpr ReportRow rows[] = {
      reported<&SplitResult::found>({.name = "parts.found", .text = "Parts, dropped ones included"}),
      reported<&SplitResult::distance>({.name = "parts.distance",
                                        .text = "For clouds: points no farther apart than this are connected",
                                        .unit = "length"}),
      reported<&SplitResult::tile_size>({.name = "parts.tile_size", .text = "Size of tiles", .unit = "length"})};
  return report_schema<rows>();
}

std::vector<std::string> summary_of(const SplitResult& made) {
  if (made.tile_size) return {fmt::format("{} of {:.10g}", counted(made.found, "tile"), *made.tile_size)};
  if (!made.distance) return {counted(made.found, "part")};
  return {fmt::format("{} at a distance of {}", counted(made.found, "part"), length_words(*made.distance))};
}

}  // namespace sansmesh::inline v1
