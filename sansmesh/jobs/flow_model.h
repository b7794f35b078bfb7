// A flow that is open: the vectors of a volume, of a series of volumes in time, or a formula.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/dataset/volume_flow.h"
#include "sansmesh/error.h"
#include "sansmesh/flow/seeds.h"
#include "sansmesh/jobs/volume_model.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

struct FlowModelOptions {
  bool unsteady = false;           ///< all steps of the file, or the files one after the other
  std::vector<double> times = {};  ///< of files that are the steps: each, or the first and the step; default: 0, 1, …
  TimeInterpolation time_interpolation = TimeInterpolation::linear;
  std::optional<double> memory = {};  ///< GiB for steps that were read; default: a quarter of the machine's

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Help on options of seeds.
inline constexpr std::string_view kSeedsText =
    "line(a, b, n), circle(c, normal, r, n), plane(o, u, v, nu, nv), box(n), point(x,y,z), points(FILE), curve(FILE), "
    "loop(FILE), mesh(FILE), with numbers for a, b, …; several with ; between them";

/// Cheap to copy: what it holds is shared.
class FlowModel {
 public:
  /// Any flow. `name` stands in messages: "abc (formula)", "velocity of office.vtk".
  FlowModel(std::shared_ptr<const VectorField> field, std::string name);
  /// An array of vectors of a volume, as VolumeModelOptions names it; of an empty name the first one. Throws DataError
  /// where there is none.
  FlowModel(VolumeModel volume, const std::string& array, Progress& progress);

  const VectorField& field() const { return *field_; }
  const std::string& name() const { return name_; }
  /// What was opened, for messages: the files, or the formula.
  const std::string& source() const { return source_; }
  /// The array; empty of formulas.
  const std::string& vectors() const { return vectors_; }
  bool unsteady() const { return unsteady_; }
  /// The volume of a steady flow; null of others.
  VolumeModel* volume() const { return volume_.get(); }
  /// "volume", "reconstruction": of the volume or the first step.
  const std::vector<Note>& opened_notes() const { return notes_; }
  /// "steps": what is so with steps that were read since, and not with the first: missing values, say.
  std::vector<Note> step_notes() const;

  /// Places as parse_seeds reads them, those of files read (what is not finite there is left out, with the note
  /// "not_finite"); of an empty text `usual` places in the box of the flow. Throws ArgumentError, FileError.
  Seeds seeds(const std::string& text, std::size_t usual, std::vector<Note>& notes) const;
  /// The same, which must be a curve.
  Seeds seed_curve(const std::string& text, std::vector<Note>& notes) const;
  /// The same error with where the flow lies.
  DataError error(const DataError& error) const;

 private:
  /// Steps that are read as they are needed.
  static FlowModel series(const std::vector<std::string>& files, const VolumeModelOptions& volume,
                          const FlowModelOptions& options, Progress& progress);
  friend FlowModel open_flow(const std::vector<std::string>& files, const VolumeModelOptions& volume,
                             const FlowModelOptions& options, Progress& progress);

  std::shared_ptr<const VectorField> field_;
  std::string name_, source_, vectors_;
  bool unsteady_ = false;
  std::shared_ptr<VolumeModel> volume_;
  std::vector<Note> notes_;
  std::function<std::vector<std::string>()> step_notes_;  ///< of a series
};

/// Files, or the name of a flow by formula. Throws FileError, ArgumentError for bad options, and DataError that begins
/// with a name.
FlowModel open_flow(const std::vector<std::string>& files, const VolumeModelOptions& volume,
                    const FlowModelOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
