#include "sansmesh/points/normals/given_normals.h"

#include <fmt/core.h>

#include <vector>

#include "sansmesh/core/number_words.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/points/orientation/orient_words.h"
#include "sansmesh/points/statistics/spacing.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kMostFacingAway = 0.1;  ///< share of the normals, if a sensor is known for all samples
constexpr double kNearlyAll = 0.95;

std::string percent_words(double share) { return fmt::format("{:.2g} %", 100 * share); }

/// Description of signs that neighbours confirm although some are wrong.
std::string uncertain_words(const OrientationReport& r) {
  std::string why;
  if (r.doubt > 0)
    why = fmt::format("winding numbers contradict them around {} of the samples", percent_words(r.doubt));
  if (1 - r.agreement > 0.0005)
    why += fmt::format("{}{} of the neighbour relations contradict them", why.empty() ? "" : ", ",
                       percent_words(1 - r.agreement));
  return "orientation uncertain: " + why;
}

}  // namespace

GivenNormals judge_normals(const OrientationReport& r) {
  GivenNormals given;
  given.oriented = (r.check == OrientationCheck::oriented || r.check == OrientationCheck::inward) && r.certain();
  if (r.check == OrientationCheck::missing)
    given.words = "none";
  else if (r.related < kLeastRelated)
    given.words = "not oriented: unrelated to those of neighbouring samples";
  else if (r.check == OrientationCheck::unoriented)
    given.words = fmt::format("not oriented consistently{}",
                              r.agreement < kNearlyAll ? fmt::format(": {} of the neighbour relations contradict them",
                                                                     percent_words(1 - r.agreement))
                                                       : std::string());
  else if (!r.certain())
    given.words = uncertain_words(r);
  else if (r.open > kNearlyAll)
    given.words = "oriented consistently; the surface is open, it has no outside";
  else if (r.outward > kNearlyAll)
    given.words = "oriented outward";
  else if (r.inward > kNearlyAll)
    given.words = "oriented inward";
  else
    given.words = fmt::format("oriented consistently: {} of the samples outward, {} inward, {} in open parts",
                              percent_words(r.outward), percent_words(r.inward), percent_words(r.open));
  given.report = r;
  return given;
}

GivenNormals judge_normals(const PointSet& points, double noise) {
  const OrientationReport report = measure_orientation(points, noise);
  GivenNormals given = judge_normals(report);
  if (report.check == OrientationCheck::missing || report.related < kLeastRelated) return given;
  const double spacing = estimate_spacing(points);
  const auto neighbours = static_cast<std::size_t>(choose_neighbours(spacing, noise));
  if (given.oriented && noise > spacing && 2 * neighbours > points.size()) {
    given.words = fmt::format(
        "consistent, but the surface is undetermined: with noise of {:.1f} spacings, neighbours are {} of {} "
        "points",
        noise / spacing, grouped(neighbours), grouped(points.size()));
    return given;
  }
  const bool consistent = report.check != OrientationCheck::unoriented;
  for (const OrientBy by : kOrientationOrder) {
    if (by == OrientBy::up && consistent) break;  // a guess, in contrast to the other sources
    const std::vector<Vec3f> directions = find_own_sensor_directions(points, by, noise);
    if (directions.empty()) continue;
    const double away = share_facing_away(points, directions);
    if (away >= kMostFacingAway) continue;
    given.oriented = true;
    given.words = fmt::format("oriented {}, but for {}", orientation_words(by), percent_words(away));
    given.oriented_by = by;
    given.looking_away = away;
    break;
  }
  return given;
}

namespace {

bool has_normals(const GivenNormals& given) { return given.report.check != OrientationCheck::missing; }

/// Absent without normals.
std::optional<double> of_normals(const GivenNormals& given, double share) {
  return value_if(has_normals(given), share);
}

constexpr ReportRow kGivenNormalsRows[] = {
    reported<&GivenNormals::oriented>({.text = "Whether the signs are consistent"}),
    reported<[](const GivenNormals& r) { return of_normals(r, r.report.agreement); }>(
        {.name = "agreement",
         .text = "Share of the relations between neighbouring normals that confirm their signs",
         .unit = "share"}),
    reported<[](const GivenNormals& r) { return of_normals(r, r.report.related); }>(
        {.name = "related", .text = "Share of the normals correlated with those of their neighbours", .unit = "share"}),
    reported<[](const GivenNormals& r) { return of_normals(r, r.report.outward); }>(
        {.name = "outward",
         .text = "Share of the samples in closed parts whose normals point outward",
         .unit = "share"}),
    reported<[](const GivenNormals& r) { return of_normals(r, r.report.inward); }>(
        {.name = "inward", .text = "Share of the samples in closed parts whose normals point inward", .unit = "share"}),
    reported<[](const GivenNormals& r) { return of_normals(r, r.report.open); }>(
        {.name = "open", .text = "Share of the samples in parts without an outside", .unit = "share"}),
    reported<[](const GivenNormals& r) { return value_if(has_normals(r), r.oriented_by || r.report.certain()); }>(
        {.name = "certain", .text = "Whether the orientation is certain"}),
    reported<[](const GivenNormals& r) { return of_normals(r, r.report.doubt); }>(
        {.name = "doubt",
         .text = "Share of the samples whose winding number contradicts the normals",
         .unit = "share"}),
    reported<&GivenNormals::oriented_by>({.text = "Sensor that the normals face", .choices = kOrientByWords}),
    reported<[](const GivenNormals& r) { return value_if(r.oriented_by.has_value(), r.looking_away); }>(
        {.name = "looking_away", .text = "Share of the normals facing away from the sensor", .unit = "share"})};

}  // namespace

const ReportSchema& GivenNormals::schema() {
  static constexpr ReportSchema schema{kGivenNormalsRows};
  return schema;
}

}  // namespace sansmesh::inline v1
