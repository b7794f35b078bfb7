// Options, seeds and results of particles, lines and surfaces in flows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/option.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

// ---- Particles ---------------------------------------------------------------------------------------------------

/// Direction in which particles are followed from their seeds.
enum class FlowDirection : std::uint8_t { forward, backward, both };

/// Reason why a particle stopped.
enum class TraceEnd : std::uint8_t {
  time,            ///< end of the requested duration, or of the field's time
  length,          ///< the requested length
  boundary,        ///< left the domain of the field
  critical_point,  ///< slower than `least_speed`, or no progress for long
  steps,           ///< reached `most_steps`
  outside          ///< began outside the domain of the field
};
/// Names in the order of the enumerators.
inline constexpr std::string_view kTraceEndWords[] = {"time",           "length", "boundary",
                                                      "critical_point", "steps",  "outside"};

/// Options of particle tracing.
struct SANSMESH_API TraceOptions {
  /// Name of the integrator: "euler" (first order, as in the source), "rk4" (classical Runge–Kutta, fourth order),
  /// "dopri5" (dormand1980: orders 5 and 4, step size by tolerance), or one that a program registers.
  std::string integrator = "dopri5";
  bool backward = false;  ///< against the flow, to earlier moments
  /// Accepted error of a dopri5 step (length, > 0). Default: 10⁻⁵ of the diagonal of the field's bounds.
  std::optional<double> tolerance = {};
  /// Length of a step at the speed of its start (> 0); for dopri5 the upper limit. Default: a thousandth (dopri5: a
  /// fiftieth) of the diagonal.
  std::optional<double> step = {};
  double duration = std::numeric_limits<double>::infinity();  ///< time, > 0
  double length = std::numeric_limits<double>::infinity();    ///< length of the line, > 0
  /// Speed (length per time, >= 0) below which a particle has reached a critical point. If not 0, dopri5 particles in
  /// fields without sample_times() also stop when they advance by less than 32 tolerances in 64 steps.
  double least_speed = 0;
  std::size_t most_steps = 20'000;  ///< >= 1, rejected steps included

  /// Options for users; without direction, duration and length, which the caller sets.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

// ---- Lines -------------------------------------------------------------------------------------------------------

/// Kinds of flow lines.
enum class FlowLineKind : std::uint8_t {
  path,    ///< trajectory of one particle; in a steady flow a stream line
  streak,  ///< at one moment, all particles released from one point over time: dye, smoke
  time     ///< particles released together, at several moments
};

/// Options of flow lines.
struct SANSMESH_API FlowLineOptions {
  FlowLineKind kind = FlowLineKind::path;            ///< kind of lines
  FlowDirection direction = FlowDirection::forward;  ///< `both` only for path lines
  /// Moment of release. Default: the field's first (backward: last) moment, 0 where it has none.
  std::optional<double> start = {};
  /// Time, > 0. Default: path lines and streaks run to the end of the field, time lines require a value. Where neither
  /// this nor `length` is given nor the field ends, lines have about five diagonals of the field's bounds.
  std::optional<double> duration = {};
  std::optional<double> length = {};  ///< length of path lines, > 0
  /// Time between particles of a streak, or between time lines, > 0. Default: a hundredth of the duration for streaks,
  /// a tenth for time lines.
  std::optional<double> interval = {};
  bool closed = false;      ///< time lines: the seeds form a closed curve
  TraceOptions trace = {};  ///< its direction, duration and length are ignored

  /// Without `closed`, which follows from the seeds.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Figures of flow lines.
struct SANSMESH_API FlowLineReport {
  std::size_t seeds = 0, outside = 0;  ///< all seeds, and those outside the domain of the flow
  std::array<std::size_t, 6> ends{};   ///< path lines by TraceEnd
  double longest = 0;                  ///< length of the longest line

  static const ReportSchema& schema();  ///< one row per reported value
};

// ---- Surfaces ----------------------------------------------------------------------------------------------------

/// Kinds of surfaces that flow from a seed curve.
enum class FlowSurfaceKind : std::uint8_t {
  stream,  ///< swept by particles of the curve in the flow frozen at `start`
  path,    ///< swept by particles of the curve in the changing flow
  streak,  ///< at the end, all particles released from the curve from `start` on
  time     ///< at the end, all particles released at `start` from the curve and its copies along `sweep`
};

/// Start of a particle inserted between two others.
enum class FlowInsertion : std::uint8_t {
  traced,       ///< on the seed curve, half-way between the starts of its neighbours; traced to its position
  interpolated  ///< half-way between the positions of its neighbours, as in the source; adds an error that stays
};

/// Options of flow surfaces.
struct SANSMESH_API FlowSurfaceOptions {
  std::optional<FlowSurfaceKind> kind = {};  ///< default: stream
  /// `both` is for stream and path surfaces.
  FlowDirection direction = FlowDirection::forward;
  /// Number of particles on the seed curve, spaced evenly by length, >= 2 (closed curves: >= 3). Their distance is Δ₀,
  /// which inserted particles inherit: the finest resolved detail. Default: 256.
  std::optional<std::size_t> seeds = {};
  double alpha = 2;  ///< > 1: gaps wider than α Δ₀ receive a particle, or the surface tears
  double beta = 2;   ///< > 0: the surface tears where such a gap grows by at least β times a particle's step
  /// 0 <= δ < 1, 2 δ <= α: a particle nearer than δ Δ₀ to both neighbours may be removed; 0 keeps all.
  double delta = 0.5;
  FlowInsertion insertion = FlowInsertion::traced;  ///< start of inserted particles
  /// Moment at the seeds. Default: the field's first (backward: last) moment, 0 where it has none.
  std::optional<double> start = {};
  /// Time that particles are followed in each direction, > 0. Streak and time surfaces require it unless the field
  /// ends.
  std::optional<double> duration = {};
  /// Stream and path surfaces end with the front at this length (> 0): the sum, over fronts, of the median step of the
  /// moving particles. Default where neither `duration` nor the field gives an end: five diagonals of its bounds, as in
  /// flow_lines(); else none.
  std::optional<double> length = {};
  /// Time between fronts, > 0. Default: one Δ₀ at the median speed of the front, reduced such that no particle moves
  /// farther than α Δ₀. For streak surfaces the time between releases; unused for time surfaces.
  std::optional<double> front_step = {};
  std::size_t most_fronts = 16'384;      ///< >= 1, in each direction
  std::size_t most_points = 10'000'000;  ///< >= 2: the surface ends with the front that reaches this number, or ten
                                         ///< times as many particle moves
  std::optional<Vec3> sweep = {};  ///< displacement of the last copy of the seed curve of a time surface; not zero
  TraceOptions trace = {};         ///< `backward`, `duration` and `length` are ignored

  /// One row per field
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A particle at a front.
struct FlowPoint {
  Vec3 position;               ///< in the field's coordinates
  Vec3 velocity;               ///< field vector at this position and time
  Vec3 normal;                 ///< unit; orientation is consistent within a connected part
  double s = 0;                ///< starting point: arc length along the seed curve
  double t = 0;                ///< time at this point; streak surfaces: time of release
  std::int32_t front = 0;      ///< front index, negative backward; streak and time surfaces: row of the start
  std::uint32_t particle = 0;  ///< identifies the particle of the point
};

/// Figures of a flow surface.
struct SANSMESH_API FlowSurfaceReport {
  std::size_t particles = 0;          ///< particles followed, seeds included
  std::size_t inserted = 0;           ///< particles inserted between others
  std::size_t removed = 0;            ///< particles removed between near neighbours
  std::size_t tears = 0;              ///< pairs of neighbours separated while both went on
  std::size_t fronts = 0;             ///< fronts, the seeds included; streak and time surfaces: rows
  std::array<std::size_t, 6> ends{};  ///< particles by TraceEnd
  bool complete = true;               ///< false: ended by `most_points`, `most_fronts` or `moments_meet`
  bool moments_meet = false;          ///< fronts so close in time that their moments are the same number
  double spacing = 0;                 ///< Δ₀

  static const ReportSchema& schema();  ///< one row per reported value
};

/// A flow surface. Vertex i of the mesh is points[i]; every vertex belongs to a triangle. Vertex attributes: s, time,
/// speed and front of the points. Triangles are counter-clockwise seen from the side of the normals, (direction of
/// growing s) × velocity.
struct FlowSurface {
  std::vector<FlowPoint> points;  ///< particles at fronts
  TriangleMesh mesh;              ///< triangles between them
  FlowSurfaceReport report;       ///< figures
};

// ---- Seeds -------------------------------------------------------------------------------------------------------

/// Parsed description of seeds. Shapes give `points` in order; of files (points FILE, curve FILE, mesh FILE) only the
/// name is kept, to be read by the caller.
struct Seeds {
  std::vector<Vec3> points;  ///< in coordinates of the flow
  bool curve = false;        ///< consecutive points form a curve
  bool closed = false;       ///< the last point connects to the first
  std::string file;          ///< not empty: the points are in this file
  bool mesh = false;         ///< the file is a mesh, whose vertices are the points
};

/// Parses seeds. line(ax,ay,az, bx,by,bz, n): n points from a to b; circle(cx,cy,cz, nx,ny,nz, radius, n): around c,
/// normal to n; plane(ox,oy,oz, ux,uy,uz, vx,vy,vz, nu, nv): nu × nv points from o along u and v, both ends included;
/// box(n): about n points evenly in `bounds`, also the meaning of an empty text; point(x,y,z); points(FILE),
/// mesh(FILE): the points of a file; curve(FILE), loop(FILE): these as an open or closed curve. Several, separated by
/// ;, form one set of points (no curve). Throws ArgumentError that describes the fault.
SANSMESH_API Seeds parse_seeds(std::string_view text, const Box3& bounds);

// ---- Flows by formula --------------------------------------------------------------------------------------------

/// A flow given by a formula, for tests and teaching and to try seeds and options.
struct AnalyticFlow {
  std::string_view name;  ///< name for users
  std::string_view what;  ///< one-line description
  bool unsteady = false;  ///< depends on time
};

/// The flows that analytic_flow() accepts.
SANSMESH_API std::span<const AnalyticFlow> analytic_flows();

/// The flow of that name, with exact derivatives. Throws ArgumentError that lists the known names.
SANSMESH_API std::unique_ptr<VectorField> analytic_flow(std::string_view name);

}  // namespace sansmesh::inline v1
