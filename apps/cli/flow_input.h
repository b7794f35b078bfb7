// A flow that a command reads: the vectors of a volume, of a series of volumes in time, or a formula.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sansmesh/core/error.h"
#include "sansmesh/dataset/volume_flow.h"
#include "sansmesh/field/vector_field.h"
#include "sansmesh/flow/seeds.h"
#include "sansmesh/flow/trace.h"
#include "volume_input.h"

namespace sansmesh::cli {

struct FlowInput {
  VolumeInput volume;
  bool unsteady = false;      ///< all steps of the file, or the files one after the other
  std::vector<double> times;  ///< of files that are the steps; empty: 0, 1, 2, … or as the file says
  TimeInterpolation interpolation = TimeInterpolation::linear;
  std::optional<double> memory;  ///< GiB for steps that were read
  std::string seeds;
};

/// DATA, --array and --method, --unsteady, --times, --time-interpolation, --memory and --seeds.
void add_flow_input(CommandLine& command, FlowInput& input);

/// --times
void add_times_option(CommandLine& command, std::vector<double>& times, const char* group = nullptr);
/// When so many files are, as --times says: of each, or the first and the step; 0, 1, 2, … if nothing was given. Throws
/// ArgumentError for other numbers of times.
std::vector<double> times_of_files(const std::vector<double>& given, std::size_t files);

/// --integrator, --tolerance, --step-length
void add_trace_options(CommandLine& command, TraceOptions& trace);
/// What the footers of these commands say of DATA.
inline constexpr const char* kFlowsByFormula =
    "DATA may also be a flow by formula: rotation, helix, saddle, abc, double-gyre, tornado or past-sphere.\n\n";

/// A flow that was read. Errors of the data are thrown as FileError that name the file.
class OpenFlow {
 public:
  OpenFlow(const FlowInput& input, Console& console);

  const VectorField& field() const { return *field_; }
  /// "velocity of office.vtk", "abc (formula)".
  const std::string& name() const { return name_; }
  /// The volume of a steady flow; null of others.
  OpenVolume* volume() { return volume_.get(); }
  /// Warns of what is so with steps that were read since, and not with the first: missing values, say.
  void warn_of_steps(Console& console) const;
  /// As --seeds says, those of files read (what is not finite there is left out, with a warning); without it `count`
  /// seeds in the box of the flow.
  Seeds seeds(std::size_t count, Console& console) const;
  /// The same, which must be a curve.
  Seeds seed_curve(Console& console) const;
  /// The same with the name of the file, and where the flow lies.
  FileError error(const DataError& error) const;
  Json json() const;

 private:
  void open_series(Console& console);

  const FlowInput& input_;
  std::unique_ptr<OpenVolume> volume_;
  ArrayChoice choice_;
  std::string name_;
  std::shared_ptr<const VectorField> field_;
  std::function<std::vector<std::string>()> step_notes_;  ///< of a series
};

}  // namespace sansmesh::cli
