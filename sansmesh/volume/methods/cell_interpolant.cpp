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

/// Weights of samples for the value at `x` of their least-squares plane. It is constant in directions without extent.
void plane_weights(std::span<const Vec3> samples, const Vec3& x, std::vector<double>& weights) {
  const std::size_t n = samples.size();
  Vec3 middle;
  for (const Vec3& p : samples) middle += p / static_cast<double>(n);
  // Near samples have larger weights, so that a thin layer next to a thick one keeps its influence.
  std::vector<double> nearness(n);
  double scale = 0;
  for (const Vec3& p : samples) scale += norm(p - x) / static_cast<double>(n);
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    nearness[i] = 1 / (squared_norm(samples[i] - x) + 1e-4 * scale * scale + std::numeric_limits<double>::min());
    sum += nearness[i];
  }
  middle = {};
  for (std::size_t i = 0; i < n; ++i) middle += samples[i] * (nearness[i] / sum);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 d = samples[i] - middle;
    const Eigen::Vector3d v(d.x, d.y, d.z);
    covariance += nearness[i] / sum * v * v.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  const Eigen::Vector3d offset(x.x - middle.x, x.y - middle.y, x.z - middle.z);
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();  // inverse covariance times the offset
  const double largest = axes.eigenvalues()[2];
  for (int k = 0; k < 3; ++k)
    if (axes.eigenvalues()[k] > 1e-13 * largest)
      slope += axes.eigenvectors().col(k) * (axes.eigenvectors().col(k).dot(offset) / axes.eigenvalues()[k]);
  weights.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 d = samples[i] - middle;
    weights[i] = nearness[i] / sum * (1 + slope.dot(Eigen::Vector3d(d.x, d.y, d.z)));
  }
}

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
    std::vector<double> weights;
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
      plane_weights(locations, {}, weights);
      for (std::size_t k = 0; k < n; ++k) {
        double sum = 0, least = std::numeric_limits<double>::max(), most = std::numeric_limits<double>::lowest();
        for (std::size_t i = 0; i < samples.size(); ++i) {
          const double v = values.of(samples[i])[k];
          sum += weights[i] * v;
          least = std::min(least, v), most = std::max(most, v);
        }
        const double beyond = outer_[p] ? 1.5 * (most - least) : 0;
        at_corners_[p * n + k] = std::clamp(sum, least - beyond, most + beyond);
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
