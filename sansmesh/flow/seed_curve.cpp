#include "sansmesh/flow/seed_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Arc length up to each point; for a closed curve also the total length.
std::vector<double> arc_lengths(const SeedCurve& curve) {
  const std::size_t n = curve.points.size();
  std::vector<double> lengths{0};
  for (std::size_t i = 1; i < n + (curve.closed ? 1 : 0); ++i)
    lengths.push_back(lengths.back() + norm(curve.points[i % n] - curve.points[i - 1]));
  return lengths;
}

}  // namespace

double SeedCurve::length() const { return points.empty() ? 0 : arc_lengths(*this).back(); }

Vec3 SeedCurve::at(double s) const { return at(std::span<const double>(&s, 1)).front(); }

std::vector<Vec3> SeedCurve::at(std::span<const double> s) const {
  validate();
  const std::vector<double> lengths = arc_lengths(*this);
  const double all = lengths.back();
  std::vector<Vec3> places;
  places.reserve(s.size());
  for (double here : s) {
    if (closed) here -= all * std::floor(here / all);
    here = std::clamp(here, 0.0, all);
    const auto after = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, here);
    const auto k = static_cast<std::size_t>(after - lengths.begin()) - 1;
    const double part = lengths[k + 1] - lengths[k];
    const double share = part > 0 ? (here - lengths[k]) / part : 0;
    const Vec3 &a = points[k], &b = points[(k + 1) % points.size()];
    places.push_back(share < 1 ? a + (b - a) * share : b);
  }
  return places;
}

void SeedCurve::validate() const {
  if (points.size() < (closed ? 3u : 2u))
    throw ArgumentError(closed ? "a closed seed curve has at least three points"
                               : "a seed curve has at least two points");
  if (!std::all_of(points.begin(), points.end(), [](const Vec3& x) { return is_finite(x); }))
    throw ArgumentError("the points of a seed curve must be finite");
  if (!(arc_lengths(*this).back() > 0)) throw ArgumentError("the points of the seed curve coincide");
}

}  // namespace sansmesh::inline v1
