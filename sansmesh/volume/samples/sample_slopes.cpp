#include "sansmesh/volume/samples/sample_slopes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/samples/sample_gradients.h"

namespace sansmesh::inline v1 {
namespace {

/// Smallest spacing over the longest step of a lattice: rounder supports would not contain a second slice.
constexpr double kOfLongest = 0.6;

/// Reach of comparisons across a level set in spacings, and squared cosine to the gradient.
constexpr double kAcross = 2.2, kCone = 0.64;

/// Smallest volume of a sample off lattices over its cubed spacing: stars may be flat.
constexpr double kLeastVolume = 1e-3;

using Indices = std::array<std::size_t, 3>;

std::size_t before(std::size_t i) { return i > 0 ? i - 1 : 0; }
std::size_t after(std::size_t i, std::size_t n) { return std::min(i + 1, n - 1); }

/// Half the distance between the neighbours along each axis.
std::array<double, 3> steps(const Lattice& l, const Indices& at) {
  std::array<double, 3> s{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t low = before(at[a]), high = after(at[a], l.axes[a].size());
    s[a] = (l.axes[a][high] - l.axes[a][low]) / static_cast<double>(high - low);
  }
  return s;
}

Vec3 lattice_gradient(const Lattice& l, std::span<const double> values, std::size_t sample) {
  const Indices at = l.indices(sample);
  const std::size_t nx = l.axes[0].size(), ny = l.axes[1].size();
  // Three positions along each axis, clamped at the ends, and their weights.
  std::array<Indices, 3> near{};
  for (std::size_t a = 0; a < 3; ++a) near[a] = {before(at[a]), at[a], after(at[a], l.axes[a].size())};
  constexpr std::array<double, 3> kMean{0.25, 0.5, 0.25};
  Vec3 g;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t j = 0; j < 3; ++j) {
      const double* const row = values.data() + (near[2][k] * ny + near[1][j]) * nx;
      const double low = row[near[0][0]], middle = row[near[0][1]], high = row[near[0][2]];
      const double mean = kMean[0] * low + kMean[1] * middle + kMean[2] * high;
      g.x += kMean[j] * kMean[k] * (high - low);
      if (j != 1) g.y += (j == 2 ? 1 : -1) * kMean[k] * mean;
      if (k != 1) g.z += (k == 2 ? 1 : -1) * kMean[j] * mean;
    }
  for (std::size_t a = 0; a < 3; ++a) {
    const double span = l.axes[a][near[a][2]] - l.axes[a][near[a][0]];
    g[a] /= span;
  }
  return l.directions[0] * g.x + l.directions[1] * g.y + l.directions[2] * g.z;
}

/// Calls look(sample, offset) for the samples in a box around the ball of radius `reach`, at most four steps along an
/// axis.
template <class Look>
void look_around(const Lattice& l, std::size_t sample, double reach, const Look& look) {
  const Indices at = l.indices(sample);
  const auto s = steps(l, at);
  Indices first{}, last{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto wide = index_in<std::size_t>(reach / s[a], 1, 4);
    first[a] = at[a] > wide ? at[a] - wide : 0;
    last[a] = std::min(at[a] + wide, l.axes[a].size() - 1);
  }
  const std::size_t nx = l.axes[0].size(), ny = l.axes[1].size();
  for (std::size_t k = first[2]; k <= last[2]; ++k)
    for (std::size_t j = first[1]; j <= last[1]; ++j)
      for (std::size_t i = first[0]; i <= last[0]; ++i)
        look((k * ny + j) * nx + i, l.directions[0] * (l.axes[0][i] - l.axes[0][at[0]]) +
                                        l.directions[1] * (l.axes[1][j] - l.axes[1][at[1]]) +
                                        l.directions[2] * (l.axes[2][k] - l.axes[2][at[2]]));
}

}  // namespace

SampleSlopes::SampleSlopes(const SampledVolume& volume, std::span<const double> values)
    : volume_(volume), values_(values) {
  if (volume.lattice) return;
  VolumeValues scalar;
  scalar.values.assign(values.begin(), values.end());
  gradients_ = detail::sample_gradients(volume, scalar);
  spacing_.resize(volume.size());
  parallel_for(0, volume.size(), 4096, [&](std::size_t i) {
    double sum = 0;
    for (const std::uint32_t s : volume.stars[i]) sum += norm(volume.positions[s] - volume.positions[i]);
    const std::size_t n = volume.stars[i].size();
    spacing_[i] = static_cast<float>(n > 0 && sum > 0 ? sum / static_cast<double>(n) : volume.facts.median_spacing);
  });
}

Vec3 SampleSlopes::gradient(std::size_t sample) const {
  return volume_.lattice ? lattice_gradient(*volume_.lattice, values_, sample) : gradients_[sample];
}

double SampleSlopes::spacing(std::size_t sample) const {
  if (!volume_.lattice) return static_cast<double>(spacing_[sample]);
  const auto s = steps(*volume_.lattice, volume_.lattice->indices(sample));
  return std::max(std::cbrt(s[0] * s[1] * s[2]), kOfLongest * std::max({s[0], s[1], s[2]}));
}

double SampleSlopes::spacing_along(std::size_t sample, const Vec3& direction) const {
  // Radius of the ellipsoid with these half axes, or with the moments of the neighbours.
  double squares = 0;
  if (volume_.lattice) {
    const Lattice& l = *volume_.lattice;
    const auto s = steps(l, l.indices(sample));
    for (std::size_t a = 0; a < 3; ++a) {
      const double along = s[a] * dot(l.directions[a], direction);
      squares += along * along;
    }
    return std::sqrt(squares);
  }
  const auto& star = volume_.stars[sample];
  for (const std::uint32_t i : star) {
    const double along = dot(volume_.positions[i] - volume_.positions[sample], direction);
    squares += along * along;
  }
  return squares > 0 ? std::sqrt(3 * squares / static_cast<double>(star.size())) : spacing(sample);
}

double SampleSlopes::volume(std::size_t sample) const {
  if (!volume_.lattice) {
    // Of the box for which the neighbours of its centre have the same moments.
    const auto& star = volume_.stars[sample];
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    for (const std::uint32_t i : star) {
      const Vec3 d = volume_.positions[i] - volume_.positions[sample];
      xx += d.x * d.x, xy += d.x * d.y, xz += d.x * d.z, yy += d.y * d.y, yz += d.y * d.z, zz += d.z * d.z;
    }
    const double s = spacing(sample), share = star.empty() ? 0 : 3 / static_cast<double>(star.size());
    const double determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    return std::max(std::sqrt(std::max(determinant, 0.0) * share * share * share), kLeastVolume * s * s * s);
  }
  const auto s = steps(*volume_.lattice, volume_.lattice->indices(sample));
  return s[0] * s[1] * s[2];
}

double SampleSlopes::contrast(std::size_t sample) const {
  const double v = values_[sample];
  double most = 0;
  if (!volume_.lattice) {
    for (const std::uint32_t s : volume_.stars[sample]) most = std::max(most, std::abs(values_[s] - v));
    return most;
  }
  const Lattice& l = *volume_.lattice;
  const Indices at = l.indices(sample);
  std::size_t stride = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (at[a] > 0) most = std::max(most, std::abs(values_[sample - stride] - v));
    if (at[a] + 1 < l.axes[a].size()) most = std::max(most, std::abs(values_[sample + stride] - v));
    stride *= l.axes[a].size();
  }
  return most;
}

std::vector<float> steepest_across(const SampledVolume& volume, const SampleSlopes& slopes,
                                   std::span<const float> steep, double least) {
  std::vector<float> most(steep.size());
  parallel_for(0, steep.size(), 4096, [&](std::size_t i) {
    if (!(static_cast<double>(steep[i]) >= least) || !(steep[i] > 0)) return;
    const Vec3 gradient = slopes.gradient(i);
    const double reach = kAcross * slopes.spacing(i);
    float found = steep[i];
    const auto look = [&](std::size_t other, const Vec3& offset) {
      const double far = squared_norm(offset), along = dot(offset, gradient);
      if (far > reach * reach || along * along < kCone * far * squared_norm(gradient)) return;
      found = std::max(found, steep[other]);
    };
    if (volume.lattice) {
      look_around(*volume.lattice, i, reach, look);
    } else {
      const Vec3& x = volume.positions[i];
      for (const std::uint32_t s : volume.stars[i]) {
        look(s, volume.positions[s] - x);
        for (const std::uint32_t t : volume.stars[s]) look(t, volume.positions[t] - x);
      }
    }
    most[i] = found;
  });
  return most;
}

}  // namespace sansmesh::inline v1
