// Published formulas in double precision with a sum over all samples: slow reference implementations.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sansmesh/points/shape/principal_axes.h"
#include "sansmesh/surface/surface_samples.h"

namespace sansmesh::test {

/// A surface's samples in its order, with the documented widths and weights.
struct Weighed {
  std::vector<Vec3> x, n;
  std::vector<double> h, factor;
  bool gaussian = false;

  Weighed(const SurfaceSamples& samples, double smoothing, SurfaceWeights weights)
      : gaussian(weights == SurfaceWeights::gaussian) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      x.emplace_back(samples.positions[i]), n.emplace_back(samples.normals[i]);
      const double s = static_cast<double>(samples.spacing[i]);
      h.push_back(smoothing * (gaussian ? samples.median_spacing : s));
      factor.push_back(gaussian ? 1 : s * s / (samples.median_spacing * samples.median_spacing));
    }
  }

  double weight(std::size_t i, const Vec3& at) const {
    const double r = squared_norm(at - x[i]) / (h[i] * h[i]);
    if (gaussian) return r < 12 ? factor[i] * std::exp(-r) : 0;
    return factor[i] * std::pow(std::max(0.0, 1 - r / 4), 4);
  }
  // Width of the weights at a point.
  double width(const Vec3& at) const {
    double sum = 0, weights = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += weight(i, at) * h[i] * h[i], weights += weight(i, at);
    return std::sqrt(sum / weights);
  }
  Vec3 mean(const Vec3& at) const {
    Vec3 sum;
    double weights = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] * weight(i, at), weights += weight(i, at);
    return sum / weights;
  }
  Vec3 mean_normal(const Vec3& at) const {
    Vec3 sum;
    for (std::size_t i = 0; i < x.size(); ++i) sum += n[i] * weight(i, at);
    return normalized(sum);
  }
  /// Direction of least Σ w ⟨n, x_i − about⟩², on the side of the mean normal.
  Vec3 least_covariance(const Vec3& at, const Vec3& about) const {
    Symmetric3 c;
    for (std::size_t i = 0; i < x.size(); ++i) c.add(x[i] - about, weight(i, at));
    const Vec3 axis = principal_axes(c).axes[0];
    return dot(axis, mean_normal(at)) < 0 ? -axis : axis;
  }
};

}  // namespace sansmesh::test
