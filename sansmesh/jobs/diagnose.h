// Places where a function should not be trusted without a look, listed and looked at.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/function/diagnose_function.h"
#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/render_options.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

/// A place as the list has it.
struct ListedPlace {
  SuspiciousPlace place;
  std::size_t number = 0;           ///< from 1 on, kinds in their order
  std::optional<std::size_t> step;  ///< of the edits, from 1 on

  /// "coverage down to 0.12"
  std::string worst_words() const;

  static const ReportSchema& schema();
};

struct DiagnoseResult {
  std::size_t fits = 0;  ///< of the function
  Diagnosis diagnosis;
  std::vector<ListedPlace> places;
  std::vector<Edit> edits;  ///< to try, one for each place that has a step

  static const ReportSchema& schema();
};

/// By diagnose_function. Throws ArgumentError for bad options, DataError where the function has no surface; Cancelled.
DiagnoseResult diagnose(const SurfaceFunction& function, const DiagnoseOptions& options, Progress& progress);

/// The places, each from outside and ringed, with its number and what is worst there: pictures as the options have
/// them, in the order of the list, or with `sheet` small ones, all on one. Of no places none. Throws ArgumentError for
/// bad options, and for more places than a sheet holds.
std::vector<Image> draw_places(const DiagnoseResult& made, RenderOptions options, bool sheet, Progress& progress);

}  // namespace sansmesh::inline v1
