#include "sansmesh/jobs/volume_model.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/dataset/volume_file.h"
#include "sansmesh/io/read_volume.h"

namespace sansmesh::inline v1 {
namespace {

/// Whatever says how a file is read has been heeded when it was fitted.
FittedVolume read_fitted(const std::vector<std::string>& files, const VolumeReadOptions& read) {
  if (files.size() > 1) throw FileError(volume_name(files), "a fitted volume (.smv) is whole: it is read on its own");
  check_argument(!read.raw.given(), "`dims`, `type` and `spacing` are for raw files, not for fitted volumes (.smv)");
  check_argument(read.time_step == 0, "`time_step`: a fitted volume (.smv) holds a single step");
  check_argument(read.fill.usual && read.fill.values.empty(),
                 "`fill_value` is told where a volume is fitted: in a fitted volume (.smv) these are missing already");
  return read_volume_file(files[0]);
}

}  // namespace

const OptionSchema& VolumeModelOptions::schema() {
  using O = VolumeModelOptions;
  static const OptionRow rows[] = {
      option<&O::array>({.text = "Array, or a component of it: NAME, NAME:0, NAME:x, NAME:magnitude",
                         .unit = "name",
                         .from_data = "a scalar"}),
      option_group<&O::reconstruction>(ReconstructionOptions::schema().rows),
      option_group<&O::read>(VolumeReadOptions::schema().rows)};
  static const OptionSchema schema{rows};
  return schema;
}

void VolumeModelOptions::validate() const {
  reconstruction.validate();
  read.validate();
}

std::string volume_name(const std::vector<std::string>& files) {
  if (files.size() == 1) return files[0];
  return fmt::format("{} and {}", files.at(0), counted(files.size() - 1, "other file"));
}

VolumeModel open_volume(const std::vector<std::string>& files, const VolumeModelOptions& options, Progress& progress) {
  options.validate();
  check_argument(!files.empty(), "a volume needs a file");
  progress.begin("read");
  const auto dataset = [&] {
    if (std::any_of(files.begin(), files.end(), is_volume_file)) return VolumeDataset(read_fitted(files, options.read));
    return VolumeDataset(files.size() == 1 ? read_volume(files[0], options.read) : read_volumes(files, options.read));
  };
  return {dataset(), volume_name(files), options};
}

VolumeModel::VolumeModel(VolumeDataset dataset, std::string name, const VolumeModelOptions& options)
    : dataset_(std::move(dataset)), name_(std::move(name)), options_(options) {
  options.validate();
  if (dataset_.arrays().empty()) {
    if (options.bare && options.array.empty()) return;
    std::string cause = "holds no arrays: there is nothing to reconstruct";
    for (const std::string& note : dataset_.notes()) cause += "; " + note;
    naming([&] { throw DataError(cause); });
  }
  choice_ =
      options.array.empty() ? ArrayChoice{dataset_.default_array().name, {}, false} : dataset_.choose(options.array);
}

std::vector<Note> VolumeModel::notes() const {
  std::vector<Note> notes;
  add_notes(notes, "volume", dataset_.notes(), name_);
  return notes;
}

std::string VolumeModel::array_name() const {
  if (choice_.magnitude) return choice_.array + "_magnitude";
  return choice_.component ? fmt::format("{}_{}", choice_.array, *choice_.component) : choice_.array;
}

bool VolumeModel::is_vector() const { return array().components > 1 && !choice_.component && !choice_.magnitude; }

ArrayChoice VolumeModel::as_scalar(ArrayChoice choice) const {
  choice.magnitude = choice.magnitude || (!choice.component && dataset_.array(choice.array).components > 1);
  return choice;
}

ArrayChoice VolumeModel::scalar_choice(const std::string& name, const std::string& field) const {
  return as_scalar(dataset_.choose(name, field));
}

std::shared_ptr<const SampledVolume> VolumeModel::samples(Progress& progress) {
  if (!samples_)
    samples_ = naming([&] {
      return dataset_.arrays().empty() ? dataset_.volume(Association::points, progress)
                                       : dataset_.volume(choice_.array, progress);
    });
  return samples_;
}

const VolumeTraits& VolumeModel::traits(Progress& progress) {
  if (traits_) return *traits_;
  const auto volume = samples(progress);
  traits_ = naming([&] {
    dataset_.default_array();  // there must be one
    return measure_volume_traits(*volume, volume_values(*volume, choice_.array), progress);
  });
  suited_ = choose_reconstruction(*volume, *traits_);
  return *traits_;
}

const ReconstructionChoice& VolumeModel::suited(Progress& progress) {
  traits(progress);
  return suited_;
}

ReconstructionOptions VolumeModel::options_for(const std::string& array, Progress& progress) {
  ReconstructionOptions options = options_.reconstruction;
  const FittedVolume* const fitted = dataset_.fitted();
  if (!options.method && (!fitted || fitted->array != array)) options.method = suited(progress).method;
  return options;
}

VolumeUse VolumeModel::use(Progress& progress) {
  const std::shared_ptr<const SampledVolume> used = samples(progress);
  return {.format = dataset_.format(),
          .array = choice_.array,
          .method = report_.options.method.value_or(""),
          .why = report_.why,
          .samples = used->size(),
          .grid = used->facts.grid,
          .notes = report_.notes};
}

void VolumeModel::keep_report(const ReconstructionReport& report, const ReconstructionOptions& asked) {
  if (std::exchange(reported_, true)) return;
  report_ = report;
  // What suits the data was put in here, not by who opened the volume.
  if (asked.method && !options_.reconstruction.method) report_.why = suited_.why;
}

std::shared_ptr<const VolumeField> VolumeModel::field(Progress& progress, std::vector<Note>& notes) {
  return field(choice_, progress, notes);
}

std::shared_ptr<const VolumeField> VolumeModel::field(const ArrayChoice& choice, Progress& progress,
                                                      std::vector<Note>& notes) {
  auto made = std::find_if(made_.begin(), made_.end(), [&](const Made& m) { return m.choice == choice; });
  if (made == made_.end()) {
    samples(progress);
    const ReconstructionOptions options = options_for(choice.array, progress);
    ReconstructionReport report;
    auto field = naming([&] { return dataset_.field(choice, options, progress, &report); });
    keep_report(report, options);
    made = made_.insert(made_.end(), {choice, std::move(field), std::move(report.notes)});
  }
  add_notes(notes, "reconstruction", made->notes, name_);
  return made->field;
}

FittedVolume VolumeModel::fit(bool all, Progress& progress, std::vector<Note>& notes) {
  if (choice_.component || choice_.magnitude)
    throw ArgumentError(
        fmt::format("`array`: all components are fitted together; choose one where the file is used ({}, not {})",
                    choice_.array, options_.array));
  samples(progress);
  const ReconstructionOptions options = options_for(choice_.array, progress);
  ReconstructionReport report;
  FittedVolume fitted = naming([&] { return dataset_.fit(choice_.array, options, all, progress, &report); });
  keep_report(report, options);
  add_notes(notes, "reconstruction", report.notes, name_);
  return fitted;
}

std::shared_ptr<const Isosurface> VolumeModel::isosurface(double value, Progress& progress, std::vector<Note>& notes) {
  check_scalar();
  const auto values = field(progress, notes);
  progress.begin("find surface");
  return naming([&] {
    return std::make_shared<const Isosurface>(
        samples_, values, [&](std::size_t i) { return sample_value(i); }, value);
  });
}

double VolumeModel::sample_value(std::size_t i) const {
  const Attribute& a = *samples_->attributes.find(choice_.array);
  if (choice_.component) return a.number(i * a.components + *choice_.component);
  if (a.components == 1) return a.number(i);
  std::array<double, 16> few;
  std::vector<double> many(a.components > few.size() ? a.components : 0);
  const std::span<double> v = many.empty() ? std::span(few).first(a.components) : std::span(many);
  for (std::size_t c = 0; c < v.size(); ++c) v[c] = a.number(i * v.size() + c);
  return vector_length(v);
}

void VolumeModel::check_scalar() const {
  const DatasetArray& a = array();
  if (is_vector())
    throw ArgumentError(fmt::format("`array`: {} has {} components: choose one ({}:0, {}:magnitude, …)", a.name,
                                    a.components, a.name, a.name));
}

double VolumeModel::value_or_middle(const std::optional<double>& value) const {
  check_argument(value || choice_.component || array().components == 1,
                 "`value` is needed for arrays of several components");
  return value ? *value : middle_value();
}

double VolumeModel::middle_value() const {
  const DatasetArray& a = array();
  const std::size_t c = choice_.component.value_or(0);
  if (std::isnan(a.least[c]))
    throw DataError(fmt::format("{}: array '{}' has no finite value", printable(name_, 200), printable(a.name, 60)));
  return 0.5 * (a.least[c] + a.most[c]);
}

namespace {

constexpr ReportRow kVolumeUseRows[] = {
    reported<&VolumeUse::format>({.text = "Format of the file"}),
    reported<&VolumeUse::array>({.text = "Array"}),
    reported<[](const VolumeUse& r) { return told_if(!r.method.empty(), r.method); }>(
        {.name = "method", .text = "Method of reconstruction"}),
    reported<[](const VolumeUse& r) { return told_if(!r.why.empty(), r.why); }>(
        {.name = "why", .text = "Reason for that, where it was chosen"}),
    reported<&VolumeUse::samples>({.text = "Samples"}),
    reported<&VolumeUse::grid>({.text = "Grid, in words"}),
    reported<&VolumeUse::notes>({.text = "What there is to know of the values"})};

}  // namespace

const ReportSchema& VolumeUse::schema() {
  static constexpr ReportSchema schema{kVolumeUseRows};
  return schema;
}

}  // namespace sansmesh::inline v1
