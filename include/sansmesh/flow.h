// Opens flows (the vectors of a volume, of a series of volumes in time, or a formula) and traces lines and surfaces.
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

/// Interpretation of files as a flow.
struct SANSMESH_API FlowModelOptions {
  bool unsteady = false;  ///< unsteady: all steps of the file, or one file per step
  std::vector<double> times =
      {};  ///< times of files that are steps: all, or the first and the interval; default: 0, 1, …
  TimeInterpolation time_interpolation = TimeInterpolation::linear;  ///< between steps
  std::optional<double> memory = {};  ///< memory for steps in GiB; default: a quarter of the machine's

  /// Option rows, one per field.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Help on options of seeds.
inline constexpr std::string_view kSeedsText =
    "line(a, b, n), circle(c, normal, r, n), plane(o, u, v, nu, nv), box(n), point(x,y,z), points(FILE), curve(FILE), "
    "loop(FILE), mesh(FILE), with numbers for a, b, …; several with ; between them";

/// A flow with its name. Cheap to copy: copies share their data.
class SANSMESH_API FlowModel {
 public:
  /// Any flow. `name` appears in messages: "abc (formula)", "velocity of office.vtk".
  FlowModel(std::shared_ptr<const VectorField> field, std::string name);
  /// An array of vectors of a volume, named as in VolumeModelOptions; the first one if the name is empty. Throws
  /// DataError if there is none.
  FlowModel(const VolumeModel& volume, const std::string& array, Progress& progress);

  /// Velocity field.
  const VectorField& field() const;
  /// Name in messages.
  const std::string& name() const;
  /// Source in messages: the files, or the formula.
  const std::string& source() const;
  /// Name of the array; empty for formulas.
  const std::string& vectors() const;
  /// Whether the flow changes in time.
  bool unsteady() const;
  /// Volume of a steady flow.
  const std::optional<VolumeModel>& volume() const;
  /// "volume", "reconstruction": notes on the volume or the first step.
  const std::vector<Note>& opened_notes() const;
  /// "steps": notes on steps read since then that the first step does not have (missing values, for example).
  std::vector<Note> step_notes() const;

  /// Seeds in the syntax of parse_seeds, with those of files read (points that are not finite are dropped, with the
  /// note "not_finite"). An empty text gives `default_count` seeds in the box of the flow. Throws ArgumentError,
  /// FileError.
  Seeds seeds(const std::string& text, std::size_t default_count, std::vector<Note>& notes) const;
  /// Seeds that must form a curve. Throws as seeds().
  Seeds seed_curve(const std::string& text, std::vector<Note>& notes) const;

  /// Internal state.
  struct State;
  explicit FlowModel(std::shared_ptr<const State> state);  ///< for the library only

 private:
  std::shared_ptr<const State> state_;
};

/// Opens files, or a flow by the name of its formula. Throws FileError, ArgumentError for bad options, and DataError
/// that begins with a name.
SANSMESH_API FlowModel open_flow(const std::vector<std::string>& files, const VolumeModelOptions& volume,
                                 const FlowModelOptions& options, Progress& progress);

// ---- Lines -------------------------------------------------------------------------------------------------------

/// Options of flow lines.
struct SANSMESH_API TraceLinesOptions {
  std::string seeds = {};      ///< seeds in the syntax of parse_seeds; default: 200 in the box of the flow
  FlowLineOptions lines = {};  ///< `closed` follows from the seeds
  /// Other arrays of a steady volume that are sampled along the lines: names with commas, "all" or "none".
  std::string carry = "none";

  /// Option rows, one per field.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Array that colours lines by default.
SANSMESH_API std::string default_color(const FlowLineOptions& options);

/// Lines with the quantities along them.
struct TraceLinesResult {
  /// Lines in coordinates of the flow. Point attributes: `time` (double; for streak lines the release time of the
  /// particle), `speed` (float), `velocity` and `vorticity` (three floats each), and carried arrays. Line attributes:
  /// `seed` (number of the seed; for time lines, of the moment), `length` (float) and, for path lines, `end` (a
  /// TraceEnd).
  PolylineSet lines;
  FlowLineReport report;  ///< counts and measures
  /// "not_finite", "reconstruction": for seeds and carried arrays; "steps": for a series; "outside": seeds outside the
  /// flow.
  std::vector<Note> notes;
};

/// Lines, seeds and ends, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const TraceLinesResult& made);

/// Names of the point arrays of the lines. Throws ArgumentError for arrays that the flow does not have.
SANSMESH_API std::vector<std::string> arrays_along_lines(const FlowModel& flow, const TraceLinesOptions& options);

/// Traces stream, path, streak and time lines. Throws ArgumentError for bad options, FileError for seeds of a file,
/// DataError that begins with the flow's source if no seed is in the flow or nothing moves; Cancelled.
SANSMESH_API TraceLinesResult trace_lines_of(const FlowModel& flow, const TraceLinesOptions& options,
                                             Progress& progress);

// ---- Surfaces ----------------------------------------------------------------------------------------------------

/// Options of a flow surface.
struct SANSMESH_API TraceSurfaceOptions {
  std::string seeds = {};  ///< seed curve in the syntax of parse_seeds; required
  /// Its kind follows from the flow if not given. The number of particles follows from the seeds, unless they are read
  /// from a file.
  FlowSurfaceOptions surface = {};

  /// Option rows, one per field.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Surface of a flow.
struct SANSMESH_API TraceSurfaceResult {
  FlowSurface surface;  ///< surface with its report
  double area = 0;      ///< area of its mesh (length²)
  /// "not_finite": for seeds; "steps": for a series; "moments_meet", "too_many": why the surface ended early;
  /// "outside": particles that start outside the flow.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< report rows
};

/// Particles and fronts, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const FlowSurfaceReport& report);

/// Traces stream, path, streak and time surfaces from a seed curve. Results do not depend on the number of threads.
/// Throws ArgumentError for bad options, FileError for seeds of a file, DataError that begins with the flow's source if
/// no part of the curve is in the flow or all of it is stagnant; Cancelled.
SANSMESH_API TraceSurfaceResult trace_surface(const FlowModel& flow, const TraceSurfaceOptions& options,
                                              Progress& progress);

}  // namespace sansmesh::inline v1
