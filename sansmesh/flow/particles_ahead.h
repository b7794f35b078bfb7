// Particles traced along with a front before the front needs them.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "sansmesh/flow/trace.h"

namespace sansmesh::inline v1 {

/// A particle that a front needs is traced from the seed curve. For a time series that does not fit into memory this
/// reads all time steps since then. Whenever particles must be traced, those that the front may need next are traced in
/// the same pass, and advance with the front until they are taken.
class ParticlesAhead {
 public:
  bool has(double s) const { return at_.find(s) != at_.end(); }
  /// Adds particles at the current front that start at arc lengths `s` of the seed curve; `was` are their positions at
  /// the previous front.
  void add(std::span<const double> s, const Particles& particles, std::span<const Vec3> was);
  /// Appends the particle from s, which must exist, to those of a front.
  void take(double s, Particles& to, std::vector<Vec3>& was);
  /// Drops all particles except those from `s`, which ascend.
  void keep(std::span<const double> s);
  /// Advances to the next front.
  void move(const VectorField& field, double time, const TraceOptions& options);

 private:
  Particles particles_;
  std::vector<Vec3> was_;
  std::map<double, std::uint32_t> at_;  ///< index of the particle from s, unless taken
};

/// Appends particle i of `from`.
void append_particle(Particles& to, const Particles& from, std::size_t i);

}  // namespace sansmesh::inline v1
