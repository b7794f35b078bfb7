#include "sansmesh/pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/function/diagnose_function.h"
#include "sansmesh/functions.h"
#include "sansmesh/jobs/place_pictures.h"

namespace sansmesh::inline v1 {
namespace {

/// Pictures of a sheet, pixels, and how many it may have.
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
  result.diagnosis = diagnose_function(function.fitted(), options, progress);
  result.places = listed_places(result.diagnosis);
  result.edits = result.diagnosis.edits();
  return result;
}

std::vector<Image> draw_places(const DiagnoseResult& made, RenderOptions options, bool sheet, Progress& progress) {
  if (made.places.empty()) return {};
  if (sheet) {
    if (made.places.size() > kMostOnSheet)
      throw ArgumentError(fmt::format("{} are too many for one sheet: `separate`, or fewer `places`",
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

}  // namespace sansmesh::inline v1
