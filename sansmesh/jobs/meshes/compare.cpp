#include "sansmesh/attribute_table.h"
#include "sansmesh/inspect.h"
#include "sansmesh/measure/distance_map.h"
#include "sansmesh/option.h"
#include "sansmesh/triangle_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/data/reference_system.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/measure/points_signed_distance.h"
#include "sansmesh/mesh/edit/refine_edges.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/points/statistics/spacing.h"

namespace sansmesh::inline v1 {
namespace {

/// Mean edge length, as a share of the diagonal, above which a map of vertices is coarse.
constexpr double kCoarse = 0.02;

bool is_coarse(const TriangleMesh& mesh, double diagonal) {
  double edges = 0;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges += norm(Vec3(mesh.vertices[t[k]]) - Vec3(mesh.vertices[t[(k + 1) % 3]]));
  return !mesh.triangles.empty() && edges / (3 * static_cast<double>(mesh.triangles.size())) > kCoarse * diagonal;
}

/// Splits large triangles if requested.
void refine(TriangleMesh& mesh, const std::string& name, const std::optional<double>& edge, double diagonal,
            Progress& progress, std::vector<Note>& notes) {
  if (edge) {
    progress.begin("refine");
    if (!refine_edges(mesh, *edge))
      notes.push_back(
          {.code = "edges_stay_long",
           .text = fmt::format("edges stay longer than {}: more than 20 million triangles", length_words(*edge)),
           .of = name});
  } else if (is_coarse(mesh, diagonal)) {
    notes.push_back({.code = "coarse",
                     .text = "has large triangles, and only their corners are compared",
                     .remedy = "`refine` cuts them up",
                     .of = name});
  }
}

/// Sampling of points; nothing for other surfaces.
std::optional<ComparedPoints> sampling_of(const AnySurface& surface, bool mapped, Progress& progress,
                                          std::vector<Note>& notes) {
  if (surface.kind() != AnySurface::Kind::points) return std::nullopt;
  const std::shared_ptr<const TriangleMesh> mesh = surface.mesh(progress, notes);
  PointSet points;
  points.positions = mesh->vertices;
  ComparedPoints found{.spacing = estimate_spacing(points), .noise = measure_noise(points)};
  const double noise = found.noise.known ? found.noise.deviation : found.noise.most;
  found.own_rms = mapped ? noise : rms_to_samples(found.spacing, noise, !mesh->normals.empty());
  return found;
}

}  // namespace

const OptionSchema& CompareOptions::schema() {
  using O = CompareOptions;
  static const OptionRow rows[] = {
      option_group<&O::map>(DistanceMapOptions::schema().rows),
      option<&O::on>({.text = "Draw the map on the part or the reference; the sign stays the part's",
                      .unit = "choice",
                      .choices = kSideWords}),
      option<&O::refine>(
          {.text = "First halve edges of the mapped mesh until none is longer", .unit = "length", .range = positive()}),
      option<&O::align>({.text = "First move the part onto the reference"}),
      option_group<&O::alignment>(SurfaceAlignmentOptions::schema().rows)};
  return option_schema<rows>();
}

void CompareOptions::validate() const {
  validate_options(*this);
  if (align) return;
  if (const auto set = options_set(alignment); !set.empty())
    throw ArgumentError(fmt::format("`{}` needs `align`", set.front()));
}

CompareResult compare(const AnySurface& part, const AnySurface& reference, const CompareOptions& options,
                      Progress& progress) {
  options.validate();
  const bool reversed = options.on == MapSide::reference;
  if (options.align && part.field() && reversed)
    throw ArgumentError("`align` moves meshes and points: with `on = reference`, the part may not be a function");
  require_same_system(part.reference(), part.name(), reference.reference(), reference.name());
  CompareResult result;
  CompareReport& r = result.report;
  r.on = options.on, r.within = options.map.within;
  AnySurface moved = part, still = reference;
  if (options.align) {
    AlignResult aligned = sansmesh::align(part, reference, options.alignment, progress);
    moved = AnySurface(std::move(aligned.moved), part.name());
    // avoids meshing the isosurface twice
    if (reference.kind() == AnySurface::Kind::isosurface) still = AnySurface(*aligned.fixed, reference.name());
    r.alignment = std::move(aligned.report);
    r.motion = aligned.motion;
    result.notes = std::move(aligned.notes);
  }
  const AnySurface& mapped = reversed ? still : moved;
  const AnySurface& other = reversed ? moved : still;
  result.mesh = *mapped.mesh(progress, result.notes);
  r.diagonal = reference.bounds().diagonal();
  refine(result.mesh, mapped.name(), options.refine, r.diagonal, progress, result.notes);

  progress.begin("prepare");
  const std::shared_ptr<const SignedDistance> distance = other.distance(progress, result.notes);
  DistanceMapOptions map = options.map;
  map.reversed = reversed;
  if (!map.max_distance && r.diagonal > 0) map.max_distance = 0.1 * r.diagonal;
  result.map = with_name(mapped.name(), [&] { return distance_map(result.mesh, *distance, map, progress); });
  r.part_points = sampling_of(moved, !reversed, progress, result.notes);
  r.reference_points = sampling_of(still, reversed, progress, result.notes);
  if (!result.map.has_sides)
    result.notes.push_back({.code = "no_sign",
                            .text = "distances have no sign: " + other.name() + " is points without normals",
                            .of = mapped.name()});
  apply_map(result.mesh, result.map, result.map.statistics.range);
  return result;
}

const ReportSchema& ComparedPoints::schema() {
  static constexpr ReportRow rows[] = {
      reported<&ComparedPoints::spacing>({.text = "Spacing of the points", .unit = "length"}),
      reported_inline<&ComparedPoints::noise>(),
      reported<&ComparedPoints::own_rms>(
          {.text = "Root mean square of the distances that noise and sampling cause alone", .unit = "length"})};
  return report_schema<rows>();
}

const ReportSchema& CompareReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<&CompareReport::on>({.text = "Side that carries the map", .choices = kSideWords}),
      reported<&CompareReport::within>({.text = "Requested tolerance", .unit = "length"}),
      reported<&CompareReport::diagonal>(
          {.name = "reference.diagonal", .text = "Diagonal of the reference's box", .unit = "length"}),
      reported<&CompareReport::part_points>({.name = "part.sampling", .text = "Sampling of a part of points"}),
      reported<&CompareReport::reference_points>(
          {.name = "reference.sampling", .text = "Sampling of a reference of points"}),
      reported<&CompareReport::alignment>({.text = "Alignment of the part"}),
      reported<[](const CompareReport& r) { return value_if(r.alignment.has_value(), r.motion.rows()); }>(
          {.name = "matrix", .text = "Motion as 4 rows of 4 numbers"})};
  return report_schema<rows>();
}

const ReportSchema& CompareResult::schema() {
  static constexpr ReportRow rows[] = {reported_inline<&CompareResult::map>(),
                                       reported_inline<&CompareResult::report>()};
  return report_schema<rows>();
}

namespace {

void add_statistics(const DistanceMap& map, const std::optional<double>& tolerance, std::vector<std::string>& lines) {
  const DistanceStatistics& s = map.statistics;
  const auto line = [&](const char* title, const std::string& text) { lines.push_back(titled(title, text)); };
  if (map.has_sides)
    line("signed", fmt::format("mean {:+.4g}, standard deviation {}, 5 % below {:+.4g}, half below {:+.4g}, "
                               "95 % below {:+.4g}",
                               s.mean, length_words(s.deviation), s.p05, s.median, s.p95));
  line("absolute", fmt::format("mean {}, rms {}, 95 % below {}", length_words(s.mean_absolute), length_words(s.rms),
                               length_words(s.p95_absolute)));
  if (map.has_sides && s.lowest < 0)
    line("farthest inside", fmt::format("{:+.4g} at {}", s.lowest, point_words(s.lowest_at)));
  if (s.highest > 0)
    line(map.has_sides ? "and outside" : "farthest",
         fmt::format("{:+.4g} at {}", s.highest, point_words(s.highest_at)));
  if (s.within_tolerance)
    line("tolerance", fmt::format("{:.3f} % within ±{}", 100 * *s.within_tolerance, length_words(*tolerance)));
}

void add_sampling(const char* side, const std::optional<ComparedPoints>& points, std::vector<std::string>& lines) {
  if (!points) return;
  lines.push_back(titled(side, fmt::format("points {} apart, noise {}: alone they cause rms {}{}",
                                           length_words(points->spacing), noise_words(points->noise, points->spacing),
                                           points->noise.known ? "" : "up to ", length_words(points->own_rms))));
}

}  // namespace

std::vector<std::string> summary_of(const CompareResult& made, const CompareOptions& options,
                                    const std::string& other) {
  const DistanceMap& map = made.map;
  std::vector<std::string> lines;
  if (made.report.alignment) lines = summary_of(*made.report.alignment);
  if (map.measured > 0) add_statistics(map, options.map.within, lines);
  add_sampling("part", made.report.part_points, lines);
  add_sampling("reference", made.report.reference_points, lines);
  const auto line = [&](const char* title, std::size_t count, const std::string& what) {
    if (count > 0) lines.push_back(titled(title, grouped(count) + " " + what));
  };
  line("left out", map.beyond, fmt::format("farther off than {} (grey)", length_words(map.max_distance)));
  line("not found", map.not_found, "from where no surface was found (grey)");
  line("borders", map.at_border,
       fmt::format("closest to the border of {}{}", other,
                   options.map.skip_border ? " (left out, grey)" : ": `skip_border` leaves them out"));
  line("unused", map.not_finite, "that no triangle uses");
  return lines;
}

std::vector<std::string> histogram_of(const DistanceMap& map) {
  const DistanceStatistics& s = map.statistics;
  const double most = *std::max_element(s.histogram.begin(), s.histogram.end());
  const double low = map.has_sides ? -s.range : 0, width = (s.range - low) / static_cast<double>(s.histogram.size());
  std::vector<std::string> lines;
  const auto line = [&](const std::string& where, double share) {
    const int bar = most > 0 ? index_in<int>(std::round(50 * share / most), 0, 50) : 0;
    lines.push_back(fmt::format("{:>23} {:8.3f} % {:#<{}}", where, 100 * share, "", bar));
  };
  if (map.has_sides) line(fmt::format("below {:.4g}", low), s.below_range);
  for (std::size_t i = 0; i < s.histogram.size(); ++i)
    line(
        fmt::format("{:.4g} .. {:.4g}", low + width * static_cast<double>(i), low + width * static_cast<double>(i + 1)),
        s.histogram[i]);
  line(fmt::format("above {:.4g}", s.range), s.above_range);
  return lines;
}

}  // namespace sansmesh::inline v1
