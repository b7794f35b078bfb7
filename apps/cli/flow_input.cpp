#include "flow_input.h"

#include <fmt/core.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "command_line.h"
#include "option_groups.h"
#include "option_values.h"
#include "sansmesh/core/error.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/flow/analytic_flows.h"
#include "sansmesh/flow/seed_curve.h"
#include "sansmesh/io/io.h"
#include "sansmesh/io/point_table.h"

namespace sansmesh::cli {
namespace {

constexpr double kGib = 1024.0 * 1024 * 1024;

std::string flow_names() {
  std::string names;
  for (const AnalyticFlow& f : analytic_flows()) names += fmt::format("{}{}", names.empty() ? "" : ", ", f.name);
  return names;
}

bool is_formula(const FlowInput& input) {
  if (input.volume.files.size() != 1) return false;
  const std::string& name = input.volume.files[0];
  const auto flows = analytic_flows();
  return !std::filesystem::exists(name) &&
         std::any_of(flows.begin(), flows.end(), [&](const AnalyticFlow& f) { return f.name == name; });
}

/// What --array says, or the first array of vectors.
ArrayChoice vectors_of(OpenVolume& volume, const VolumeInput& input) {
  if (!input.array.empty()) return volume.choice();
  std::string names;
  for (const std::size_t components : {std::size_t{3}, std::size_t{2}})
    for (const DatasetArray& a : volume.dataset().arrays())
      if (a.components == components) return {a.name, {}, false};
  for (const DatasetArray& a : volume.dataset().arrays())
    names += fmt::format("{}{} ({})", names.empty() ? "" : ", ", a.name, a.components);
  throw FileError(input.name(),
                  names.empty() ? "holds no arrays" : "holds no vectors; its arrays and their components: " + names);
}

/// Speeds and times of particles are floats. Throws DataError for vectors that make others of them.
void check_speeds(const DatasetArray& vectors) {
  constexpr double kMost = 1e35;
  double most = 0;
  for (std::size_t c = 0; c < vectors.components; ++c)
    if (!std::isnan(vectors.least[c])) most = std::max({most, std::abs(vectors.least[c]), std::abs(vectors.most[c])});
  if (most > kMost || (most > 0 && most < 1 / kMost))
    throw DataError(fmt::format("{}: vectors of up to {:.4g} are too {} to be followed", printable(vectors.name, 60),
                                most, most > 1 ? "large" : "small"));
}

void check_speeds(const DatasetArray& vectors, const std::string& file) {
  try {
    check_speeds(vectors);
  } catch (const DataError& error) {
    throw FileError(file, error.what());
  }
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

/// "step 3: this; 2 more steps have something of the kind".
class StepNotes {
 public:
  explicit StepNotes(std::vector<std::string> first) : first_(std::move(first)) {}

  /// Keeps the notes of a step that the first step does not have. From any thread; the last call for a step counts.
  void add(std::size_t step, const std::string& name, const std::vector<std::string>& notes) {
    std::string more;
    for (const std::string& note : notes)
      if (std::find(first_.begin(), first_.end(), note) == first_.end()) more += (more.empty() ? "" : "; ") + note;
    if (more.empty()) return;
    const std::scoped_lock lock(mutex_);
    of_step_[step] = name + more;
  }
  std::vector<std::string> lines() const {
    const std::scoped_lock lock(mutex_);
    if (of_step_.empty()) return {};
    std::string line = of_step_.begin()->second;
    if (const std::size_t more = of_step_.size() - 1; more > 0)
      line += fmt::format("; {} {} something of the kind", counted(more, "more step"), more == 1 ? "has" : "have");
    return {line};
  }

 private:
  std::vector<std::string> first_;
  mutable std::mutex mutex_;
  std::map<std::size_t, std::string> of_step_;
};

/// The steps of a series, read one at a time.
class StepReader {
 public:
  StepReader(VolumeInput input, DatasetArray array, ArrayChoice choice, const ReconstructionOptions& method,
             FlowStep first, std::vector<std::string> first_notes)
      : notes(std::move(first_notes)),
        input_(std::move(input)),
        array_(std::move(array)),
        choice_(std::move(choice)),
        method_(method),
        first_(std::move(first)) {}

  StepNotes notes;

  FlowStep read(std::size_t i) {
    if (i == 0 && first_.field) return std::exchange(first_, {});
    const bool files = input_.files.size() > 1;
    const std::string& file = input_.files[files ? i : 0];
    VolumeReadOptions options = input_.read;
    options.time_step = files ? input_.read.time_step : i;
    const std::string step = files ? "" : fmt::format("step {}: ", i);
    Progress progress;
    try {
      GridData data = read_volumes({file}, options);
      keep_array(data, file, step);
      const std::vector<std::string> said = data.notes;
      VolumeDataset dataset(std::move(data));
      check_speeds(dataset.array(choice_.array));
      ReconstructionReport report;
      FlowStep read{dataset.field(choice_, method_, progress, &report), report.bytes};
      read.taken = [this, i, said, name = files ? fmt::format("{}: ", printable(file, 200)) : step] {
        notes.add(i, name, said);
      };
      if (read.field->components() != array_.components)
        throw DataError(fmt::format("{} holds vectors of {} components, the first step of {}", array_.name,
                                    read.field->components(), array_.components));
      return read;
    } catch (const ArgumentError& error) {
      throw FileError(file, step + error.what());
    } catch (const DataError& error) {
      throw FileError(file, step + error.what());
    }
  }

 private:
  /// Nothing else is needed of a step.
  void keep_array(GridData& data, const std::string& file, const std::string& step) const {
    bool found = false;
    std::set<std::string> others;
    const auto keep = [&](AttributeTable& arrays, Association of) {
      std::vector<std::string> names;
      for (const Attribute& a : arrays) {
        if (a.name == array_.name && of == array_.of)
          found = true;
        else
          names.push_back(a.name);
      }
      for (const std::string& name : names) arrays.erase(name), others.insert(name);
    };
    for (GridBlock& block : data.blocks)
      keep(block.point_arrays, Association::points), keep(block.cell_arrays, Association::cells);
    if (found) return;
    std::string names;
    for (const std::string& name : others) names += (names.empty() ? "; those there are: " : ", ") + name;
    throw FileError(file, fmt::format("{}has no array {} of {}, as the first step has{}", step, array_.name,
                                      array_.of == Association::points ? "points" : "cells", names));
  }

  VolumeInput input_;
  DatasetArray array_;
  ArrayChoice choice_;
  ReconstructionOptions method_;
  FlowStep first_;
};

}  // namespace

void add_times_option(CommandLine& c, std::vector<double>& times, const char* group) {
  const Option option = c.add_option_function(
                             "--times",
                             [&times](const std::string& text) {
                               const auto read = numbers_in(text);
                               if (!read) throw must_be("numbers with commas between them", text);
                               times.insert(times.end(), read->begin(), read->end());
                             },
                             "With --unsteady: of the files, T0,T1,…, or the first and the step between them [0,1]")
                            .type_name("TIMES");
  if (group != nullptr) option.group(group);
}

std::vector<double> times_of_files(const std::vector<double>& given, std::size_t files) {
  if (given.size() == files) return given;
  if (!given.empty() && given.size() != 2)
    throw ArgumentError(
        fmt::format("--times has {} numbers for {} files: as many, or the first and the step", given.size(), files));
  const double from = given.empty() ? 0 : given[0], step = given.empty() ? 1 : given[1];
  std::vector<double> times(files);
  for (std::size_t i = 0; i < files; ++i) times[i] = from + step * static_cast<double>(i);
  return times;
}

void add_flow_input(CommandLine& c, FlowInput& input) {
  add_volume_input(c, input.volume);
  c.add_flag("--unsteady", input.unsteady,
             "The flow changes: all steps of the file in time, or several files one after the other");
  add_times_option(c, input.times);
  c.add_choice<TimeInterpolation>("--time-interpolation", input.interpolation,
                                  {{"constant", TimeInterpolation::constant},
                                   {"linear", TimeInterpolation::linear},
                                   {"cubic", TimeInterpolation::cubic}},
                                  "Between steps: constant, linear or cubic [linear]")
      .type_name("NAME");
  c.add_option("--memory", input.memory,
               "Steps of a series are kept in so many GiB to be used again [a quarter of the machine's]")
      .type_name("GIB");
  c.add_option("--seeds", input.seeds,
               "line(a, b, n), circle(c, normal, r, n), plane(o, u, v, nu, nv), box(n), point(x,y,z), points(FILE), "
               "curve(FILE), loop(FILE), mesh(FILE), with numbers for a, b, …; several with ; between them")
      .type_name("SEEDS");
}

void add_trace_options(CommandLine& c, TraceOptions& trace) {
  const char* const steps = "Steps";
  c.add_choice<Integrator>("--integrator", trace.integrator,
                           {{"euler", Integrator::euler}, {"rk4", Integrator::rk4}, {"dopri5", Integrator::dopri5}},
                           "euler, rk4, or dopri5 with steps by the tolerance [dopri5]")
      .type_name("NAME")
      .group(steps);
  c.add_option("--tolerance", trace.tolerance, "Error of a step [1e-5 of the diagonal]")
      .type_name("LENGTH")
      .group(steps);
  c.add_option("--step-length", trace.step,
               "Of euler and rk4, and at most of dopri5 [a thousandth and a fiftieth of the diagonal]")
      .type_name("LENGTH")
      .group(steps);
}

OpenFlow::OpenFlow(const FlowInput& input, Console& console) : input_(input) {
  if (is_formula(input)) {
    name_ = input.volume.files[0] + " (formula)";
    field_ = analytic_flow(input.volume.files[0]);
    return;
  }
  if (input.volume.files.size() == 1 && !std::filesystem::exists(input.volume.files[0]) &&
      input.volume.files[0].find_first_of("./") == std::string::npos)
    throw FileError(input.volume.files[0], "no such file, and no flow by formula: " + flow_names());
  const bool series = input.unsteady && input.volume.files.size() > 1;
  if (!input.times.empty() && !series) throw ArgumentError("--times needs --unsteady and several files");
  if (input.memory && !(*input.memory >= 0)) throw ArgumentError("--memory must be at least 0");
  if (input.unsteady) {
    open_series(console);
    return;
  }
  volume_ = std::make_unique<OpenVolume>(input.volume, console);
  choice_ = vectors_of(*volume_, input.volume);
  name_ = fmt::format("{} of {}", choice_.array, input.volume.name());
  check_speeds(volume_->dataset().array(choice_.array), input.volume.name());
  try {
    field_ = volume_flow(volume_->field(choice_));
  } catch (const ArgumentError& error) {
    throw FileError(input.volume.name(), fmt::format("{}: {}", choice_.array, error.what()));
  }
}

void OpenFlow::open_series(Console& console) {
  // The first step says which array, which method and, of a file of several, when the others are.
  const VolumeInput& given = input_.volume;
  const bool files = given.files.size() > 1;
  VolumeInput first = given;
  first.read.time_step = files ? given.read.time_step : 0;
  first.files = {given.files[0]};
  if (!files && given.read.time_step > 0) throw ArgumentError("`time_step`: --unsteady takes all steps of the file");
  for (const std::string& file : given.files)
    if (!std::filesystem::exists(file)) throw FileError(file, "no such file");
  OpenVolume volume(first, console);
  choice_ = vectors_of(volume, first);
  check_speeds(volume.dataset().array(choice_.array), first.name());
  std::vector<double> times = files ? times_of_files(input_.times, given.files.size()) : volume.dataset().times();
  if (times.size() < 2) throw FileError(given.name(), "holds one step in time: nothing changes (leave out --unsteady)");
  FlowStep step{volume.field(choice_), 0};
  step.bytes = volume.report().bytes;
  name_ = fmt::format("{} of {}, {} steps", choice_.array, given.name(), times.size());
  const auto reader = std::make_shared<StepReader>(given, volume.dataset().array(choice_.array), choice_,
                                                   volume.report().options, std::move(step), volume.dataset().notes());
  step_notes_ = [reader] { return reader->notes.lines(); };
  FlowSeriesOptions options;
  options.interpolation = input_.interpolation;
  options.memory = input_.memory ? whole_part<std::uint64_t>(*input_.memory * kGib) : usual_memory();
  try {
    field_ = flow_in_time(
        std::move(times), [reader](std::size_t i) { return reader->read(i); }, options);
  } catch (const ArgumentError& error) {
    throw FileError(given.name(), error.what());
  }
}

void OpenFlow::warn_of_steps(Console& console) const {
  if (step_notes_) console.warn(input_.volume.name(), step_notes_());
}

Seeds OpenFlow::seeds(std::size_t count, Console& console) const {
  Seeds seeds = parse_seeds(input_.seeds.empty() ? fmt::format("box({})", count) : input_.seeds, field_->bounds());
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
    console.warn(seeds.file, {fmt::format("{} of {} not finite, and left out", grouped(gone), counted(all, "seed"))});
  return seeds;
}

Seeds OpenFlow::seed_curve(Console& console) const {
  Seeds seeds = this->seeds(0, console);
  if (!seeds.curve) throw ArgumentError("--seeds must be a curve: line, circle, curve(FILE) or loop(FILE)");
  try {
    SeedCurve{seeds.points, seeds.closed}.validate();
  } catch (const ArgumentError& error) {
    if (seeds.file.empty()) throw ArgumentError(fmt::format("--seeds: {}", error.what()));
    throw FileError(seeds.file, error.what());
  }
  return seeds;
}

FileError OpenFlow::error(const DataError& error) const {
  const Box3 box = field_->bounds();
  return {input_.volume.name(),
          fmt::format("{} (it lies between ({:.6g}, {:.6g}, {:.6g}) and ({:.6g}, {:.6g}, {:.6g}))", error.what(),
                      box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z)};
}

Json OpenFlow::json() const {
  Json json = volume_ ? volume_->json() : input_.volume.json();
  json["vectors"] = choice_.array.empty() ? Json(name_) : Json(choice_.array);
  return json;
}

}  // namespace sansmesh::cli
