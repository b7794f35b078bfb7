#include "sansmesh/partition/far/global_sign.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "sansmesh/box.h"
#include "sansmesh/partition/far/far_sums.h"

namespace sansmesh::inline v1 {

float plane_area_in_cube(const Vec3f& point, const Vec3f& normal, const Vec3f& lower, float edge) {
  // A square of the plane that is larger than the cube, clipped by the cube's six sides.
  Vec3f t, b;
  tangent_frame(normal, t, b);
  const Vec3f middle = lower + Vec3f{edge, edge, edge} * 0.5f;
  const Vec3f foot = middle - normal * dot(middle - point, normal);
  const float size = 1.8f * edge;
  std::array<Vec3f, 12> polygon{foot - t * size - b * size, foot + t * size - b * size, foot + t * size + b * size,
                                foot - t * size + b * size};
  std::size_t n = 4;
  std::array<Vec3f, 12> cut;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      const float plane = side < 0 ? lower[axis] : lower[axis] + edge;
      std::size_t m = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3f &p = polygon[i], &q = polygon[(i + 1) % n];
        const float dp = side * (plane - p[axis]), dq = side * (plane - q[axis]);
        if (dp >= 0) cut[m++] = p;
        if ((dp >= 0) != (dq >= 0)) cut[m++] = p + (q - p) * (dp / (dp - dq));
      }
      n = m;
      polygon = cut;
      if (n == 0) return 0;
    }
  Vec3f sum;
  for (std::size_t i = 1; i + 1 < n; ++i) sum += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  return 0.5f * norm(sum);
}

GlobalSign::GlobalSign(std::span<const OrientedPatch> patches, float unit, bool open)
    : unit_(unit), open_(open), tree_(far_tree(patches, unit)) {}

namespace {

/// At this distance, in units, all patches are one point, and the sums of 1/r⁶ are still far from the smallest floats.
constexpr double kFar = 1000;

/// The point in the same direction at distance at most kFar. `ratio`: factor to the distance of x.
Vec3f pulled_in(const Vec3f& x, float& ratio) {
  ratio = 1;
  const auto limited = [](float v) { return std::clamp(static_cast<double>(v), -1e25, 1e25); };
  const Vec3 p{limited(x.x), limited(x.y), limited(x.z)};
  const double distance = norm(p);
  if (!(distance > kFar)) return x;
  ratio = static_cast<float>(distance / kFar);
  return Vec3f(p * (kFar / distance));
}

}  // namespace

namespace {

/// Some of the points, moved to within kFar.
void fill_batch(std::span<const Vec3f> x, float unit, float* ratio, FarBatch& batch) {
  for (std::size_t i = 0; i < FarBatch::kBatch; ++i) {
    const std::size_t k = std::min(i, x.size() - 1);
    const Vec3f p = pulled_in(x[k] / unit, ratio[k]);
    for (std::size_t a = 0; a < 3; ++a) batch.x[a][i] = p[a];
  }
}

/// Calls sum(n, batch) for batches of n points, then take(i, batch, k, ratio) for point i, k-th in its batch.
template <class Sum, class Take>
void for_each_batch(std::span<const Vec3f> x, float unit, const Sum& sum, const Take& take) {
  FarBatch batch;
  float ratio[FarBatch::kBatch];
  for (std::size_t first = 0; first < x.size(); first += FarBatch::kBatch) {
    const std::size_t n = std::min(FarBatch::kBatch, x.size() - first);
    fill_batch(x.subspan(first, n), unit, ratio, batch);
    sum(n, batch);
    for (std::size_t i = 0; i < n; ++i) take(first + i, batch, i, ratio[i]);
  }
}

constexpr float kWhole = 4 * std::numbers::pi_v<float>;
/// Rough winding numbers decide if they differ by this from 1/2.
constexpr float kClearWinding = 0.25f;

}  // namespace

void GlobalSign::winding_number(std::span<const Vec3f> x, std::span<float> values) const {
  std::fill(values.begin(), values.end(), 0.0f);
  if (empty()) return;
  for_each_batch(
      x, unit_, [&](std::size_t n, FarBatch& b) { sum_sources(tree_, FarSums::winding, false, n, b); },
      [&](std::size_t i, const FarBatch& b, std::size_t k, float) { values[i] = b.sum[0][k] / kWhole; });
}

void GlobalSign::easy_signs(std::span<const Vec3f> x, std::span<float> signs) const {
  std::fill(signs.begin(), signs.end(), 0.0f);
  if (empty() || open_) return;
  for_each_batch(
      x, unit_, [&](std::size_t n, FarBatch& b) { sum_roughly(tree_, false, n, b); },
      [&](std::size_t i, const FarBatch& b, std::size_t k, float) {
        const float over = b.sum[0][k] / kWhole - 0.5f;
        if (std::abs(over) > kClearWinding) signs[i] = over > 0 ? -1.0f : 1.0f;
      });
}

namespace {

/// Over a plane at distance d, ∫ dA / r⁴ is π / d² and ∫ dA / r⁶ is π / (2 d⁴). The square root of their ratio is a
/// mean distance that grows no faster than r. `f.value` is a length; `in_units` is the value at the point of the sums,
/// `ratio` times nearer.
void closed_value(const FarBatch& batch, std::size_t i, bool gradient, float ratio, float unit, FarValue& f,
                  float& in_units) {
  const float dipole = batch.sum[0][i], fourth = batch.sum[1][i], sixth = batch.sum[2][i];
  const float distance = sixth > 0 ? std::sqrt(0.5f * fourth / sixth) : 0;
  const float inside = 1 - dipole / (2 * std::numbers::pi_v<float>), sign = std::clamp(inside, -1.0f, 1.0f);
  in_units = sign * distance;
  f.value = sign * std::min(distance * ratio * unit, 1e37f);
  if (!gradient || !(distance > 0)) return;
  for (std::size_t a = 0; a < 3; ++a) {
    f.gradient[a] = (batch.slope[1][a][i] / fourth - batch.slope[2][a][i] / sixth) * (0.5f * distance * sign);
    if (sign == inside) f.gradient[a] -= batch.slope[0][a][i] * (distance / (2 * std::numbers::pi_v<float>));
  }
}

void open_value(const FarBatch& batch, std::size_t i, bool gradient, float ratio, float unit, FarValue& f,
                float& in_units) {
  const float dipole = batch.sum[0][i], sixth = batch.sum[2][i];
  in_units = sixth > 0 ? -dipole / sixth : 0;
  f.value = std::clamp(in_units * ratio * unit, -1e37f, 1e37f);
  if (!gradient || !(sixth > 0)) return;
  for (std::size_t a = 0; a < 3; ++a) f.gradient[a] = -(batch.slope[0][a][i] + in_units * batch.slope[2][a][i]) / sixth;
}

}  // namespace

void GlobalSign::rough_distance(std::span<const Vec3f> x, std::span<float> values, std::span<float> most) const {
  std::fill(values.begin(), values.end(), 0.0f);
  std::fill(most.begin(), most.end(), std::numeric_limits<float>::infinity());
  if (empty() || !open_) return;
  for_each_batch(
      x, unit_, [&](std::size_t n, FarBatch& b) { sum_roughly(tree_, true, n, b); },
      [&](std::size_t i, const FarBatch& b, std::size_t k, float ratio) {
        FarValue f;
        float in_units = 0;
        open_value(b, k, false, ratio, unit_, f, in_units);
        if (!(b.sum[2][k] > 0)) return;
        values[i] = f.value;
        most[i] = b.sum[1][k] / b.sum[2][k] * ratio * unit_;
      });
}

void GlobalSign::far_values(std::span<const Vec3f> x, bool gradient, std::span<FarValue> values) const {
  std::fill(values.begin(), values.end(), FarValue{});
  if (empty()) return;
  for_each_batch(
      x, unit_,
      [&](std::size_t n, FarBatch& b) { sum_sources(tree_, open_ ? FarSums::open : FarSums::closed, gradient, n, b); },
      [&](std::size_t i, const FarBatch& b, std::size_t k, float ratio) {
        FarValue& f = values[i];
        float in_units = 0;
        (open_ ? open_value : closed_value)(b, k, gradient, ratio, unit_, f, in_units);
        f.weight = b.sum[2][k];
        if (!gradient) return;
        for (std::size_t a = 0; a < 3; ++a) f.weight_gradient[a] = b.slope[2][a][k] / unit_;
        if (ratio > 1) {  // beyond kFar values grow in proportion along the ray
          const Vec3f p{b.x[0][k], b.x[1][k], b.x[2][k]}, ray = normalized(p);
          f.gradient += ray * (in_units / norm(p) - dot(ray, f.gradient));
        }
      });
}

void GlobalSign::signed_distance(std::span<const Vec3f> x, std::span<float> values, std::span<Vec3f> gradients) const {
  std::vector<FarValue> far(x.size());
  far_values(x, !gradients.empty(), far);
  for (std::size_t i = 0; i < x.size(); ++i) {
    values[i] = far[i].value;
    if (!gradients.empty()) gradients[i] = far[i].gradient;
  }
}

void FarField::signed_distance(std::span<const Vec3f> x, std::span<float> values, std::span<Vec3f> gradients) const {
  if (open.empty()) return closed.signed_distance(x, values, gradients);
  if (closed.empty()) return open.signed_distance(x, values, gradients);
  const bool gradient = !gradients.empty();
  std::vector<FarValue> solid(x.size()), sheet(x.size());
  closed.far_values(x, gradient, solid);
  open.far_values(x, gradient, sheet);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const FarValue &a = solid[i], &b = sheet[i];
    const float sum = a.weight + b.weight, share = sum > 0 ? a.weight / sum : 1;
    values[i] = b.value + share * (a.value - b.value);
    if (!gradient) continue;
    gradients[i] = b.gradient + (a.gradient - b.gradient) * share;
    if (sum > 0)
      gradients[i] += (a.weight_gradient * (1 - share) - b.weight_gradient * share) * ((a.value - b.value) / sum);
  }
}

void FarField::easy_signs(std::span<const Vec3f> x, std::span<float> signs) const {
  if (open.empty()) {
    closed.easy_signs(x, signs);
  } else {
    std::fill(signs.begin(), signs.end(), 0.0f);
  }
}

}  // namespace sansmesh::inline v1
