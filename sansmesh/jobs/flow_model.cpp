#include "sansmesh/jobs/flow_model.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/flow/analytic_flows.h"
#include "sansmesh/flow/seed_curve.h"
#include "sansmesh/io.h"
#include "sansmesh/io/point_table.h"
#include "sansmesh/jobs/flow_series.h"
#include "sansmesh/jobs/volume_series.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kGib = 1024.0 * 1024 * 1024;
constexpr std::string_view kTimeInterpolations[] = {"constant", "linear", "cubic"};

std::string flow_names() {
  std::string names;
  for (const AnalyticFlow& f : analytic_flows()) names += fmt::format("{}{}", names.empty() ? "" : ", ", f.name);
  return names;
}

bool is_formula(const std::string& name) {
  const auto flows = analytic_flows();
  return !std::filesystem::exists(name) &&
         std::any_of(flows.begin(), flows.end(), [&](const AnalyticFlow& f) { return f.name == name; });
}

/// That of this name; of an empty one the first array of vectors. Throws DataError.
ArrayChoice vectors_of(const VolumeModel& volume, const std::string& array) {
  if (!array.empty()) return volume.dataset().choose(array);
  const std::vector<DatasetArray>& arrays = volume.dataset().arrays();
  for (const std::size_t components : {std::size_t{3}, std::size_t{2}})
    for (const DatasetArray& a : arrays)
      if (a.components == components) return {a.name, {}, false};
  std::string names;
  for (const DatasetArray& a : arrays)
    names += fmt::format("{}{} ({})", names.empty() ? "" : ", ", a.name, a.components);
  throw DataError(volume.name() + ": " +
                  (names.empty() ? "holds no arrays" : "holds no vectors; its arrays and their components: " + names));
}

/// A quarter of the memory that this process may use, in bytes.
std::uint64_t usual_memory() {
  const double pages = static_cast<double>(::sysconf(_SC_PHYS_PAGES)),
               page = static_cast<double>(::sysconf(_SC_PAGESIZE));
  double most = pages > 0 && page > 0 ? pages * page : 4.0 * kGib;
  // Of a container; the file holds a word where there is no limit.
  if (double limit = 0; std::ifstream("/sys/fs/cgroup/memory.max") >> limit) most = std::min(most, limit);
  return whole_part<std::uint64_t>(most / 4);
}

}  // namespace

const OptionSchema& FlowModelOptions::schema() {
  using O = FlowModelOptions;
  static constexpr OptionRow rows[] = {
      option<&O::unsteady>(
          {.text = "The flow changes: all steps of the file in time, or several files one after the other"}),
      option<&O::times>({.text = "Of the files, T0,T1,…, or the first and the step between them",
                         .unit = "times",
                         .from_data = "0,1",
                         .needs = "unsteady"}),
      option<&O::time_interpolation>(
          {.text = "Between steps: constant, linear or cubic", .choices = kTimeInterpolations}),
      option<&O::memory>({.text = "Steps of a series are kept in so many GiB to be used again",
                          .unit = "gib",
                          .from_data = "a quarter of the machine's",
                          .range = at_least(0)})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void FlowModelOptions::validate() const { validate_options(*this); }

FlowModel::FlowModel(std::shared_ptr<const VectorField> field, std::string name)
    : field_(std::move(field)), name_(std::move(name)), source_(name_) {}

FlowModel::FlowModel(VolumeModel opened, const std::string& array, Progress& progress)
    : source_(opened.name()), volume_(std::make_shared<VolumeModel>(std::move(opened))) {
  VolumeModel& volume = *volume_;
  const ArrayChoice choice = vectors_of(volume, array);
  vectors_ = choice.array;
  name_ = fmt::format("{} of {}", vectors_, source_);
  notes_ = volume.notes();
  volume.naming([&] { check_speeds(volume.dataset().array(vectors_)); });
  try {
    field_ = volume_flow(volume.field(choice, progress, notes_));
  } catch (const ArgumentError& error) {
    throw DataError(fmt::format("{}: {}: {}", source_, vectors_, error.what()));
  }
}

std::vector<Note> FlowModel::step_notes() const {
  std::vector<Note> notes;
  if (step_notes_) add_notes(notes, "steps", step_notes_(), source_);
  return notes;
}

FlowModel FlowModel::series(const std::vector<std::string>& files, const VolumeModelOptions& of_volume,
                            const FlowModelOptions& options, Progress& progress) {
  // The first step says which array, which method and, of a file of several, when the others are.
  const bool several = files.size() > 1;
  if (!several && of_volume.read.time_step > 0)
    throw ArgumentError("`time_step`: `unsteady` takes all steps of the file");
  for (const std::string& file : files)
    if (!std::filesystem::exists(file)) throw FileError(file, "no such file");
  VolumeModel volume = open_volume({files[0]}, of_volume, progress);
  const ArrayChoice choice = vectors_of(volume, of_volume.array);
  const DatasetArray array = volume.dataset().array(choice.array);
  volume.naming([&] { check_speeds(array); });
  const std::string source = volume_name(files);
  std::vector<double> times = several ? times_of_series(options.times, files.size()) : volume.dataset().times();
  if (times.size() < 2)
    throw FileError(source, "holds one step in time: nothing changes (it is a steady flow, without `unsteady`)");
  FlowModel flow(nullptr, fmt::format("{} of {}, {} steps", choice.array, source, times.size()));
  flow.source_ = source, flow.vectors_ = choice.array, flow.unsteady_ = true, flow.notes_ = volume.notes();
  FlowSeries series{files, of_volume.read, array, choice, {}, {}, volume.dataset().notes()};
  series.first.field = volume.field(choice, progress, flow.notes_);
  series.first.bytes = volume.report().bytes;
  series.method = volume.report().options;
  const FlowStepReader reader = flow_step_reader(std::move(series));
  flow.step_notes_ = reader.notes;
  FlowSeriesOptions kept;
  kept.interpolation = options.time_interpolation;
  kept.memory = options.memory ? whole_part<std::uint64_t>(*options.memory * kGib) : usual_memory();
  try {
    flow.field_ = flow_in_time(std::move(times), reader.read, kept);
  } catch (const ArgumentError& error) {
    throw FileError(source, error.what());
  }
  return flow;
}

Seeds FlowModel::seeds(const std::string& text, std::size_t usual, std::vector<Note>& notes) const {
  Seeds seeds = parse_seeds(text.empty() ? fmt::format("box({})", usual) : text, field_->bounds());
  if (seeds.file.empty()) return seeds;
  if (seeds.mesh) {
    const TriangleMesh surface = read_mesh(seeds.file);
    for (const Vec3f& v : surface.vertices) seeds.points.push_back(surface.origin + Vec3(v));
  } else {
    seeds.points = read_point_table(seeds.file);
  }
  const std::size_t all = seeds.points.size();
  std::erase_if(seeds.points, [](const Vec3& x) { return !is_finite(x); });
  if (seeds.points.empty()) throw FileError(seeds.file, "holds no finite points");
  if (const std::size_t gone = all - seeds.points.size(); gone > 0)
    notes.push_back({.code = "not_finite",
                     .text = fmt::format("{} of {} not finite, and left out", grouped(gone), counted(all, "seed")),
                     .remedy = {},
                     .of = seeds.file});
  return seeds;
}

Seeds FlowModel::seed_curve(const std::string& text, std::vector<Note>& notes) const {
  if (text.empty()) throw ArgumentError("`seeds` is needed: a curve such as line(0,0,0, 1,0,0, 100)");
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

DataError FlowModel::error(const DataError& error) const {
  const Box3 box = field_->bounds();
  return DataError(fmt::format("{}: {} (it lies between ({:.6g}, {:.6g}, {:.6g}) and ({:.6g}, {:.6g}, {:.6g}))",
                               source_, error.what(), box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y,
                               box.upper.z));
}

FlowModel open_flow(const std::vector<std::string>& files, const VolumeModelOptions& volume,
                    const FlowModelOptions& options, Progress& progress) {
  options.validate();
  if (files.size() == 1 && is_formula(files[0])) {
    FlowModel flow(analytic_flow(files[0]), files[0] + " (formula)");
    flow.source_ = files[0];
    return flow;
  }
  if (files.size() == 1 && !std::filesystem::exists(files[0]) && files[0].find_first_of("./") == std::string::npos)
    throw FileError(files[0], "no such file, and no flow by formula: " + flow_names());
  if (!options.times.empty() && files.size() < 2) throw ArgumentError("`times` needs several files");
  if (options.unsteady) return FlowModel::series(files, volume, options, progress);
  return {open_volume(files, volume, progress), volume.array, progress};
}

}  // namespace sansmesh::inline v1
