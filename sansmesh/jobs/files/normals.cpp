#include "sansmesh/points/normals/normals.h"
#include "sansmesh/option.h"
#include "sansmesh/points.h"
#include "sansmesh/points/normals/given_normals.h"
#include "sansmesh/points/statistics/noise.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/points/cleaning/duplicates.h"
#include "sansmesh/points/orientation/orient_words.h"
#include "sansmesh/points/orientation/orientation.h"
#include "sansmesh/points/statistics/spacing.h"

namespace sansmesh::inline v1 {

const OptionSchema& NormalsOptions::schema() {
  using O = NormalsOptions;
  static const OptionRow rows[] = {
      option_group<&O::estimation>(NormalOptions::schema().rows),
      option<&O::orient_only>(
          {.text = "Orient the normals of the file instead of estimating new ones", .old_name = "keep"}),
      option<&O::orient>({.text = "Do not orient the normals"}),
      option<&O::orient_by>({.text = "Source of the signs of normals",
                             .unit = "choice",
                             .from_data = "the first available",
                             .choices = kOrientByWords})};
  return option_schema<rows>();
}

void NormalsOptions::validate() const {
  validate_options(*this);
  estimation.validate();
  if (!orient && orient_by != OrientBy::automatic) throw ArgumentError("`orient_by` needs `orient`");
}

NormalsResult normals(PointSet points, const NormalsOptions& options, Progress& progress) {
  options.validate();
  if (options.orient_only && !points.has_normals())
    throw DataError("has no normals to orient; without `orient_only` they are estimated");
  if (count_unique(points) < 3) throw DataError("has fewer than 3 different points: normals need neighbours");

  NormalsResult result;
  result.points = std::move(points);
  PointSet& made = result.points;
  NormalsReport& r = result.report;
  progress.begin("spacing and noise");
  NormalOptions estimation = options.estimation;
  r.spacing = estimate_spacing(made);
  r.noise = measure_noise(made);
  if (!estimation.spacing) estimation.spacing = r.spacing;
  if (!estimation.noise) estimation.noise = r.noise.deviation;
  if (!options.orient_only) {
    r.neighbours = estimation.neighbours.value_or(choose_neighbours(*estimation.spacing, *estimation.noise));
    estimate_normals(made, estimation, progress);
  }
  if (options.orient)
    r.oriented_by = orient_normals(made, {.noise = estimation.noise, .by = options.orient_by}, progress);
  progress.begin("check normals");
  r.check = judge_normals(made, r.noise.deviation);
  r.unknown = static_cast<std::size_t>(std::count(made.normals.begin(), made.normals.end(), Vec3f{}));
  return result;
}

const ReportSchema& NormalsReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<&NormalsReport::spacing>({.text = "Spacing of the samples", .unit = "length"}),
      reported_inline<&NormalsReport::noise>(),
      reported<&NormalsReport::neighbours>({.text = "Neighbours of each sample, for new normals"}),
      reported<[](const NormalsReport& r) { return r.check.oriented; }>(
          {.name = "oriented", .text = "Whether the signs are consistent"}),
      reported<&NormalsReport::check>({.name = "orientation", .text = "Orientation of the normals"}),
      reported<&NormalsReport::oriented_by>(
          {.text = "Source of the signs; null if they were not changed", .choices = kOrientByWords}),
      reported<&NormalsReport::unknown>({.text = "Samples with undefined normals, set to zero"})};
  return report_schema<rows>();
}

std::vector<std::string> summary_of(const NormalsResult& made) {
  const NormalsReport& r = made.report;
  const std::string signs =
      r.oriented_by ? "signs " + std::string(orientation_words(*r.oriented_by)) : "signs unchanged";
  return {
      fmt::format("{}, spacing {}, noise {}", counted(made.points.size(), "point"), length_words(r.spacing),
                  noise_words(r.noise, r.spacing)),
      fmt::format("normals {}, {}{}", r.neighbours ? fmt::format("from {} neighbours", *r.neighbours) : "of the file",
                  signs, r.unknown > 0 ? fmt::format(", {} unknown (zero)", grouped(r.unknown)) : ""),
      "checked: " + std::string(r.check.words)};
}

}  // namespace sansmesh::inline v1
