#include "sansmesh/convert.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/points/close_points.h"
#include "sansmesh/points/spacing.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kSpacingsApart = 4;
/// Of a few parts nobody wonders why they are so many.
constexpr std::size_t kFewParts = 10;

std::size_t large_enough(const std::vector<std::size_t>& sizes, const SplitOptions& options) {
  return static_cast<std::size_t>(
      std::count_if(sizes.begin(), sizes.end(), [&](std::size_t n) { return n >= options.min_size; }));
}

/// Throws DataError unless there are some parts, and not too many. `of`: "triangles".
void check_parts(std::size_t parts, const SplitOptions& options, const std::string& of, SplitResult& result) {
  const std::string all = fmt::format("`split` finds {}", counted(result.found, "part"));
  if (parts == 0) throw DataError(fmt::format("{}, none of them of {} {} or more", all, grouped(options.min_size), of));
  if (parts > options.most_parts)
    throw DataError(fmt::format("{}, more than {}: {}", all, grouped(options.most_parts),
                                of == "triangles"
                                    ? "`weld = 0` before joins what only touches, `min_size` leaves out small ones"
                                    : "`split_distance` joins more, `min_size` leaves out small ones"));
  if (parts < result.found)
    result.notes.push_back({.code = "small_parts",
                            .text = fmt::format("{} of fewer than {} {} left out",
                                                counted(result.found - parts, "part"), grouped(options.min_size), of),
                            .remedy = {}});
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
                            .text = fmt::format("{} of {}: triangles that share no vertex are parts of their own",
                                                counted(parts, "part"), counted(mesh.triangles.size(), "triangle")),
                            .remedy = "`weld = 0` before `split` joins those that touch"});
  std::vector<TriangleMesh> meshes = split_components(mesh, components);
  std::size_t vertices = 0;
  for (const TriangleMesh& m : meshes) vertices += m.vertices.size();
  if (vertices < mesh.vertices.size())
    result.notes.push_back(
        {.code = "loose_points",
         .text = fmt::format("{} of no triangle left out", counted(mesh.vertices.size() - vertices, "point")),
         .remedy = {}});
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
  for (std::size_t c = 0; c < parts; ++c)  // those of fewer points come last
    result.parts.emplace_back(take_samples(points, rows[c]));
  return result;
}

}  // namespace

const OptionSchema& SplitOptions::schema() {
  using O = SplitOptions;
  static constexpr OptionRow rows[] = {
      option<&O::split_distance>({.text = "Of clouds: points as close as this are connected",
                                  .unit = "length",
                                  .from_data = "4 spacings",
                                  .range = positive()}),
      option<&O::min_size>({.text = "Leave out parts of fewer triangles (or points)", .range = at_least(0)})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void SplitOptions::validate() const { validate_options(*this); }

SplitResult split(const CloudOrMesh& data, const SplitOptions& options, Progress& progress) {
  options.validate();
  progress.begin("split");
  return data.is_mesh ? split_mesh(data.mesh, options) : split_cloud(data.points, options, progress);
}

namespace {

constexpr ReportRow kSplitResultRows[] = {
    reported<&SplitResult::found>({.name = "parts.found", .text = "Parts, those that were left out among them"}),
    reported<&SplitResult::distance>(
        {.name = "parts.distance", .text = "Points as close as this are connected, of clouds", .unit = "length"})};

}  // namespace

const ReportSchema& SplitResult::schema() {
  static constexpr ReportSchema schema{kSplitResultRows};
  return schema;
}

std::vector<std::string> summary_of(const SplitResult& made) {
  if (!made.distance) return {counted(made.found, "part")};
  return {fmt::format("{} at a distance of {}", counted(made.found, "part"), length_words(*made.distance))};
}

}  // namespace sansmesh::inline v1
