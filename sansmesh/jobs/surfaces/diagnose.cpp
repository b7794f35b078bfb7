#include "sansmesh/pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/function/diagnose_function.h"
#include "sansmesh/functions.h"
#include "sansmesh/jobs/pictures/region_pictures.h"

namespace sansmesh::inline v1 {
namespace {

/// Size of a picture on a sheet in pixels, and the largest number of pictures.
constexpr int kTileWidth = 360, kTileHeight = 270;
constexpr std::size_t kMostOnSheet = 1600;

std::vector<ListedRegion> listed_regions(const Diagnosis& d) {
  std::vector<ListedRegion> listed;
  std::size_t steps = 0;
  for (const SuspiciousRegion& p : d.regions) {
    listed.push_back({p, 0, {}});
    if (p.edit) listed.back().step = ++steps;
  }
  std::stable_sort(listed.begin(), listed.end(),
                   [](const ListedRegion& x, const ListedRegion& y) { return x.region.kind < y.region.kind; });
  for (std::size_t i = 0; i < listed.size(); ++i) listed[i].number = i + 1;
  return listed;
}

}  // namespace

std::string ListedRegion::worst_words() const {
  switch (region.kind) {
    case Suspicion::low_coverage:
      return fmt::format("coverage down to {:.2f}", region.worst);
    case Suspicion::high_error:
      return "error up to " + length_words(region.worst);
    case Suspicion::extra_sheet:
      return "area " + length_words(region.worst);
    case Suspicion::steep:
      return fmt::format("gradient up to {:.2f}", region.worst);
  }
  return {};
}

DiagnoseResult diagnose(const SurfaceFunction& function, const DiagnoseOptions& options, Progress& progress) {
  DiagnoseResult result;
  result.fits = function.fitted().field.report().functions;
  result.diagnosis = diagnose_function(function.fitted(), options, progress);
  result.regions = listed_regions(result.diagnosis);
  result.edits = result.diagnosis.edits();
  return result;
}

namespace {

/// Position, rounded to a hundredth of the radius.
std::string where(const SuspiciousRegion& p) {
  const int digits = index_in<int>(std::ceil(2 - std::log10(std::max(1e-300, p.radius))), 0, 12);
  return fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", p.position.x, digits, p.position.y, digits, p.position.z, digits);
}

std::string line_of(const ListedRegion& listed, bool steps) {
  const SuspiciousRegion& p = listed.region;
  return fmt::format("{:>4} at {}, radius {}: {}, {}{}", listed.number, where(p), length_words(p.radius),
                     listed.worst_words(), counted(p.supports, "fit"),
                     steps && listed.step ? fmt::format("; step {}", *listed.step) : "");
}

}  // namespace

std::vector<std::string> summary_of(const DiagnoseResult& made, bool steps) {
  const Diagnosis& d = made.diagnosis;
  std::vector<std::string> lines{fmt::format("largest gradient around the surface {:.2f}", d.largest_gradient)};
  auto next = made.regions.begin();
  for (std::size_t k = 0; k < kSuspicions; ++k) {
    const auto kind = static_cast<Suspicion>(k);
    const std::string extra =
        kind == Suspicion::high_error ? fmt::format(" (above {})", length_words(d.error_above)) : "";
    lines.push_back(titled(suspicion_name(kind), (d.found[k] == 0 ? "nowhere" : counted(d.found[k], "place")) + extra));
    std::size_t shown = 0;
    for (; next != made.regions.end() && next->region.kind == kind; ++next, ++shown)
      lines.push_back(line_of(*next, steps));
    if (shown < d.found[k])
      lines.push_back(
          fmt::format("     and {} more: `places = {}` lists all", grouped(d.found[k] - shown), d.found[k]));
  }
  return lines;
}

std::vector<Image> draw_regions(const DiagnoseResult& made, RenderOptions options, bool sheet, Progress& progress) {
  if (made.regions.empty()) return {};
  if (sheet) {
    if (made.regions.size() > kMostOnSheet)
      throw ArgumentError(fmt::format("{} are too many for one sheet: use `separate`, or fewer `places`",
                                      counted(made.regions.size(), "place")));
    options.view.width = kTileWidth, options.view.height = kTileHeight;
  }
  const RegionPictures views(made.diagnosis);
  std::vector<Image> pictures;
  pictures.reserve(made.regions.size());
  for (const ListedRegion& p : made.regions)
    pictures.push_back(views.of(p.region,
                                fmt::format("{}  {}\n{}", p.number, suspicion_name(p.region.kind), p.worst_words()),
                                options, progress));
  if (sheet && !pictures.empty()) pictures = {contact_sheet(pictures)};
  return pictures;
}

const ReportSchema& ListedRegion::schema() {
  static constexpr ReportRow rows[] = {
      reported<&ListedRegion::number>({.text = "Number in the list"}),
      reported<[](const ListedRegion& r) { return suspicion_name(r.region.kind); }>(
          {.name = "kind", .text = "Kind of doubt"}),
      reported<[](const ListedRegion& r) { return r.region.position; }>(
          {.name = "at", .text = "Centre of the region", .unit = "length"}),
      reported<[](const ListedRegion& r) { return r.region.normal; }>(
          {.name = "normal", .text = "Normal of the surface"}),
      reported<[](const ListedRegion& r) { return r.region.radius; }>(
          {.name = "radius", .text = "Radius of a ball around the region", .unit = "length"}),
      reported<[](const ListedRegion& r) { return r.region.supports; }>(
          {.name = "fits", .text = "Local fits in the region"}),
      reported<[](const ListedRegion& r) { return r.region.worst; }>(
          {.name = "worst", .text = "Worst coverage, error, area or gradient"}),
      reported<[](const ListedRegion& r) { return r.region.edit.has_value(); }>(
          {.name = "edit", .text = "Whether an edit may repair it"}),
      reported<&ListedRegion::step>({.text = "Number of the edit in the script"})};
  return report_schema<rows>();
}

namespace {

ReportCounts counted_kinds(const DiagnoseResult& made) {
  ReportCounts counts;
  for (std::size_t k = 0; k < kSuspicions; ++k)
    counts.emplace_back(suspicion_name(static_cast<Suspicion>(k)), static_cast<std::int64_t>(made.diagnosis.found[k]));
  return counts;
}

}  // namespace

const ReportSchema& DiagnoseResult::schema() {
  static constexpr ReportRow rows[] = {
      reported<&DiagnoseResult::fits>({.name = "input.fits", .text = "Local fits of the function"}),
      reported<[](const DiagnoseResult& r) { return r.diagnosis.error_above; }>(
          {.name = "error_above", .text = "Error above which a region is doubtful", .unit = "length"}),
      reported<[](const DiagnoseResult& r) { return r.diagnosis.largest_gradient; }>(
          {.name = "largest_gradient", .text = "Largest gradient around the surface"}),
      reported<[](const DiagnoseResult& r) { return counted_kinds(r); }>(
          {.name = "found", .text = "Regions of each kind, including unlisted ones"}),
      reported<[](const DiagnoseResult& r) { return r.edits.size(); }>({.name = "edits", .text = "Proposed edits"}),
      reported<&DiagnoseResult::regions>({.name = "places", .text = "Regions by kind, the largest first"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
