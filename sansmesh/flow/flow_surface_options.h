// Options of surfaces of a flow, and what they are made of (flow_surface.h).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "sansmesh/flow/trace.h"
#include "sansmesh/option.h"
#include "sansmesh/report.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

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

struct FlowSurfaceOptions {
  std::optional<FlowSurfaceKind> kind = {};  ///< default: stream
  /// `both` is for stream and path surfaces.
  FlowDirection direction = FlowDirection::forward;
  /// Particles on the seed curve, evenly by length, >= 2 (of a closed curve >= 3). Their distance along it is Δ₀, which
  /// particles put between others inherit: the finest detail that is looked for. Default: 256.
  std::optional<std::size_t> seeds = {};
  double alpha = 2;    ///< > 1: gaps wider than α Δ₀ get a particle, or the surface tears
  double beta = 2;     ///< > 0: it tears where such a gap grows by β times a particle's step or more
  double delta = 0.5;  ///< 0 <= δ < 1, 2 δ <= α: particles nearer than δ Δ₀ to both neighbours may go; 0 keeps all
  FlowInsertion insertion = FlowInsertion::traced;
  /// Moment at the seeds. Default: the field's first (backward: last) one, 0 where it has none.
  std::optional<double> start;
  /// How long particles are followed (time, > 0), in each direction. Streak and time surfaces need one, or a field that
  /// ends.
  std::optional<double> duration = {};
  /// Stream and path surfaces end with the front at which particles have gone so far (length, > 0): the sum of the
  /// medians of their steps from front to front, without those at rest. Default where neither `duration` nor the field
  /// gives an end: five diagonals of its bounds, as of flow_lines(); else none.
  std::optional<double> length;
  /// Time between fronts, > 0. Default: one Δ₀ at the median speed of the particles on each, or as much less as it
  /// takes that none goes farther than α Δ₀. Of streak surfaces between releases; of no use to time surfaces.
  std::optional<double> front_step;
  std::size_t most_fronts = 16'384;      ///< >= 1, in each direction
  std::size_t most_points = 10'000'000;  ///< >= 2: the surface ends with the front that reaches them, or
                                         ///< ten times as many moves of a particle to a front
  std::optional<Vec3> sweep = {};        ///< of time surfaces, not zero: the seeds are the curve moved by 0..1 of it
  TraceOptions trace;                    ///< `backward`, `duration` and `length` do not count

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A particle at a front.
struct FlowPoint {
  Vec3 position;
  Vec3 velocity;               ///< of the field there and then
  Vec3 normal;                 ///< unit; sides do not change over a part of the surface
  double s = 0;                ///< where it began, as length along the seed curve
  double t = 0;                ///< when it was here; of streak surfaces when it left the curve
  std::int32_t front = 0;      ///< its number, negative backward; of streak and time surfaces the row of its start
  std::uint32_t particle = 0;  ///< the same for all points of a particle
};

struct FlowSurfaceReport {
  std::size_t particles = 0;          ///< that were followed, seeds included
  std::size_t inserted = 0;           ///< between others
  std::size_t removed = 0;            ///< between others that were near
  std::size_t tears = 0;              ///< pairs of neighbours that were parted although both went on
  std::size_t fronts = 0;             ///< the seeds included; of streak and time surfaces rows
  std::array<std::size_t, 6> ends{};  ///< of particles, by TraceEnd
  bool complete = true;               ///< false: `most_points`, `most_fronts` or `moments_meet` ended it
  bool moments_meet = false;          ///< fronts were so near in time that their moments are the same number
  double spacing = 0;                 ///< Δ₀

  static const ReportSchema& schema();
};

}  // namespace sansmesh::inline v1
