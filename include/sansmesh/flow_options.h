// Particles, lines and surfaces of flows: where they begin, how they are followed, and what was found.
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

/// Direction of particles from their seeds.
enum class FlowDirection : std::uint8_t { forward, backward, both };

/// Why a particle stopped.
enum class TraceEnd : std::uint8_t {
  time,            ///< the moment asked for, or the last one of the field
  length,          ///< the length asked for
  boundary,        ///< where the field ends
  critical_point,  ///< slower than `least_speed`, or no farther for long
  steps,           ///< more steps than `most_steps`
  outside          ///< it began where there is no field
};
/// Words for them, in the order of the enumerators.
inline constexpr std::string_view kTraceEndWords[] = {"time",           "length", "boundary",
                                                      "critical_point", "steps",  "outside"};

/// How particles are followed.
struct SANSMESH_API TraceOptions {
  /// How steps are made, by name: "euler" (the source's, of first order), "rk4" (Runge and Kutta's classical ones, of
  /// fourth order), "dopri5" (Dormand and Prince's pair of orders 5 and 4: as long as the tolerance allows), or what a
  /// program adds.
  std::string integrator = "dopri5";
  bool backward = false;  ///< against the flow, to earlier moments
  /// Error of a step of dopri5 (length, > 0). Default: 10⁻⁵ of the diagonal of the field's bounds.
  std::optional<double> tolerance = {};
  /// How far a step goes (length, > 0): of euler and rk4 as far as that at the speed where it starts, of dopri5 at
  /// most. Default: a thousandth (of dopri5 a fiftieth) of that diagonal.
  std::optional<double> step = {};
  double duration = std::numeric_limits<double>::infinity();  ///< time, > 0
  double length = std::numeric_limits<double>::infinity();    ///< of the line, > 0
  /// Length per time, >= 0: slower ones have arrived at a critical point. Where this is not 0, and the field has no
  /// moments(), so have lines of dopri5 that do not get farther than 32 tolerances in 64 steps.
  double least_speed = 0;
  std::size_t most_steps = 20'000;  ///< >= 1, tries included

  /// Options for users: not the direction, duration and length, which follow from what is traced.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

// ---- Lines -------------------------------------------------------------------------------------------------------

/// Lines of a flow.
enum class FlowLineKind : std::uint8_t {
  path,    ///< where one particle goes; in a steady flow the stream line
  streak,  ///< where all those are that left one place one after the other: dye, smoke
  time     ///< where those are that left together, at several moments
};

/// Which lines, and how they are followed.
struct SANSMESH_API FlowLineOptions {
  FlowLineKind kind = FlowLineKind::path;            ///< which lines
  FlowDirection direction = FlowDirection::forward;  ///< `both` is for path lines
  /// Moment at which particles leave. Default: the field's first (backward: last) one, 0 where it has none.
  std::optional<double> start = {};
  /// Of path lines and streaks until the end of the field, of others to be given: time, > 0. Default where neither this
  /// nor `length` is given: as long as lines of five diagonals of the field's bounds take.
  std::optional<double> duration = {};
  std::optional<double> length = {};  ///< of path lines, > 0 (length)
  /// streak: between particles; time: between lines (time, > 0). Default: a hundredth of the duration, of time lines a
  /// tenth.
  std::optional<double> interval = {};
  bool closed = false;      ///< time lines: the seeds are a closed curve
  TraceOptions trace = {};  ///< but its direction, duration and length

  /// Without `closed`, which the seeds say.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Lines in numbers.
struct SANSMESH_API FlowLineReport {
  std::size_t seeds = 0, outside = 0;  ///< all, and those that lie out of the flow
  std::array<std::size_t, 6> ends{};   ///< of path lines, by TraceEnd
  double longest = 0;                  ///< length

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

// ---- Surfaces ----------------------------------------------------------------------------------------------------

/// Surfaces of a flow from a seed curve.
enum class FlowSurfaceKind : std::uint8_t {
  stream,  ///< where particles from the curve come to in the flow as it is at `start`
  path,    ///< where they come to in the flow as it changes
  streak,  ///< where those are at the end that left the curve at all moments from `start` to then
  time     ///< where those are at the end that left, all at `start`, the curve and its copies along `sweep`
};

/// Where a particle begins that is put between two others.
enum class FlowInsertion : std::uint8_t {
  traced,       ///< on the seed curve, half-way between where they did: it is where the flow takes it
  interpolated  ///< the source's: half-way between where they are; its error stays
};

/// Which surface, and how finely it is followed.
struct SANSMESH_API FlowSurfaceOptions {
  std::optional<FlowSurfaceKind> kind = {};  ///< default: stream
  /// `both` is for stream and path surfaces.
  FlowDirection direction = FlowDirection::forward;
  /// Particles on the seed curve, evenly by length, >= 2 (of a closed curve >= 3). Their distance along it is Δ₀, which
  /// particles put between others inherit: the finest detail that is looked for. Default: 256.
  std::optional<std::size_t> seeds = {};
  double alpha = 2;    ///< > 1: gaps wider than α Δ₀ get a particle, or the surface tears
  double beta = 2;     ///< > 0: it tears where such a gap grows by β times a particle's step or more
  double delta = 0.5;  ///< 0 <= δ < 1, 2 δ <= α: particles nearer than δ Δ₀ to both neighbours may go; 0 keeps all
  FlowInsertion insertion = FlowInsertion::traced;  ///< of particles between others
  /// Moment at the seeds. Default: the field's first (backward: last) one, 0 where it has none.
  std::optional<double> start = {};
  /// How long particles are followed (time, > 0), in each direction. Streak and time surfaces need one, or a field that
  /// ends.
  std::optional<double> duration = {};
  /// Stream and path surfaces end with the front at which particles have gone so far (length, > 0): the sum of the
  /// medians of their steps from front to front, without those at rest. Default where neither `duration` nor the field
  /// gives an end: five diagonals of its bounds, as of flow_lines(); else none.
  std::optional<double> length = {};
  /// Time between fronts, > 0. Default: one Δ₀ at the median speed of the particles on each, or as much less as it
  /// takes that none goes farther than α Δ₀. Of streak surfaces between releases; of no use to time surfaces.
  std::optional<double> front_step = {};
  std::size_t most_fronts = 16'384;      ///< >= 1, in each direction
  std::size_t most_points = 10'000'000;  ///< >= 2: the surface ends with the front that reaches them, or
                                         ///< ten times as many moves of a particle to a front
  std::optional<Vec3> sweep = {};        ///< of time surfaces, not zero: the seeds are the curve moved by 0..1 of it
  TraceOptions trace = {};               ///< `backward`, `duration` and `length` do not count

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A particle at a front.
struct FlowPoint {
  Vec3 position;               ///< in coordinates of the field
  Vec3 velocity;               ///< of the field there and then
  Vec3 normal;                 ///< unit; sides do not change over a part of the surface
  double s = 0;                ///< where it began, as length along the seed curve
  double t = 0;                ///< when it was here; of streak surfaces when it left the curve
  std::int32_t front = 0;      ///< its number, negative backward; of streak and time surfaces the row of its start
  std::uint32_t particle = 0;  ///< the same for all points of a particle
};

/// A surface in numbers.
struct SANSMESH_API FlowSurfaceReport {
  std::size_t particles = 0;          ///< that were followed, seeds included
  std::size_t inserted = 0;           ///< between others
  std::size_t removed = 0;            ///< between others that were near
  std::size_t tears = 0;              ///< pairs of neighbours that were parted although both went on
  std::size_t fronts = 0;             ///< the seeds included; of streak and time surfaces rows
  std::array<std::size_t, 6> ends{};  ///< of particles, by TraceEnd
  bool complete = true;               ///< false: `most_points`, `most_fronts` or `moments_meet` ended it
  bool moments_meet = false;          ///< fronts were so near in time that their moments are the same number
  double spacing = 0;                 ///< Δ₀

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Vertex i of the mesh is points[i]. Neighbours share vertices; there are none without a triangle. Attributes of the
/// vertices: s, time, speed, front, as in the points. Triangles are counter-clockwise seen from where the normals
/// point: along (direction of growing s) × velocity.
struct FlowSurface {
  std::vector<FlowPoint> points;  ///< particles at fronts
  TriangleMesh mesh;              ///< between them
  FlowSurfaceReport report;       ///< in numbers
};

// ---- Seeds -------------------------------------------------------------------------------------------------------

/// What a text of seeds stands for. Shapes: `points` in order; of files (points FILE, curve FILE, mesh FILE) only the
/// name, for whoever can read them.
struct Seeds {
  std::vector<Vec3> points;  ///< in coordinates of the flow
  bool curve = false;        ///< the points follow one another along a curve
  bool closed = false;       ///< and the last is followed by the first
  std::string file;          ///< not empty: the points are those of a file
  bool mesh = false;         ///< that file is a mesh: its vertices
};

/// line(ax,ay,az, bx,by,bz, n): n points from a to b; circle(cx,cy,cz, nx,ny,nz, radius, n): around c, across n;
/// plane(ox,oy,oz, ux,uy,uz, vx,vy,vz, nu, nv): nu × nv points from o along u and v, both ends included;
/// box(n): about n points evenly in `bounds`, so also without any text; point(x,y,z); points(FILE), mesh(FILE): those
/// of a file; curve(FILE), loop(FILE): these as a curve. Several with ; between them make one set of points (no curve).
/// Throws ArgumentError saying what is wrong with the text.
SANSMESH_API Seeds parse_seeds(std::string_view text, const Box3& bounds);

// ---- Flows by formula --------------------------------------------------------------------------------------------

/// A flow by formula: for tests, for teaching, and to try seeds and options on.
struct AnalyticFlow {
  std::string_view name;  ///< as users write it
  std::string_view what;  ///< a line about it
  bool unsteady = false;  ///< it changes
};

/// Those that analytic_flow() knows.
SANSMESH_API std::span<const AnalyticFlow> analytic_flows();

/// The flow of that name, with exact derivatives. Throws ArgumentError naming those that there are.
SANSMESH_API std::unique_ptr<VectorField> analytic_flow(std::string_view name);

}  // namespace sansmesh::inline v1
