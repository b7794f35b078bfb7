#include "sansmesh/jobs/fit_volume.h"

#include <fmt/core.h>

namespace sansmesh::inline v1 {

const OptionSchema& FitVolumeOptions::schema() {
  using O = FitVolumeOptions;
  static constexpr OptionRow rows[] = {
      option<&O::all>({.text = "Keep the other arrays as well, for other reconstructions and to carry along"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

FitVolumeResult fit_volume(VolumeModel& volume, const FitVolumeOptions& options, Progress& progress) {
  FitVolumeResult result;
  result.fitted = volume.fit(options.all, progress, result.notes);
  FitVolumeReport& r = result.report;
  r.reconstruction = volume.report();
  r.samples = result.fitted.volume->size();
  r.by_degree = result.fitted.coefficients.by_degree();
  if (result.fitted.coefficients.empty())
    result.notes.push_back({.code = "no_coefficients",
                            .text = fmt::format("{} has no coefficients to keep: the samples alone are kept",
                                                *result.fitted.chosen.method),
                            .remedy = {},
                            .severity = Note::Severity::information,
                            .of = volume.name()});
  return result;
}

namespace {

constexpr ReportRow kFitVolumeReportRows[] = {
    reported<&FitVolumeReport::by_degree>({.text = "Polynomials of each degree"}),
    reported<&FitVolumeReport::samples>({.name = "output.samples", .text = "Samples"})};

}  // namespace

const ReportSchema& FitVolumeReport::schema() {
  static constexpr ReportSchema schema{kFitVolumeReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
