#include "sansmesh/jobs/flow/flow_series.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/dataset/joined_arrays.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/error.h"
#include "sansmesh/io/grids/read_volume.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kMostSpeed = 1e35;

/// Notes on later steps that the first step does not have.
class StepNotes {
 public:
  explicit StepNotes(std::vector<std::string> first) : first_(std::move(first)) {}

  /// Thread-safe; the last call for a step counts.
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
      line += fmt::format("; {} {} similar notes", counted(more, "more step"), more == 1 ? "has" : "have");
    return {line};
  }

 private:
  std::vector<std::string> first_;
  mutable std::mutex mutex_;
  std::map<std::size_t, std::string> of_step_;
};

class StepReader {
 public:
  explicit StepReader(FlowSeries series) : notes(std::move(series.first_notes)), series_(std::move(series)) {}

  StepNotes notes;

  FlowStep read(std::size_t i) {
    if (i == 0 && series_.first.field) return std::exchange(series_.first, {});
    const bool files = series_.files.size() > 1;
    const std::string& file = series_.files[files ? i : 0];
    VolumeReadOptions options = series_.read;
    options.time_step = files ? series_.read.time_step : i;
    const std::string step = files ? "" : fmt::format("step {}: ", i);
    Progress progress;
    try {
      GridData data = read_volumes({file}, options);
      join_arrays(data, series_.array.name);
      keep_array(data, file, step);
      const std::vector<std::string> said = data.notes;
      VolumeDataset dataset(std::move(data));
      check_speeds(dataset.array(series_.choice.array));
      VolumeReconstructionReport report;
      FlowStep read{dataset.field(series_.choice, series_.method, progress, &report), report.bytes};
      read.taken = [this, i, said, name = files ? fmt::format("{}: ", printable(file, 200)) : step] {
        notes.add(i, name, said);
      };
      if (read.field->components() != series_.array.components)
        throw DataError(fmt::format("{} has vectors of {} components, the first step of {}", series_.array.name,
                                    read.field->components(), series_.array.components));
      return read;
    } catch (const ArgumentError& error) {
      throw FileError(file, step + error.what());
    } catch (const DataError& error) {
      throw FileError(file, step + error.what());
    }
  }

 private:
  /// Drops all other arrays of a step.
  void keep_array(GridData& data, const std::string& file, const std::string& step) const {
    const DatasetArray& array = series_.array;
    bool found = false;
    std::set<std::string> others;
    const auto keep = [&](AttributeTable& arrays, Association of) {
      std::vector<std::string> names;
      for (const Attribute& a : arrays) {
        if (a.name == array.name && of == array.of)
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
    throw FileError(file, fmt::format("{}has no array {} of {}, as the first step has{}", step, array.name,
                                      array.of == Association::points ? "points" : "cells", names));
  }

  FlowSeries series_;
};

}  // namespace

FlowStepReader flow_step_reader(FlowSeries series) {
  const auto reader = std::make_shared<StepReader>(std::move(series));
  return {[reader](std::size_t i) { return reader->read(i); }, [reader] { return reader->notes.lines(); }};
}

void check_speeds(const DatasetArray& vectors) {
  double most = 0;
  for (std::size_t c = 0; c < vectors.components; ++c)
    if (!std::isnan(vectors.least[c])) most = std::max({most, std::abs(vectors.least[c]), std::abs(vectors.most[c])});
  if (most > kMostSpeed || (most > 0 && most < 1 / kMostSpeed))
    throw DataError(fmt::format("{}: vectors of up to {:.4g} are too {} to trace", printable(vectors.name, 60), most,
                                most > 1 ? "large" : "small"));
}

}  // namespace sansmesh::inline v1
