// Fitted volumes: volumes stored with their reconstruction.
#include <fmt/core.h>

#include <utility>

#include "sansmesh/dataset/volume_file.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/volumes/volume_state.h"
#include "sansmesh/jobs/with_name.h"

namespace sansmesh::inline v1 {

const OptionSchema& FitVolumeOptions::schema() {
  using O = FitVolumeOptions;
  static constexpr OptionRow rows[] = {
      option<&O::all_arrays>({.text = "Keep the other arrays as well", .old_name = "all"})};
  return option_schema<rows>();
}

FitVolumeResult fit_volume(const VolumeModel& volume, const FitVolumeOptions& options, Progress& progress) {
  const ArrayChoice& choice = volume.choice();
  if (choice.component || choice.magnitude)
    throw ArgumentError(
        fmt::format("`array`: all components are fitted together; select one when the file is used ({}, not {})",
                    choice.array, volume.options().array));
  volume.samples(progress);
  const VolumeReconstructionOptions asked = options_for(volume, choice.array, progress);
  VolumeReconstructionReport report;
  auto fitted = std::make_shared<FittedVolume>(with_name(volume.name(), [&] {
    return dataset_of(volume).fit(choice.array, asked, options.all_arrays, progress, &report);
  }));
  volume.state().keep_report(report, asked);
  FitVolumeResult result;
  add_notes(result.notes, "reconstruction", report.notes, volume.name());
  FitVolumeReport& r = result.report;
  r.reconstruction = volume.report();
  r.samples = fitted->volume->size();
  for (const DatasetArray& array : fitted->arrays) r.arrays.push_back(array.name);
  r.by_degree = fitted->coefficients.by_degree();
  if (fitted->coefficients.empty())
    result.notes.push_back(
        {.code = "no_coefficients",
         .text = fmt::format("{} has no coefficients: only the samples are kept", *fitted->chosen.method),
         .severity = Note::Severity::information,
         .of = volume.name()});
  result.fitted = std::move(fitted);
  return result;
}

void write_fit(const std::string& file, const FitVolumeResult& fit) {
  if (!is_volume_file(file))
    throw FileError(file, "fitted volumes are written to files with the ending .smv (or .smv.gz)");
  write_volume_file(file, *fit.fitted);
}

const ReportSchema& FitVolumeReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<&FitVolumeReport::by_degree>({.text = "Polynomials of each degree"}),
      reported<&FitVolumeReport::samples>({.name = "output.samples", .text = "Samples"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
