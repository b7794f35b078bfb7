#include "sansmesh/flow/particles_ahead.h"

#include <algorithm>
#include <utility>

namespace sansmesh::inline v1 {

void append_particle(Particles& to, const Particles& from, std::size_t i) {
  to.positions.push_back(from.positions[i]);
  to.times.push_back(from.times[i]);
  to.velocities.push_back(from.velocities[i]);
  to.steps.push_back(from.steps[i]);
  to.ends.push_back(from.ends[i]);
}

void ParticlesAhead::add(std::span<const double> s, const Particles& particles, std::span<const Vec3> was) {
  for (std::size_t i = 0; i < s.size(); ++i) {
    at_[s[i]] = static_cast<std::uint32_t>(was_.size());
    append_particle(particles_, particles, i);
    was_.push_back(was[i]);
  }
}

void ParticlesAhead::take(double s, Particles& to, std::vector<Vec3>& was) {
  const auto found = at_.find(s);
  append_particle(to, particles_, found->second);
  was.push_back(was_[found->second]);
  at_.erase(found);
}

void ParticlesAhead::keep(std::span<const double> s) {
  Particles particles;
  std::vector<Vec3> was;
  std::map<double, std::uint32_t> at;
  for (const auto& [seed, i] : at_) {
    if (!std::binary_search(s.begin(), s.end(), seed)) continue;
    at[seed] = static_cast<std::uint32_t>(was.size());
    append_particle(particles, particles_, i);
    was.push_back(was_[i]);
  }
  particles_ = std::move(particles), was_ = std::move(was), at_ = std::move(at);
}

void ParticlesAhead::move(const VectorField& field, double time, const TraceOptions& options) {
  std::vector<std::uint32_t> which;
  for (const auto& [s, i] : at_) {
    which.push_back(i);
    was_[i] = particles_.positions[i];
  }
  move_particles(field, particles_, which, time, options);
}

}  // namespace sansmesh::inline v1
