#include "sansmesh/surface/mpu/piecewise_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sansmesh::inline v1 {
namespace {

constexpr double kEdgeCosine = 0.9, kCornerCosine = 0.7;
/// Sine of the angle of two normals below which their cross product is undefined: both sides of a wall.
constexpr double kParallel = 0.1;
/// Least number of samples of a face for a polynomial of degree 2, twice the number of its coefficients.
constexpr std::size_t kBentFace = 12;
/// A face with fewer samples is the plane through their mean with their mean normal.
constexpr std::size_t kTiltedFace = 6;

struct MostDifferent {
  std::size_t first = 0, second = 0;
  double cosine = 1;
};

MostDifferent most_different(std::span<const Vec3> normals) {
  MostDifferent found;
  for (std::size_t i = 0; i < normals.size(); ++i)
    for (std::size_t j = i + 1; j < normals.size(); ++j)
      if (const double cosine = dot(normals[i], normals[j]); cosine < found.cosine) found = {i, j, cosine};
  return found;
}

/// Normals that are not combinations of these two, by a margin; the most deviating one comes first.
std::vector<Vec3> other_faces(std::span<const Vec3> normals, const Vec3& first, const Vec3& second) {
  const Vec3 both = cross(first, second), axis = normalized(both);
  const bool wall = norm(both) <= kParallel;  // then any direction across it, that of its rim
  std::vector<Vec3> others;
  double most = 0;
  for (const Vec3& n : normals) {
    const double off = wall ? norm(cross(n, first)) : std::abs(dot(n, axis));
    if (off <= kCornerCosine) continue;
    others.push_back(n);
    if (off > most) most = off, std::swap(others.front(), others.back());
  }
  return others;
}

void assign_nearest(std::span<const Vec3> normals, std::span<const Vec3> to, std::vector<std::uint8_t>& face) {
  for (std::size_t i = 0; i < normals.size(); ++i) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < to.size(); ++k)
      if (dot(normals[i], to[k]) > dot(normals[i], to[best])) best = k;
    face[i] = static_cast<std::uint8_t>(best);
  }
}

/// Values of the faces at a sample.
using FaceValues = std::array<double, kMostPieces>;

/// Sum of squares of the combined values at the samples.
double misfit(std::span<const FaceValues> values, const std::array<std::uint8_t, kMostPieces>& order,
              PieceCombination how) {
  double sum = 0;
  for (const FaceValues& v : values) {
    const double all =
        how.combine(FaceValues{v[order[0]], v[order[1]], v[order[2]], v[order[3]]},
                    [](bool larger, double a, double b) { return larger ? std::max(a, b) : std::min(a, b); });
    sum += all * all;
  }
  return sum;
}

/// Visits every function of `pieces` values by successive maxima and minima, each with an order of the pieces.
template <class Visit>
void every_combination(std::uint8_t pieces, Visit&& visit) {
  std::array<std::uint8_t, kMostPieces> order{0, 1, 2, 3};
  const unsigned all = 1u << (pieces - 1);
  do {
    for (unsigned maxima = 0; maxima < all; ++maxima) {
      visit(order, PieceCombination{pieces, static_cast<std::uint8_t>(maxima), 0});
      if (pieces == 4) visit(order, PieceCombination{pieces, static_cast<std::uint8_t>(maxima), 1});
    }
  } while (std::next_permutation(order.begin(), order.begin() + pieces));
}

}  // namespace

FaceSplit split_by_normals(std::span<const Vec3> normals) {
  FaceSplit split{1, std::vector<std::uint8_t>(normals.size(), 0)};
  const MostDifferent edge = most_different(normals);
  if (edge.cosine >= kEdgeCosine) return split;
  std::vector<Vec3> of{normals[edge.first], normals[edge.second]};
  if (const std::vector<Vec3> others = other_faces(normals, of[0], of[1]); !others.empty()) {
    const MostDifferent again = most_different(others);
    if (again.cosine < kEdgeCosine) {
      of.push_back(others[again.first]), of.push_back(others[again.second]);
    } else {
      of.push_back(others.front());
    }
  }
  assign_nearest(normals, of, split.face);
  split.faces = of.size();
  return split;
}

std::optional<LocalShape> piecewise_shape(const BallSamples& samples, int degree) {
  const FaceSplit split = split_by_normals(samples.normals);
  if (split.faces < 2) return std::nullopt;
  LocalShape shape;
  shape.combination.pieces = static_cast<std::uint8_t>(split.faces);
  std::array<QuadricPiece, kMostPieces> faces;
  std::vector<Vec3> positions, normals;
  std::vector<double> weights;
  for (std::size_t f = 0; f < split.faces; ++f) {
    positions.clear(), normals.clear(), weights.clear();
    Vec3 up;
    for (std::size_t i = 0; i < split.face.size(); ++i) {
      if (split.face[i] != f) continue;
      positions.push_back(samples.positions[i]), normals.push_back(samples.normals[i]);
      weights.push_back(samples.weights[i]);
      up += normals.back() * weights.back();
    }
    if (positions.empty() || !(norm(up) > 0)) return std::nullopt;
    const std::size_t count = positions.size();
    const int possible = count < kTiltedFace ? 0 : count < kBentFace ? 1 : 2;
    faces[f] = height_quadric({positions, normals, weights}, normalized(up), std::min(possible, degree));
  }
  std::vector<FaceValues> values(samples.positions.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t f = 0; f < split.faces; ++f) values[i][f] = faces[f].value(samples.positions[i]);
  double least = std::numeric_limits<double>::infinity();
  every_combination(shape.combination.pieces, [&](const auto& order, PieceCombination how) {
    const double sum = misfit(values, order, how);
    if (!(sum < least)) return;
    least = sum, shape.combination = how;
    for (std::size_t k = 0; k < how.pieces; ++k) shape.pieces[k] = faces[order[k]];
  });
  return shape;
}

}  // namespace sansmesh::inline v1
