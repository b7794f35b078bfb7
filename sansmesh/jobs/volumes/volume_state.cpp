#include "sansmesh/jobs/volumes/volume_state.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <utility>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/dataset/volume_file.h"
#include "sansmesh/error.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/volume/choose_reconstruction.h"
#include "sansmesh/volume/volume_traits.h"

namespace sansmesh::inline v1 {
namespace {

/// Options of reading were applied when the volume was fitted.
FittedVolume read_fitted(const std::vector<std::string>& files, const VolumeReadOptions& read) {
  if (files.size() > 1) throw FileError(volume_name(files), "a fitted volume (.smv) must be the only file");
  check_argument(!read.raw.given(), "`dims`, `type` and `spacing` are for raw files, not for fitted volumes (.smv)");
  check_argument(read.time_step == 0, "`time_step`: a fitted volume (.smv) holds a single step");
  check_argument(read.fill.usual && read.fill.values.empty(),
                 "`fill_value` must be given when the volume is fitted, not for a fitted volume (.smv)");
  return read_volume_file(files[0]);
}

/// Also chooses the array.
std::shared_ptr<VolumeModel::State> state_of(std::shared_ptr<VolumeDataset> dataset, std::string name,
                                             const VolumeModelOptions& options) {
  options.validate();
  const auto state = std::make_shared<VolumeModel::State>();
  state->dataset = std::move(dataset), state->name = std::move(name), state->options = options;
  state->dataset->join(options.array);
  const VolumeDataset& of = *state->dataset;
  if (of.arrays().empty()) {
    if (options.bare && options.array.empty()) return state;
    std::string cause = "has no arrays: there is nothing to reconstruct";
    for (const std::string& note : of.notes()) cause += "; " + note;
    with_name(state->name, [&] { throw DataError(cause); });
  }
  state->choice = options.array.empty() ? ArrayChoice{of.default_array().name, {}, false} : of.choose(options.array);
  return state;
}

}  // namespace

const OptionSchema& VolumeModelOptions::schema() {
  using O = VolumeModelOptions;
  static const OptionRow rows[] = {
      option<&O::array>({.text = "Array, a component of it, or components of vectors: NAME, NAME:0, NAME:x, "
                                 "NAME:magnitude, NAME,NAME,NAME",
                         .unit = "name",
                         .from_data = "a scalar"}),
      option_group<&O::reconstruction>(VolumeReconstructionOptions::schema().rows),
      option_group<&O::read>(VolumeReadOptions::schema().rows)};
  return option_schema<rows>();
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
  return model_of(dataset(), volume_name(files), options);
}

VolumeModel model_of(VolumeDataset dataset, std::string name, const VolumeModelOptions& options) {
  return VolumeModel(state_of(std::make_shared<VolumeDataset>(std::move(dataset)), std::move(name), options));
}

VolumeModel::VolumeModel(std::shared_ptr<State> state) : state_(std::move(state)) {}

VolumeModel::VolumeModel(GridData data, std::string name, const VolumeModelOptions& options)
    : VolumeModel(model_of(VolumeDataset(std::move(data)), std::move(name), options)) {}

VolumeModel::VolumeModel(const std::shared_ptr<const FittedVolume>& fitted, std::string name,
                         const VolumeModelOptions& options)
    : VolumeModel(model_of(VolumeDataset(*fitted), std::move(name), options)) {}

VolumeModel::VolumeModel(const VolumeModel& volume, const VolumeModelOptions& options)
    : state_(state_of(volume.state_->dataset, volume.name(), options)) {}

const std::string& VolumeModel::name() const { return state_->name; }
const VolumeModelOptions& VolumeModel::options() const { return state_->options; }
const std::string& VolumeModel::format() const { return state_->dataset->format(); }
const std::vector<DatasetArray>& VolumeModel::arrays() const { return state_->dataset->arrays(); }
const std::vector<double>& VolumeModel::times() const { return state_->dataset->times(); }
const ArrayChoice& VolumeModel::choice() const { return state_->choice; }
const DatasetArray& VolumeModel::array() const { return state_->dataset->array(state_->choice.array); }
const VolumeReconstructionReport& VolumeModel::report() const { return state_->report; }

std::vector<Note> VolumeModel::notes() const {
  std::vector<Note> notes;
  add_notes(notes, "volume", state_->dataset->notes(), name());
  return notes;
}

std::string VolumeModel::array_name() const {
  const ArrayChoice& choice = state_->choice;
  if (choice.magnitude) return choice.array + "_magnitude";
  return choice.component ? fmt::format("{}_{}", choice.array, *choice.component) : choice.array;
}

bool VolumeModel::is_vector() const {
  return array().components > 1 && !state_->choice.component && !state_->choice.magnitude;
}

ArrayChoice VolumeModel::choose(const std::string& text, const std::string& field) const {
  return state_->dataset->choose(text, field);
}

ArrayChoice VolumeModel::as_scalar(ArrayChoice choice) const {
  choice.magnitude = choice.magnitude || (!choice.component && state_->dataset->array(choice.array).components > 1);
  return choice;
}

ArrayChoice VolumeModel::scalar_choice(const std::string& name, const std::string& field) const {
  return as_scalar(choose(name, field));
}

std::shared_ptr<const SampledVolume> VolumeModel::samples(Progress& progress) const {
  State& s = *state_;
  if (!s.samples)
    s.samples = with_name(s.name, [&] {
      return s.dataset->arrays().empty() ? s.dataset->volume(Association::points, progress)
                                         : s.dataset->volume(s.choice.array, progress);
    });
  return s.samples;
}

const VolumeTraits& VolumeModel::traits(Progress& progress) const {
  State& s = *state_;
  if (s.traits) return *s.traits;
  const auto volume = samples(progress);
  s.traits = with_name(s.name, [&] {
    s.dataset->default_array();  // checks that there is one
    const VolumeValues values = volume_values(*volume, s.choice.array);
    const SampleNoise& noise = s.dataset->noise(s.choice.array, values, progress);
    return measure_volume_traits(*volume, values, noise, progress);
  });
  s.recommended = choose_reconstruction(*volume, *s.traits, s.options.reconstruction.smoothing);
  return *s.traits;
}

const VolumeReconstructionChoice& VolumeModel::recommended(Progress& progress) const {
  traits(progress);
  return state_->recommended;
}

VolumeReconstructionOptions options_for(const VolumeModel& volume, const std::string& array, Progress& progress) {
  VolumeReconstructionOptions options = volume.options().reconstruction;
  const FittedVolume* const fitted = dataset_of(volume).fitted();
  if (!options.method && (!fitted || fitted->array != array)) options.method = volume.recommended(progress).method;
  return options;
}

void VolumeModel::State::keep_report(const VolumeReconstructionReport& of, const VolumeReconstructionOptions& asked) {
  if (std::exchange(reported, true)) return;
  report = of;
  // What suits the data was put in here, not by who opened the volume.
  if (asked.method && !options.reconstruction.method) report.why = recommended.why;
}

std::shared_ptr<const VolumeField> VolumeModel::field(Progress& progress, std::vector<Note>& notes) const {
  return field(state_->choice, progress, notes);
}

std::shared_ptr<const VolumeField> VolumeModel::field(const ArrayChoice& choice, Progress& progress,
                                                      std::vector<Note>& notes) const {
  State& s = *state_;
  auto made = std::find_if(s.made.begin(), s.made.end(), [&](const State::Made& m) { return m.choice == choice; });
  if (made == s.made.end()) {
    samples(progress);
    const VolumeReconstructionOptions options = options_for(*this, choice.array, progress);
    VolumeReconstructionReport report;
    auto field = with_name(s.name, [&] { return s.dataset->field(choice, options, progress, &report); });
    s.keep_report(report, options);
    made = s.made.insert(s.made.end(), {choice, std::move(field), std::move(report.notes)});
  }
  add_notes(notes, "reconstruction", made->notes, s.name);
  return made->field;
}

std::shared_ptr<const Isosurface> VolumeModel::isosurface(double value, Progress& progress,
                                                          std::vector<Note>& notes) const {
  check_scalar();
  const auto values = field(progress, notes);
  progress.begin("find surface");
  const auto of_sample = reconstructed_samples(*this, *values);
  return with_name(name(),
                   [&] { return std::make_shared<const Isosurface>(state_->samples, values, of_sample, value); });
}

double VolumeModel::sample_value(std::size_t i) const {
  const ArrayChoice& choice = state_->choice;
  const Attribute& a = *state_->samples->attributes.find(choice.array);
  if (choice.component) return a.number(i * a.components + *choice.component);
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
  check_argument(value || state_->choice.component || array().components == 1,
                 "`value` is needed for arrays of several components");
  return value ? *value : middle_value();
}

std::function<double(std::size_t)> reconstructed_samples(const VolumeModel& volume, const VolumeField& field) {
  if (!(volume.report().options.smoothing.value_or(0) > 0))
    return [&volume](std::size_t i) { return volume.sample_value(i); };
  Progress progress;
  const std::shared_ptr<const SampledVolume> samples = volume.samples(progress);
  std::vector<Vec3> x(samples->size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = samples->position(i);
  auto values = std::make_shared<std::vector<double>>(x.size());
  field.evaluate(x, {*values});
  return [values](std::size_t i) { return (*values)[i]; };
}

std::optional<ValueRange> range_of_samples(const VolumeModel& volume, Progress& progress) {
  const std::size_t n = volume.samples(progress)->size();
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  ValueRange range{kEnd, -kEnd};
  for (std::size_t i = 0; i < n; ++i) {
    const double v = volume.sample_value(i);
    if (std::isfinite(v)) range = {std::min(range.least, v), std::max(range.most, v)};
  }
  return range.least <= range.most ? std::optional(range) : std::nullopt;
}

double VolumeModel::middle_value() const {
  const DatasetArray& a = array();
  const std::size_t c = state_->choice.component.value_or(0);
  if (std::isnan(a.least[c]))
    throw DataError(fmt::format("{}: array '{}' has no finite value", printable(name(), 200), printable(a.name, 60)));
  return 0.5 * (a.least[c] + a.most[c]);
}

VolumeUse volume_use(const VolumeModel& volume, Progress& progress) {
  const std::shared_ptr<const SampledVolume> samples = volume.samples(progress);
  const VolumeReconstructionReport& report = volume.report();
  return {.format = volume.format(),
          .array = volume.choice().array,
          .method = report.options.method.value_or(""),
          .why = report.why,
          .samples = samples->size(),
          .grid = samples->facts.grid,
          .notes = report.notes,
          .smoothing = report.options.smoothing.value_or(0),
          .noise = report.noise,
          .noise_kind = report.noise_kind,
          .interpolate = report.options.interpolate,
          .logarithm = report.options.logarithm,
          .cell_values = report.options.cell_values};
}

std::vector<std::string> summary_of(const VolumeModel& volume, Progress& progress) {
  const VolumeReconstructionReport& r = volume.report();
  const auto samples = volume.samples(progress);
  const double smoothing = r.options.smoothing.value_or(0);
  const bool means = r.options.cell_values == CellValues::means;
  return {fmt::format("{}: by {}{}{}{}{}{}", volume.array_name(), r.options.method.value(),
                      r.options.logarithm.value_or(false) ? " of the logarithm" : "",
                      r.options.interpolate.value_or(true) ? "" : ", not through the samples",
                      means ? ", values are means over cells" : "", r.why.empty() ? "" : ", since it is " + r.why,
                      smoothing > 0 ? fmt::format("; smoothed by {} times its {}noise of {:.3g}", smoothing,
                                                  r.noise_kind.empty() ? "" : r.noise_kind + " ", r.noise)
                                    : ""),
          fmt::format("{}: {} ({})", volume.name(), counted(samples->size(), "sample"), samples->facts.grid)};
}

const ReportSchema& VolumeUse::schema() {
  static constexpr ReportRow rows[] = {
      reported<&VolumeUse::format>({.text = "Format of the file"}),
      reported<&VolumeUse::array>({.text = "Array"}),
      reported<[](const VolumeUse& r) { return value_if(!r.method.empty(), r.method); }>(
          {.name = "method", .text = "Method of reconstruction"}),
      reported<[](const VolumeUse& r) { return value_if(!r.why.empty(), r.why); }>(
          {.name = "why", .text = "Reason for the method, if it was chosen automatically"}),
      reported<&VolumeUse::samples>({.text = "Samples"}),
      reported<&VolumeUse::grid>({.text = "Description of the grid"}),
      reported<&VolumeUse::notes>({.text = "Notes on the values"}),
      reported<[](const VolumeUse& r) { return value_if(r.smoothing > 0, r.smoothing); }>(
          {.name = "smoothing", .text = "Factor of the noise by which the samples were smoothed first"}),
      reported<[](const VolumeUse& r) { return value_if(r.smoothing > 0, r.noise); }>(
          {.name = "noise", .text = "Deviation of the noise of the samples", .unit = "value"}),
      reported<[](const VolumeUse& r) { return value_if(r.smoothing > 0 && !r.noise_kind.empty(), r.noise_kind); }>(
          {.name = "noise_kind", .text = "Kind of this noise: white, correlated or Rician"}),
      reported<&VolumeUse::interpolate>(
          {.text = "Whether the field passes through the samples, if the method has that choice (mls, mls-detail)"}),
      reported<&VolumeUse::logarithm>({.text = "Whether the logarithm is reconstructed, once a field is made"}),
      reported<[](const VolumeUse& r) {
        return value_if(r.cell_values.has_value(),
                        std::string(r.cell_values == CellValues::means ? "means" : "centres"));
      }>({.name = "cell_values", .text = "Meaning of values in cells: means or centres"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
