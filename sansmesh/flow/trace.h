// Particles that follow a flow (METHODS §5.2): many at once, a batch of places for each stage of a step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "sansmesh/flow_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/vec.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

/// The tolerance given, or the default of this field.
double trace_tolerance(const VectorField& field, const TraceOptions& options);

/// Lines one after the other: line i has the points offsets[i] .. offsets[i + 1], in the order in which the particle
/// passed them, its seed first; none where it began outside.
struct Traces {
  std::vector<std::size_t> offsets{0};
  std::vector<Vec3> positions;
  std::vector<double> times;
  std::vector<Vec3> velocities;  ///< of the field at the ends of steps; between them interpolated
  std::vector<TraceEnd> ends;    ///< of each line
  std::size_t size() const { return ends.size(); }
};

/// Stream lines (in steady fields) or path lines from the seeds, each from its moment. Sizes must agree. Lines are as
/// fine as the steps, and finer, by the integrator's own interpolation, where these turn: by no more than 0.2 radians
/// from point to point, chords being off by no more than 2·10⁻⁴ of the diagonal; points nearer than that are left out.
/// The particles do not see each other: the same bytes whatever the batch and the number of threads. Throws
/// ArgumentError for bad options.
Traces trace_lines(const VectorField& field, std::span<const Vec3> seeds, std::span<const double> moments,
                   const TraceOptions& options, Progress& progress);

/// Particles on their way, for those who look at all of them at the same moments.
struct Particles {
  std::vector<Vec3> positions;
  std::vector<double> times;
  std::vector<Vec3> velocities;               ///< of the field there; set by move()
  std::vector<double> steps;                  ///< of the integrator's next step (time); 0: not known
  std::vector<std::optional<TraceEnd>> ends;  ///< nothing while it moves
};

/// Particles at rest at their seeds.
Particles particles_at(const VectorField& field, std::span<const Vec3> seeds, std::span<const double> moments);

/// Moves those of `which` that have not ended to the moment `time` (later than theirs; earlier with `backward`), or to
/// their ends. `duration` and `length` of the options do not count. In parts on several threads, all together from one
/// moment of the field to the next.
void move_particles(const VectorField& field, Particles& particles, std::span<const std::uint32_t> which, double time,
                    const TraceOptions& options);

}  // namespace sansmesh::inline v1
