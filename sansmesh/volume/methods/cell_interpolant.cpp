#include "sansmesh/volume/methods/cell_interpolant.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/cells/cell_adjacency.h"

namespace sansmesh::inline v1 {
namespace {

/// Share of the variance that must be explained by a plane so that it extrapolates; from the first, in part.
constexpr double kLeastExplained = 0.75;

/// Least-squares plane through samples for the value at the origin; near samples have larger weights, so that a thin
/// layer next to a thick one keeps its influence. It is constant in directions without extent.
class CornerPlane {
 public:
  explicit CornerPlane(std::span<const Vec3> samples) : samples_(samples), weights_(samples.size()) {
    const std::size_t n = samples.size();
    double scale = 0, sum = 0;
    for (const Vec3& p : samples) scale += norm(p) / static_cast<double>(n);
    for (std::size_t i = 0; i < n; ++i) {
      weights_[i] = 1 / (squared_norm(samples[i]) + 1e-4 * scale * scale + std::numeric_limits<double>::min());
      sum += weights_[i];
    }
    for (std::size_t i = 0; i < n; ++i) weights_[i] /= sum, middle_ += samples[i] * weights_[i];
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 d = samples[i] - middle_;
      const Eigen::Vector3d v(d.x, d.y, d.z);
      covariance += weights_[i] * v * v.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
    inverse_ = Eigen::Matrix3d::Zero();
    for (int k = 0; k < 3; ++k)
      if (axes.eigenvalues()[k] > 1e-13 * axes.eigenvalues()[2])
        inverse_ += axes.eigenvectors().col(k) * axes.eigenvectors().col(k).transpose() / axes.eigenvalues()[k];
  }

  struct Value {
    double value = 0, explained = 1;  ///< share of the variance of the samples, 0..1
  };
  /// The value at the origin for the values of the samples.
  Value of(std::span<const double> f) const {
    double mean = 0;
    for (std::size_t i = 0; i < f.size(); ++i) mean += weights_[i] * f[i];
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < f.size(); ++i) right += weights_[i] * (f[i] - mean) * offset(i);
    const Eigen::Vector3d slope = inverse_ * right;
    double all = 0, left = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
      const double own = f[i] - mean, rest = own - slope.dot(offset(i));
      all += weights_[i] * own * own, left += weights_[i] * rest * rest;
    }
    Value found{mean - slope.dot(Eigen::Vector3d(middle_.x, middle_.y, middle_.z))};
    if (all > 0) found.explained = std::max(1 - left / all, 0.0);
    return found;
  }

 private:
  Eigen::Vector3d offset(std::size_t i) const {
    const Vec3 d = samples_[i] - middle_;
    return {d.x, d.y, d.z};
  }

  std::span<const Vec3> samples_;
  std::vector<double> weights_;
  Vec3 middle_;
  Eigen::Matrix3d inverse_;
};

void unique(std::vector<std::uint32_t>& samples) {
  std::sort(samples.begin(), samples.end());
  samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
}

}  // namespace

CellInterpolant::CellInterpolant(const SampledVolume& volume, const VolumeValues& values)
    : volume_(volume), values_(values) {
  const std::size_t corners = volume.corners.size(), n = values.components;
  const Adjacency around = cells_of_points(volume.cells, corners);
  outer_.assign(corners, 0);
  for (const std::uint32_t face : open_faces(volume.cells, corners))
    for (const std::uint32_t p : ring_of_face(volume.cells, face)) outer_[p] = 1;
  at_corners_.resize(corners * n);
  find_hulls();
  parallel_ranges(0, corners, 512, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> samples;
    std::vector<Vec3> locations;
    std::vector<double> f;
    for (std::size_t p = first; p < last; ++p) {
      samples.clear(), locations.clear();
      for (const std::uint32_t c : around[p]) samples.push_back(volume.cell_sample[c]);
      unique(samples);
      // A corner of the volume may have a single cell: rings are added until a plane is well determined.
      for (int ring = 0; outer_[p] && ring < 3 && (ring == 0 || samples.size() < 10); ++ring) {
        for (std::size_t i = 0, own = samples.size(); i < own; ++i) {
          const auto star = volume.stars[samples[i]];
          samples.insert(samples.end(), star.begin(), star.end());
        }
        unique(samples);
      }
      if (samples.empty()) continue;
      const Vec3 at = volume.corners[p];
      for (const std::uint32_t s : samples) locations.push_back(volume.positions[s] - at);
      const CornerPlane plane(locations);
      f.resize(samples.size());
      for (std::size_t k = 0; k < n; ++k) {
        for (std::size_t i = 0; i < samples.size(); ++i) f[i] = values.of(samples[i])[k];
        const auto [least, most] = std::minmax_element(f.begin(), f.end());
        const CornerPlane::Value at = plane.of(f);
        const double sure = std::clamp((at.explained - kLeastExplained) / (1 - kLeastExplained), 0.0, 1.0);
        const double within = std::clamp(at.value, *least, *most), most_beyond = 1.5 * (*most - *least);
        const double beyond = std::clamp(at.value - within, -most_beyond, most_beyond);
        at_corners_[p * n + k] = within + (outer_[p] ? sure * beyond : 0);
      }
    }
  });
}

void CellInterpolant::find_hulls() {
  if (volume_.cells.size() <= volume_.positions.size()) return;
  const Adjacency pieces = cells_of_samples(volume_);
  const std::vector<std::uint32_t> beyond = face_neighbours(volume_.cells, volume_.corners.size());
  hulls_.first.reserve(pieces.size() + 1);
  for (std::size_t s = 0; s < pieces.size(); ++s) {
    if (pieces[s].size() > 1)
      for (const std::uint32_t cell : pieces[s])
        for (std::size_t f = 0; f < cell_faces(volume_.cells.shapes[cell]).size(); ++f) {
          const auto slot = static_cast<std::uint32_t>(kMostFaces * cell + f);
          if (beyond[slot] == kNoCell || volume_.cell_sample[beyond[slot]] != s) hulls_.entries.push_back(slot);
        }
    hulls_.first.push_back(hulls_.entries.size());
  }
}

/// Tetrahedron between a sample, a face centre or corner, and two corners of the face.
struct CellInterpolant::Wedge {
  double least = -std::numeric_limits<double>::infinity();  ///< smallest barycentric coordinate of the query point
  Vec3 share;  ///< weights of the face centre or third corner, of the first and of the second corner
  Matrix3 edges{{}, {}, {}};
  FaceRing ring;
  std::size_t side = 0;
};

/// Replaces `best` by a tetrahedron of a face that contains the point at `d` from the sample, or violates least.
void CellInterpolant::try_face(std::uint32_t slot, const Vec3& tip, const Vec3& d, Wedge& best) const {
  const FaceRing ring = ring_of_face(volume_.cells, slot);
  std::array<Vec3, 4> at;
  Vec3 middle;
  for (std::size_t k = 0; k < ring.count; ++k) {
    at[k] = volume_.corner(ring.points[k]) - tip;
    middle += at[k] * 0.25;
  }
  for (std::size_t k = 0; k < (ring.count == 4 ? 4u : 1u); ++k) {
    const Matrix3 m{ring.count == 4 ? middle : at[2], at[k], at[(k + 1) % ring.count]};
    const Vec3 u = m.solve(d);
    if (!is_finite(u)) continue;
    const double least = std::min({u.x, u.y, u.z, 1 - u.x - u.y - u.z});
    if (least > best.least) best = {least, u, m, ring, k};
  }
}

void CellInterpolant::evaluate(const CellLocation& location, const Vec3& x, std::span<double> values,
                               std::span<Vec3> gradients) const {
  const std::uint32_t sample = volume_.cell_sample[location.cell];
  const Vec3 tip = volume_.positions[sample], d = x - tip;
  Wedge best;
  if (!hulls_.entries.empty() && !hulls_[sample].empty()) {
    for (const std::uint32_t slot : hulls_[sample])
      if (!(best.least >= 0)) try_face(slot, tip, d, best);
  } else {
    const std::size_t faces = cell_faces(volume_.cells.shapes[location.cell]).size();
    for (std::size_t f = 0; f < faces && !(best.least >= 0); ++f)
      try_face(static_cast<std::uint32_t>(kMostFaces * location.cell + f), tip, d, best);
  }
  const std::size_t n = values_.components;
  const auto own = values_.of(sample);
  if (!std::isfinite(best.least)) {
    std::copy(own.begin(), own.end(), values.begin());
    std::fill(gradients.begin(), gradients.end(), Vec3{});
    return;
  }
  const FaceRing& ring = best.ring;
  const auto at = [&](std::size_t k, std::size_t c) { return at_corners_[ring.points[k % ring.count] * n + c]; };
  for (std::size_t c = 0; c < n; ++c) {
    const double middle = (ring.count == 4 ? (at(0, c) + at(1, c) + at(2, c) + at(3, c)) / 4 : at(2, c)) - own[c];
    const Vec3 rise{middle, at(best.side, c) - own[c], at(best.side + 1, c) - own[c]};
    values[c] = own[c] + dot(rise, best.share);
    if (!gradients.empty()) {
      const Vec3 g = best.edges.solve_transposed(rise);
      gradients[c] = is_finite(g) ? g : Vec3{};
    }
  }
}

}  // namespace sansmesh::inline v1
