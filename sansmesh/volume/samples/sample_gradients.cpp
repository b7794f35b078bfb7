#include "sansmesh/volume/samples/sample_gradients.h"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr std::size_t kMostNear = 48;    ///< largest number of samples of two rings in use: the nearest
constexpr double kQuadraticRank = 0.01;  ///< smallest pivot of the basis over the largest
constexpr double kStraightRank = 0.01;
constexpr double kLeastDistance = 0.05;  ///< distance below which weights are constant; 1 at the farthest neighbour

}  // namespace

std::vector<Vec3> sample_gradients(const SampledVolume& volume, const VolumeValues& values) {
  const std::size_t n = volume.size(), components = values.components;
  std::vector<Vec3> gradients(n * components);
  parallel_ranges(0, n, 128, [&](std::size_t first, std::size_t last) {
    struct Near {
      double squared;
      std::uint32_t sample;
      bool operator<(const Near& o) const { return squared != o.squared ? squared < o.squared : sample < o.sample; }
    };
    std::vector<Near> near;
    std::vector<std::uint32_t> rings;
    std::vector<Vec3> offsets;
    Eigen::MatrixXd basis, right, solution;
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> quadratic;
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> straight;
    for (std::size_t i = first; i < last; ++i) {
      const Vec3 x = volume.positions[i];
      const auto star = volume.stars[i];
      if (star.empty()) continue;
      offsets.clear(), rings.clear(), near.clear();
      for (const std::uint32_t s : star) {
        offsets.push_back(volume.positions[s] - x);
        rings.push_back(s);
        const auto next = volume.stars[s];
        rings.insert(rings.end(), next.begin(), next.end());
      }
      const StarMetric metric = star_metric(offsets, 1);
      std::sort(rings.begin(), rings.end());
      rings.erase(std::unique(rings.begin(), rings.end()), rings.end());
      for (const std::uint32_t s : rings)
        if (s != i) near.push_back({squared_norm(metric(volume.positions[s] - x)), s});
      std::sort(near.begin(), near.end());
      if (near.size() > kMostNear) near.resize(kMostNear);
      const auto fill = [&](Eigen::Index columns) {
        const auto rows = static_cast<Eigen::Index>(near.size());
        basis.resize(rows, columns), right.resize(rows, static_cast<Eigen::Index>(components));
        for (Eigen::Index r = 0; r < rows; ++r) {
          const Near& s = near[static_cast<std::size_t>(r)];
          const Vec3 u = metric(volume.positions[s.sample] - x);
          const double root = 1 / std::max(std::sqrt(s.squared), kLeastDistance);
          basis(r, 0) = root * u.x, basis(r, 1) = root * u.y, basis(r, 2) = root * u.z;
          if (columns > 3) {
            basis(r, 3) = root * u.x * u.x, basis(r, 4) = root * u.y * u.y, basis(r, 5) = root * u.z * u.z;
            basis(r, 6) = root * u.x * u.y, basis(r, 7) = root * u.y * u.z, basis(r, 8) = root * u.z * u.x;
          }
          for (std::size_t c = 0; c < components; ++c)
            right(r, static_cast<Eigen::Index>(c)) = root * (values.of(s.sample)[c] - values.of(i)[c]);
        }
      };
      bool solved = false;
      if (near.size() >= 10) {
        fill(9);
        quadratic.setThreshold(kQuadraticRank);
        quadratic.compute(basis);
        solved = quadratic.rank() == 9;
        if (solved) solution = quadratic.solve(right);
      }
      if (!solved) {
        fill(3);
        straight.setThreshold(kStraightRank);
        straight.compute(basis);
        solution = straight.solve(right);
      }
      for (std::size_t c = 0; c < components; ++c) {
        const auto column = static_cast<Eigen::Index>(c);
        const Vec3 gradient = metric.transposed({solution(0, column), solution(1, column), solution(2, column)});
        if (is_finite(gradient)) gradients[i * components + c] = gradient;
      }
    }
  });
  return gradients;
}

}  // namespace sansmesh::inline v1::detail
