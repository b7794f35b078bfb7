#include "sansmesh/dataset/held_values.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "sansmesh/volume/cells/cell_adjacency.h"

namespace sansmesh::inline v1 {

HeldValues::HeldValues(std::shared_ptr<const SampledVolume> volume, const ValueRange& samples)
    : volume_(std::move(volume)), samples_(samples), least_(-std::numeric_limits<double>::infinity()) {
  if (samples.least > 0) {
    const double decades = std::log10(samples.most / samples.least);
    least_ = samples.least - std::max(1 - 0.5 * decades, 0.0) * (samples.most - samples.least);
  }
  if (!volume_->in_cells || volume_->lattice) return;
  locator_ = std::make_shared<const VolumeLocator>(*volume_);
  outer_.assign(volume_->corners.size(), 0);
  for (const std::uint32_t face : open_faces(volume_->cells, volume_->corners.size()))
    for (const std::uint32_t p : ring_of_face(volume_->cells, face)) outer_[p] = 1;
}

/// 0 within the outermost samples, 1 at the surface.
double HeldValues::beyond_in_lattice(const Vec3& x) const {
  const Lattice& lattice = *volume_->lattice;
  const Vec3 a = lattice.to_axes(x);
  double most = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<double>& axis = lattice.axes[k];
    const double below = axis.front() - lattice.lower[k], above = lattice.upper[k] - axis.back();
    if (below > 0) most = std::max(most, (axis.front() - a[k]) / below);
    if (above > 0) most = std::max(most, (a[k] - axis.back()) / above);
  }
  return std::min(most, 1.0);
}

void HeldValues::hold(std::span<const Vec3> x, std::span<double> values) const {
  const auto toward = [&](std::size_t i, double share) {
    const double held = std::clamp(values[i], samples_.least, samples_.most);
    values[i] += std::clamp(share, 0.0, 1.0) * (held - values[i]);
  };
  const auto leaves = [&](double v) { return v < samples_.least || v > samples_.most; };
  if (volume_->in_cells && volume_->lattice) {
    for (std::size_t i = 0; i < x.size(); ++i)
      if (leaves(values[i])) toward(i, beyond_in_lattice(x[i]));
  } else if (volume_->in_cells) {
    std::vector<std::size_t> which;
    std::vector<Vec3> there;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (leaves(values[i])) which.push_back(i), there.push_back(x[i]);
    std::vector<CellLocation> locations(there.size());
    locator_->locate(there, locations);
    for (std::size_t n = 0; n < which.size(); ++n) {
      double outer = 0;
      for (std::size_t v = 0; v < locations[n].corner_count; ++v)
        outer += locations[n].weights[v] * outer_[locations[n].corners[v]];
      // Half-way between the inner and the outer faces lies the sample.
      toward(which[n], 2 * outer - 1);
    }
  }
  for (double& v : values) v = std::max(v, least_);
}

}  // namespace sansmesh::inline v1
