#include "sansmesh/volume/samples/near_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sansmesh::inline v1 {
namespace {

constexpr int kMostLatticeSteps = 9;  // reach on lattices: an octant at a corner holds 400 samples
constexpr int kMostNearRings = 8;

struct LatticeOffset {
  std::array<std::ptrdiff_t, 3> by;
  double square;
};

/// Offsets in steps, nearest first.
const std::vector<LatticeOffset>& lattice_offsets() {
  static const std::vector<LatticeOffset> offsets = [] {
    std::vector<LatticeOffset> all;
    for (std::ptrdiff_t z = -kMostLatticeSteps; z <= kMostLatticeSteps; ++z)
      for (std::ptrdiff_t y = -kMostLatticeSteps; y <= kMostLatticeSteps; ++y)
        for (std::ptrdiff_t x = -kMostLatticeSteps; x <= kMostLatticeSteps; ++x)
          if (const auto square = x * x + y * y + z * z; square <= kMostLatticeSteps * kMostLatticeSteps)
            all.push_back({{x, y, z}, static_cast<double>(square)});
    std::stable_sort(all.begin(), all.end(),
                     [](const LatticeOffset& a, const LatticeOffset& b) { return a.square < b.square; });
    return all;
  }();
  return offsets;
}

/// Whether all samples within `margin` steps exist.
bool is_inside(const Lattice& lattice, std::size_t sample, std::size_t margin) {
  const auto at = lattice.indices(sample);
  for (std::size_t k = 0; k < 3; ++k)
    if (lattice.axes[k].size() > 1 && (at[k] < margin || at[k] + margin >= lattice.axes[k].size())) return false;
  return true;
}

}  // namespace

NearSamples::NearSamples(const SampledVolume& volume, std::span<const StarMetric> metrics)
    : volume_(volume), metrics_(metrics), stencil_(volume) {}

void NearSamples::gather(std::uint32_t sample, std::size_t count) {
  repeated_ = gather_inside(sample, count);
  if (repeated_) return;
  found_.clear();
  if (volume_.lattice) {
    gather_on_lattice(sample, count);
  } else {
    // Rings are no balls: half as many samples again reach as far in all directions.
    stencil_.gather(sample, metrics_[sample], count + count / 2, 4 * count, kMostNearRings);
    const auto samples = stencil_.samples();
    const auto local = stencil_.local();
    for (std::size_t i = 0; i < samples.size(); ++i) found_.push_back({squared_norm(local[i]), samples[i], local[i]});
    found_[0].square = -1;  // ahead of coincident ones
  }
  if (!volume_.lattice || !volume_.lattice->uniform) std::sort(found_.begin(), found_.end());
  found_[0].square = 0;
  std::size_t n = std::min(count, found_.size());
  while (n < found_.size() && found_[n].square <= found_[n - 1].square * (1 + 1e-9)) ++n;
  samples_.resize(n), local_.resize(n), squares_.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    samples_[i] = found_[i].sample, local_[i] = found_[i].local, squares_[i] = found_[i].square;
  // Inside a uniform lattice the next stencils may be translations of this one.
  inside_count_ = 0;
  if (!volume_.lattice || !volume_.lattice->uniform) return;
  const double reach = std::sqrt(squares_.back());
  margin_ = static_cast<std::size_t>(reach + 1e-9);
  if (!is_inside(*volume_.lattice, sample, margin_)) return;
  inside_count_ = count;
  inside_.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    inside_[i] = static_cast<std::ptrdiff_t>(samples_[i]) - static_cast<std::ptrdiff_t>(sample);
}

bool NearSamples::gather_inside(std::uint32_t sample, std::size_t count) {
  if (inside_count_ != count || !is_inside(*volume_.lattice, sample, margin_)) return false;
  for (std::size_t i = 0; i < inside_.size(); ++i)
    samples_[i] = static_cast<std::uint32_t>(static_cast<std::ptrdiff_t>(sample) + inside_[i]);
  return true;
}

void NearSamples::gather_on_lattice(std::uint32_t sample, std::size_t count) {
  const Lattice& lattice = *volume_.lattice;
  const auto at = lattice.indices(sample);
  std::array<std::ptrdiff_t, 3> own{}, size{};
  std::array<double, 3> inverse{};
  for (std::size_t k = 0; k < 3; ++k) {
    own[k] = static_cast<std::ptrdiff_t>(at[k]), size[k] = static_cast<std::ptrdiff_t>(lattice.axes[k].size());
    inverse[k] = 1 / lattice_step(lattice.axes[k], at[k]);
  }
  double last = std::numeric_limits<double>::infinity();
  for (const LatticeOffset& offset : lattice_offsets()) {
    if (offset.square > last) break;
    std::array<std::ptrdiff_t, 3> to{};
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k) {
      to[k] = own[k] + offset.by[k];
      inside = inside && to[k] >= 0 && to[k] < size[k];
    }
    if (!inside) continue;
    Vec3 u{static_cast<double>(offset.by[0]), static_cast<double>(offset.by[1]), static_cast<double>(offset.by[2])};
    if (!lattice.uniform)
      for (std::size_t k = 0; k < 3; ++k)
        u[k] = (lattice.axes[k][static_cast<std::size_t>(to[k])] - lattice.axes[k][at[k]]) * inverse[k];
    found_.push_back({lattice.uniform ? offset.square : squared_norm(u),
                      static_cast<std::uint32_t>(to[0] + size[0] * (to[1] + size[1] * to[2])), u});
    if (found_.size() == count) last = offset.square;
  }
}

double NearSamples::radius(std::size_t count) const {
  const std::size_t n = squares_.size();
  if (count >= n) return std::sqrt(squares_.back()) * 1.1;
  // A shell of equally near samples is inside as a whole.
  std::size_t next = count;
  while (next < n && squares_[next] <= squares_[count - 1] * (1 + 1e-9)) ++next;
  return next < n ? std::sqrt(squares_[next]) : std::sqrt(squares_.back()) * 1.1;
}

}  // namespace sansmesh::inline v1
