#include "sansmesh/jobs/volumes/volume_series.h"

#include <fmt/core.h>

#include <filesystem>
#include <utility>

#include "sansmesh/core/check_range.h"
#include "sansmesh/error.h"
#include "sansmesh/volumes.h"

namespace sansmesh::inline v1 {
namespace {

void add_step(VolumeSeries& series, VolumeModel step) {
  for (Note& note : step.notes()) series.notes.push_back(std::move(note));
  series.steps.push_back(std::move(step));
}

}  // namespace

std::vector<double> times_of_series(const std::vector<double>& given, std::size_t files) {
  if (given.size() == files) return given;
  if (!given.empty() && given.size() != 2)
    throw ArgumentError(fmt::format(
        "`times` has {} numbers for {} files: give one per file, or the first and the interval", given.size(), files));
  const double from = given.empty() ? 0 : given[0], step = given.empty() ? 1 : given[1];
  std::vector<double> times(files);
  for (std::size_t i = 0; i < files; ++i) times[i] = from + step * static_cast<double>(i);
  return times;
}

VolumeSeries open_volume_series(const std::vector<std::string>& files, const VolumeModelOptions& options,
                                const std::vector<double>& times, Progress& progress) {
  const bool several = files.size() > 1;
  check_argument(times.empty() || several, "`times` needs several files");
  check_argument(several || options.read.time_step == 0,
                 "`time_step`: all steps of a volume that changes in time are used");
  for (const std::string& file : files)
    if (!std::filesystem::exists(file)) throw FileError(file, "no such file");
  VolumeSeries series;
  series.name = volume_name(files);
  add_step(series, open_volume({files.at(0)}, options, progress));
  VolumeModelOptions others = options;
  {
    VolumeModel& first = series.steps[0];
    first.check_scalar();
    series.times = several ? times_of_series(times, files.size()) : first.times();
    if (series.times.size() < 2) throw DataError(printable(series.name, 200) + ": has only one step in time");
    if (others.array.empty()) others.array = first.choice().array;
    std::vector<Note> with_the_field;  // the field keeps its notes
    first.field(progress, with_the_field);
    others.reconstruction = first.report().options;
  }
  for (std::size_t i = 1; i < series.times.size(); ++i) {
    if (!several) others.read.time_step = i;
    add_step(series, open_volume({files[several ? i : 0]}, others, progress));
  }
  return series;
}

const ReportSchema& VolumeSeries::schema() {
  static constexpr ReportRow rows[] = {
      reported<[](const VolumeSeries& r) { return r.steps.size(); }>({.name = "steps", .text = "Steps in time"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
