#include "sansmesh/pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/function/diagnose_function.h"
#include "sansmesh/functions.h"
#include "sansmesh/jobs/place_pictures.h"

namespace sansmesh::inline v1 {
namespace {

/// Size of a picture on a sheet in pixels, and the largest number of pictures.
constexpr int kTileWidth = 360, kTileHeight = 270;
constexpr std::size_t kMostOnSheet = 1600;

std::vector<ListedPlace> listed_places(const Diagnosis& d) {
  std::vector<ListedPlace> listed;
  std::size_t steps = 0;
  for (const SuspiciousPlace& p : d.places) {
    listed.push_back({p, 0, {}});
    if (p.edit) listed.back().step = ++steps;
  }
  std::stable_sort(listed.begin(), listed.end(),
                   [](const ListedPlace& x, const ListedPlace& y) { return x.place.kind < y.place.kind; });
  for (std::size_t i = 0; i < listed.size(); ++i) listed[i].number = i + 1;
  return listed;
}

}  // namespace

std::string ListedPlace::worst_words() const {
  switch (place.kind) {
    case Suspicion::low_coverage:
      return fmt::format("coverage down to {:.2f}", place.worst);
    case Suspicion::high_error:
      return "error up to " + length_words(place.worst);
    case Suspicion::extra_sheet:
      return "area " + length_words(place.worst);
    case Suspicion::steep:
      return fmt::format("gradient up to {:.2f}", place.worst);
  }
  return {};
}

DiagnoseResult diagnose(const SurfaceFunction& function, const DiagnoseOptions& options, Progress& progress) {
  DiagnoseResult result;
  result.fits = function.fitted().field.report().functions;
  result.diagnosis = diagnose_function(function.fitted(), options, progress);
  result.places = listed_places(result.diagnosis);
  result.edits = result.diagnosis.edits();
  return result;
}

namespace {

/// Position, rounded to a hundredth of the radius.
std::string where(const SuspiciousPlace& p) {
  const int digits = index_in<int>(std::ceil(2 - std::log10(std::max(1e-300, p.radius))), 0, 12);
  return fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", p.position.x, digits, p.position.y, digits, p.position.z, digits);
}

std::string line_of(const ListedPlace& listed, bool steps) {
  const SuspiciousPlace& p = listed.place;
  return fmt::format("{:>4} at {}, radius {}: {}, {}{}", listed.number, where(p), length_words(p.radius),
                     listed.worst_words(), counted(p.supports, "fit"),
                     steps && listed.step ? fmt::format("; step {}", *listed.step) : "");
}

}  // namespace

std::vector<std::string> summary_of(const DiagnoseResult& made, bool steps) {
  const Diagnosis& d = made.diagnosis;
  std::vector<std::string> lines{fmt::format("largest gradient around the surface {:.2f}", d.largest_gradient)};
  auto next = made.places.begin();
  for (std::size_t k = 0; k < kSuspicions; ++k) {
    const auto kind = static_cast<Suspicion>(k);
    const std::string extra =
        kind == Suspicion::high_error ? fmt::format(" (above {})", length_words(d.error_above)) : "";
    lines.push_back(titled(suspicion_name(kind), (d.found[k] == 0 ? "nowhere" : counted(d.found[k], "place")) + extra));
    std::size_t shown = 0;
    for (; next != made.places.end() && next->place.kind == kind; ++next, ++shown)
      lines.push_back(line_of(*next, steps));
    if (shown < d.found[k])
      lines.push_back(
          fmt::format("     and {} more: `places = {}` lists all", grouped(d.found[k] - shown), d.found[k]));
  }
  return lines;
}

std::vector<Image> draw_places(const DiagnoseResult& made, RenderOptions options, bool sheet, Progress& progress) {
  if (made.places.empty()) return {};
  if (sheet) {
    if (made.places.size() > kMostOnSheet)
      throw ArgumentError(fmt::format("{} are too many for one sheet: use `separate`, or fewer `places`",
                                      counted(made.places.size(), "place")));
    options.view.width = kTileWidth, options.view.height = kTileHeight;
  }
  const PlacePictures views(made.diagnosis);
  std::vector<Image> pictures;
  pictures.reserve(made.places.size());
  for (const ListedPlace& p : made.places)
    pictures.push_back(views.of(p.place,
                                fmt::format("{}  {}\n{}", p.number, suspicion_name(p.place.kind), p.worst_words()),
                                options, progress));
  if (sheet && !pictures.empty()) pictures = {contact_sheet(pictures)};
  return pictures;
}

const ReportSchema& ListedPlace::schema() {
  static constexpr ReportRow rows[] = {
      reported<&ListedPlace::number>({.text = "Number in the list"}),
      reported<[](const ListedPlace& r) { return suspicion_name(r.place.kind); }>(
          {.name = "kind", .text = "Kind of doubt"}),
      reported<[](const ListedPlace& r) { return r.place.position; }>(
          {.name = "at", .text = "Centre of the region", .unit = "length"}),
      reported<[](const ListedPlace& r) { return r.place.normal; }>(
          {.name = "normal", .text = "Normal of the surface"}),
      reported<[](const ListedPlace& r) { return r.place.radius; }>(
          {.name = "radius", .text = "Radius of a ball around the region", .unit = "length"}),
      reported<[](const ListedPlace& r) { return r.place.supports; }>(
          {.name = "fits", .text = "Local fits in the region"}),
      reported<[](const ListedPlace& r) { return r.place.worst; }>(
          {.name = "worst", .text = "Worst coverage, error, area or gradient"}),
      reported<[](const ListedPlace& r) { return r.place.edit.has_value(); }>(
          {.name = "edit", .text = "Whether an edit may repair it"}),
      reported<&ListedPlace::step>({.text = "Number of the edit in the script"})};
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
      reported<&DiagnoseResult::places>({.text = "Regions by kind, the largest first"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
