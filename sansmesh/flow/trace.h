// Tracing of particles in a flow (tejada2008, 5.3), in batches of one query per stage of a step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/flow_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/vec.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

/// The given tolerance, or the default for this field.
double trace_tolerance(const VectorField& field, const TraceOptions& options);

/// Line i has the points offsets[i] .. offsets[i + 1], in the order in which the particle passed them, its seed first;
/// no points if it began outside.
struct Traces {
  std::vector<std::size_t> offsets{0};
  std::vector<Vec3> positions;
  std::vector<double> times;
  std::vector<Vec3> velocities;  ///< field at the ends of steps; interpolated between them
  std::vector<TraceEnd> ends;    ///< per line
  std::size_t size() const { return ends.size(); }
};

/// Stream lines (in steady fields) or path lines from the seeds, each from its moment. Sizes must agree. Lines have a
/// point per step, and more by the integrator's own interpolation where they turn: by at most 0.2 radians from point to
/// point, with chords off by at most 2·10⁻⁴ of the diagonal; points nearer than that are left out. Particles are
/// independent: byte-identical for any batch and number of threads. Throws ArgumentError for bad options.
Traces trace_lines(const VectorField& field, std::span<const Vec3> seeds, std::span<const double> moments,
                   const TraceOptions& options, Progress& progress);

/// Particles in motion, for algorithms that need all of them at the same moments.
struct Particles {
  std::vector<Vec3> positions;
  std::vector<double> times;
  std::vector<Vec3> velocities;               ///< field at the positions; set by move_particles()
  std::vector<double> steps;                  ///< next step of the integrator (time); 0: unknown
  std::vector<std::optional<TraceEnd>> ends;  ///< empty while the particle moves
};

/// Particles at their seeds.
Particles particles_at(const VectorField& field, std::span<const Vec3> seeds, std::span<const double> moments);

/// Moves those of `which` that have not ended to the moment `time` (later than theirs; earlier with `backward`), or to
/// their ends. `duration` and `length` of the options are ignored. Runs in parts on several threads, all together from
/// one moment of the field to the next.
void move_particles(const VectorField& field, Particles& particles, std::span<const std::uint32_t> which, double time,
                    const TraceOptions& options);

}  // namespace sansmesh::inline v1
