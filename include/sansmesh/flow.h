// Flows that are open (the vectors of a volume, of a series of volumes in time, or a formula), their lines and
// surfaces.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/flow_options.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/polyline_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/vector_field.h"
#include "sansmesh/volume_options.h"
#include "sansmesh/volumes.h"

namespace sansmesh::inline v1 {

// ---- Opening -----------------------------------------------------------------------------------------------------

/// How files become a flow.
struct SANSMESH_API FlowModelOptions {
  bool unsteady = false;           ///< all steps of the file, or the files one after the other
  std::vector<double> times = {};  ///< of files that are the steps: each, or the first and the step; default: 0, 1, …
  TimeInterpolation time_interpolation = TimeInterpolation::linear;  ///< between steps
  std::optional<double> memory = {};  ///< GiB for steps that were read; default: a quarter of the machine's

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Help on options of seeds.
inline constexpr std::string_view kSeedsText =
    "line(a, b, n), circle(c, normal, r, n), plane(o, u, v, nu, nv), box(n), point(x,y,z), points(FILE), curve(FILE), "
    "loop(FILE), mesh(FILE), with numbers for a, b, …; several with ; between them";

/// A flow with its name. Cheap to copy: what it holds is shared.
class SANSMESH_API FlowModel {
 public:
  /// Any flow. `name` stands in messages: "abc (formula)", "velocity of office.vtk".
  FlowModel(std::shared_ptr<const VectorField> field, std::string name);
  /// An array of vectors of a volume, as VolumeModelOptions names it; of an empty name the first one. Throws DataError
  /// where there is none.
  FlowModel(const VolumeModel& volume, const std::string& array, Progress& progress);

  /// The velocity anywhere.
  const VectorField& field() const;
  /// What it is called in messages.
  const std::string& name() const;
  /// What was opened, for messages: the files, or the formula.
  const std::string& source() const;
  /// The array; empty of formulas.
  const std::string& vectors() const;
  /// Whether it changes.
  bool unsteady() const;
  /// The volume of a steady flow; nothing of others.
  const std::optional<VolumeModel>& volume() const;
  /// "volume", "reconstruction": of the volume or the first step.
  const std::vector<Note>& opened_notes() const;
  /// "steps": what is so with steps that were read since, and not with the first: missing values, say.
  std::vector<Note> step_notes() const;

  /// Places as parse_seeds reads them, those of files read (what is not finite there is left out, with the note
  /// "not_finite"); of an empty text `usual` places in the box of the flow. Throws ArgumentError, FileError.
  Seeds seeds(const std::string& text, std::size_t usual, std::vector<Note>& notes) const;
  /// The same, which must be a curve.
  Seeds seed_curve(const std::string& text, std::vector<Note>& notes) const;

  /// Of the library.
  struct State;
  explicit FlowModel(std::shared_ptr<const State> state);  ///< of the library

 private:
  std::shared_ptr<const State> state_;
};

/// Files, or the name of a flow by formula. Throws FileError, ArgumentError for bad options, and DataError that begins
/// with a name.
SANSMESH_API FlowModel open_flow(const std::vector<std::string>& files, const VolumeModelOptions& volume,
                                 const FlowModelOptions& options, Progress& progress);

// ---- Lines -------------------------------------------------------------------------------------------------------

/// Lines, where they begin and what they carry.
struct SANSMESH_API TraceLinesOptions {
  std::string seeds = {};      ///< as parse_seeds reads it; default: 200 in the box of the flow
  FlowLineOptions lines = {};  ///< `closed` follows from the seeds
  /// Other arrays of a steady volume that are told along the lines: names with commas, "all" or "none".
  std::string carry = "none";

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// The array that colours lines by default.
SANSMESH_API std::string usual_color(const FlowLineOptions& options);

/// Lines with what is told along them.
struct TraceLinesResult {
  /// In coordinates of the flow. Attributes of points: `time` (double; of streaks when the particle left), `speed`
  /// (float), `velocity` and `vorticity` (three floats each), and what is carried; of lines: `seed` (number of the
  /// seed; of time lines that of the moment), `length` (float) and of path lines `end` (a TraceEnd).
  PolylineSet lines;
  FlowLineReport report;  ///< in numbers
  /// "not_finite", "reconstruction": of seeds and carried arrays; "steps": of a series; "outside": seeds out of the
  /// flow.
  std::vector<Note> notes;
};

/// Lines, seeds and ends, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const TraceLinesResult& made);

/// Names of the arrays that the points will have. Throws ArgumentError for such as the flow has not.
SANSMESH_API std::vector<std::string> arrays_along_lines(const FlowModel& flow, const TraceLinesOptions& options);

/// Stream, path, streak and time lines. Throws ArgumentError for bad options, FileError for seeds of a file, DataError
/// that begins with the flow's source where no seed is in the flow or nothing moves; Cancelled.
SANSMESH_API TraceLinesResult trace_lines_of(const FlowModel& flow, const TraceLinesOptions& options,
                                             Progress& progress);

// ---- Surfaces ----------------------------------------------------------------------------------------------------

/// A surface and where it begins.
struct SANSMESH_API TraceSurfaceOptions {
  std::string seeds = {};  ///< a curve as parse_seeds reads it: needed
  /// Its kind follows from the flow where it is not given; the number of particles from the seeds, unless these are of
  /// a file.
  FlowSurfaceOptions surface = {};

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A surface of a flow.
struct SANSMESH_API TraceSurfaceResult {
  FlowSurface surface;  ///< with its report
  double area = 0;      ///< of its mesh (length²)
  /// "not_finite": of seeds; "steps": of a series; "moments_meet", "too_many": what ended the surface before its end;
  /// "outside": particles that began out of the flow.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Particles and fronts, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const FlowSurfaceReport& report);

/// Stream, path, streak and time surfaces from a seed curve; the same bytes for any number of threads. Throws
/// ArgumentError for bad options, FileError for seeds of a file, DataError that begins with the flow's source where no
/// part of the curve lies in the flow, or it stands still on all of it; Cancelled.
SANSMESH_API TraceSurfaceResult trace_surface(const FlowModel& flow, const TraceSurfaceOptions& options,
                                              Progress& progress);

}  // namespace sansmesh::inline v1
