// Particles that go along with a front before it needs them.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "sansmesh/flow/trace.h"

namespace sansmesh::inline v1 {

/// A particle that a front needs is traced from the seed curve: of a series in time that does not fit into memory all
/// steps since then are read for it. So whenever some have to be, those that the front may need next are traced with
/// them, in the same pass, and go along from front to front until they are taken.
class ParticlesAhead {
 public:
  bool has(double s) const { return at_.find(s) != at_.end(); }
  /// Particles at the present front, from the places `s` of the seed curve, and where they were at the front before.
  void add(std::span<const double> s, const Particles& particles, std::span<const Vec3> was);
  /// The particle from s, which must be there, is appended to those of a front.
  void take(double s, Particles& to, std::vector<Vec3>& was);
  /// Forgets all but those from `s`, which ascend.
  void keep(std::span<const double> s);
  /// To the next front.
  void move(const VectorField& field, double time, const TraceOptions& options);

 private:
  Particles particles_;
  std::vector<Vec3> was_;
  std::map<double, std::uint32_t> at_;  ///< which of them is from s; others were taken
};

/// Appends one of `from`.
void append_particle(Particles& to, const Particles& from, std::size_t i);

}  // namespace sansmesh::inline v1
