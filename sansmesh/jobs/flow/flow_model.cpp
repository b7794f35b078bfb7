#include "sansmesh/jobs/flow/flow_model.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/dataset/joined_arrays.h"
#include "sansmesh/dataset/volume_flow.h"
#include "sansmesh/error.h"
#include "sansmesh/flow.h"
#include "sansmesh/flow/seed_curve.h"
#include "sansmesh/io.h"
#include "sansmesh/io/points/point_table.h"
#include "sansmesh/jobs/flow/flow_series.h"
#include "sansmesh/jobs/volumes/volume_series.h"
#include "sansmesh/jobs/volumes/volume_state.h"
#include "sansmesh/jobs/with_name.h"

namespace sansmesh::inline v1 {

struct FlowModel::State {
  std::shared_ptr<const VectorField> field;
  std::string name, source, vectors = {};
  bool unsteady = false;
  std::optional<VolumeModel> volume = {};
  std::vector<Note> notes = {};
  std::function<std::vector<std::string>()> step_notes = {};  ///< notes of a series
};

namespace {

constexpr double kGib = 1024.0 * 1024 * 1024;
constexpr std::string_view kTimeInterpolations[] = {"constant", "linear", "cubic"};

std::string flow_names() {
  std::vector<std::string_view> names;
  for (const AnalyticFlow& f : analytic_flows()) names.push_back(f.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

bool is_formula(const std::string& name) {
  const auto flows = analytic_flows();
  return !std::filesystem::exists(name) &&
         std::any_of(flows.begin(), flows.end(), [&](const AnalyticFlow& f) { return f.name == name; });
}

/// The named array, the first array of vectors, or vectors of separate components. Throws DataError.
ArrayChoice vectors_of(const VolumeModel& volume, const std::string& array, std::vector<Note>& notes) {
  if (!array.empty()) {
    dataset_of(volume).join(array);
    return volume.choose(array);
  }
  const std::vector<DatasetArray>& arrays = volume.arrays();
  for (const std::size_t components : {std::size_t{3}, std::size_t{2}})
    for (const DatasetArray& a : arrays)
      if (a.components == components) return {a.name, {}, false};
  if (const std::string found = vector_components(arrays); !found.empty()) {
    if (!dataset_of(volume).join(found))
      throw DataError(
          fmt::format("{}: holds the components {} apart, which become vectors when a file of arrays is "
                      "opened with them (`array`)",
                      volume.name(), found));
    add_notes(notes, "vectors", {"the vectors are " + found + " (`array` lists other components)"}, volume.name());
    return volume.choose(found);
  }
  std::vector<std::string> names;
  names.reserve(arrays.size());
  for (const DatasetArray& a : arrays) names.push_back(fmt::format("{} ({})", a.name, a.components));
  throw DataError(names.empty() ? volume.name() + ": has no arrays"
                                : fmt::format("{}: has no vectors; its arrays and their components: {}", volume.name(),
                                              fmt::join(names, ", ")));
}

/// A quarter of the memory available to the process, in bytes.
std::uint64_t default_memory() {
  const double pages = static_cast<double>(::sysconf(_SC_PHYS_PAGES)),
               page = static_cast<double>(::sysconf(_SC_PAGESIZE));
  double most = pages > 0 && page > 0 ? pages * page : 4.0 * kGib;
  // Limit of a container; the file has a word if there is none.
  if (double limit = 0; std::ifstream("/sys/fs/cgroup/memory.max") >> limit) most = std::min(most, limit);
  return whole_part<std::uint64_t>(most / 4);
}

/// Flow of the vectors of a volume.
std::shared_ptr<FlowModel::State> steady_flow(const VolumeModel& volume, const std::string& array, Progress& progress) {
  std::vector<Note> notes = volume.notes();
  const ArrayChoice choice = vectors_of(volume, array, notes);
  const std::string &source = volume.name(), &vectors = choice.array;
  auto flow = std::make_shared<FlowModel::State>(FlowModel::State{
      .field = {}, .name = fmt::format("{} of {}", vectors, source), .source = source, .vectors = vectors});
  flow->notes = std::move(notes);
  with_name(source, [&] { check_speeds(dataset_of(volume).array(vectors)); });
  try {
    flow->field = volume_flow(volume.field(choice, progress, flow->notes));
  } catch (const ArgumentError& error) {
    throw DataError(fmt::format("{}: {}: {}", source, vectors, error.what()));
  }
  flow->volume = volume;
  return flow;
}

/// Flow whose steps are read on demand.
std::shared_ptr<FlowModel::State> flow_of_steps(const std::vector<std::string>& files,
                                                const VolumeModelOptions& of_volume, const FlowModelOptions& options,
                                                Progress& progress) {
  // The first step determines the array, the method and, if the file has several steps, the times.
  const bool several = files.size() > 1;
  if (!several && of_volume.read.time_step > 0)
    throw ArgumentError("`time_step`: `unsteady` takes all steps of the file");
  for (const std::string& file : files)
    if (!std::filesystem::exists(file)) throw FileError(file, "no such file");
  const VolumeModel volume = open_volume({files[0]}, of_volume, progress);
  std::vector<Note> notes = volume.notes();
  const ArrayChoice choice = vectors_of(volume, of_volume.array, notes);
  const DatasetArray array = dataset_of(volume).array(choice.array);
  with_name(volume.name(), [&] { check_speeds(array); });
  const std::string source = volume_name(files);
  std::vector<double> times = several ? times_of_series(options.times, files.size()) : volume.times();
  if (times.size() < 2) throw FileError(source, "has only one step in time: it is a steady flow (omit `unsteady`)");
  auto flow = std::make_shared<FlowModel::State>(
      FlowModel::State{.field = {},
                       .name = fmt::format("{} of {}, {} steps", choice.array, source, times.size()),
                       .source = source,
                       .vectors = choice.array,
                       .unsteady = true});
  flow->notes = std::move(notes);
  FlowSeries series{files, of_volume.read, array, choice, {}, {}, dataset_of(volume).notes()};
  series.first.field = volume.field(choice, progress, flow->notes);
  series.first.bytes = volume.report().bytes;
  series.method = volume.report().options;
  series.method.smoothing = of_volume.reconstruction.smoothing;  // noise differs from step to step
  const FlowStepReader reader = flow_step_reader(std::move(series));
  flow->step_notes = reader.notes;
  FlowSeriesOptions kept;
  kept.interpolation = options.time_interpolation;
  kept.memory = options.memory ? whole_part<std::uint64_t>(*options.memory * kGib) : default_memory();
  try {
    flow->field = flow_in_time(std::move(times), reader.read, kept);
  } catch (const ArgumentError& error) {
    throw FileError(source, error.what());
  }
  return flow;
}

}  // namespace

const OptionSchema& FlowModelOptions::schema() {
  using O = FlowModelOptions;
  static constexpr OptionRow rows[] = {
      option<&O::unsteady>({.text = "The flow changes in time: use all steps of the file, or several files as steps"}),
      option<&O::times>({.text = "Times of the files, T0,T1,…, or the first and the interval",
                         .unit = "times",
                         .from_data = "0,1",
                         .needs = "unsteady"}),
      option<&O::time_interpolation>(
          {.text = "Interpolation between steps: constant, linear or cubic", .choices = kTimeInterpolations}),
      option<&O::memory>({.text = "Memory for steps of a series in GiB",
                          .unit = "gib",
                          .from_data = "a quarter of the machine's",
                          .range = at_least(0)})};
  return option_schema<rows>();
}

void FlowModelOptions::validate() const { validate_options(*this); }

FlowModel::FlowModel(std::shared_ptr<const State> state) : state_(std::move(state)) {}

FlowModel::FlowModel(std::shared_ptr<const VectorField> field, std::string name)
    : state_(std::make_shared<State>(State{.field = std::move(field), .name = name, .source = std::move(name)})) {}

FlowModel::FlowModel(const VolumeModel& volume, const std::string& array, Progress& progress)
    : state_(steady_flow(volume, array, progress)) {}

const VectorField& FlowModel::field() const { return *state_->field; }
const std::string& FlowModel::name() const { return state_->name; }
const std::string& FlowModel::source() const { return state_->source; }
const std::string& FlowModel::vectors() const { return state_->vectors; }
bool FlowModel::unsteady() const { return state_->unsteady; }
const std::optional<VolumeModel>& FlowModel::volume() const { return state_->volume; }
const std::vector<Note>& FlowModel::opened_notes() const { return state_->notes; }

std::vector<Note> FlowModel::step_notes() const {
  std::vector<Note> notes;
  if (state_->step_notes) add_notes(notes, "steps", state_->step_notes(), state_->source);
  return notes;
}

Seeds FlowModel::seeds(const std::string& text, std::size_t default_count, std::vector<Note>& notes) const {
  Seeds seeds = parse_seeds(text.empty() ? fmt::format("box({})", default_count) : text, field().bounds());
  if (seeds.file.empty()) return seeds;
  if (seeds.mesh) {
    const TriangleMesh surface = read_mesh(seeds.file);
    seeds.points = world_points(surface.origin, surface.vertices);
  } else {
    seeds.points = read_point_table(seeds.file);
  }
  const std::size_t all = seeds.points.size();
  std::erase_if(seeds.points, [](const Vec3& x) { return !is_finite(x); });
  if (seeds.points.empty()) throw FileError(seeds.file, "holds no finite points");
  if (const std::size_t gone = all - seeds.points.size(); gone > 0)
    notes.push_back({.code = "not_finite",
                     .text = fmt::format("{} of {} dropped: not finite", grouped(gone), counted(all, "seed")),
                     .of = seeds.file});
  return seeds;
}

Seeds FlowModel::seed_curve(const std::string& text, std::vector<Note>& notes) const {
  if (text.empty()) throw ArgumentError("`seeds` is required: a curve, for example line(0,0,0, 1,0,0, 100)");
  Seeds seeds = this->seeds(text, 0, notes);
  if (!seeds.curve) throw ArgumentError("`seeds` must be a curve: line, circle, curve(FILE) or loop(FILE)");
  try {
    SeedCurve{seeds.points, seeds.closed}.validate();
  } catch (const ArgumentError& error) {
    if (seeds.file.empty()) throw ArgumentError(fmt::format("`seeds`: {}", error.what()));
    throw FileError(seeds.file, error.what());
  }
  return seeds;
}

DataError in_flow(const FlowModel& flow, const DataError& error) {
  const Box3 box = flow.field().bounds();
  return DataError(fmt::format("{}: {} (it is between {} and {})", flow.source(), error.what(), point_words(box.lower),
                               point_words(box.upper)));
}

FlowModel open_flow(const std::vector<std::string>& files, const VolumeModelOptions& volume,
                    const FlowModelOptions& options, Progress& progress) {
  options.validate();
  if (files.size() == 1 && is_formula(files[0])) {
    return FlowModel(std::make_shared<const FlowModel::State>(
        FlowModel::State{.field = analytic_flow(files[0]), .name = files[0] + " (formula)", .source = files[0]}));
  }
  if (files.size() == 1 && !std::filesystem::exists(files[0]) && files[0].find_first_of("./") == std::string::npos)
    throw FileError(files[0], "no such file, and no flow by formula: " + flow_names());
  if (!options.times.empty() && files.size() < 2) throw ArgumentError("`times` needs several files");
  if (options.unsteady) return FlowModel(flow_of_steps(files, volume, options, progress));
  return {open_volume(files, volume, progress), volume.array, progress};
}

}  // namespace sansmesh::inline v1
