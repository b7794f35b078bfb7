// Kernels of eight lanes on every instruction set, without fused multiply-add: equal sums everywhere.
#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/partition/fit/gathered_samples.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <cmath>
#include <limits>

#include "sansmesh/partition/fit/gathered_samples.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using F8 = hn::CappedTag<float, GatheredSamples::kLanes>;
using U8 = hn::Rebind<std::uint32_t, F8>;
using V8 = hn::Vec<F8>;

HWY_INLINE V8 Dot(V8 x, V8 y, V8 z, const Vec3f& a) {
  const F8 d;
  return hn::Add(hn::Add(hn::Mul(x, hn::Set(d, a.x)), hn::Mul(y, hn::Set(d, a.y))), hn::Mul(z, hn::Set(d, a.z)));
}

HWY_INLINE V8 Square(V8 x, V8 y, V8 z) { return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)); }

/// A sum in eight parts on every instruction set, of which sample i belongs to part i mod 8.
struct PartialSum {
  V8 part[GatheredSamples::kLanes];
  PartialSum() {
    for (V8& p : part) p = hn::Zero(F8());
  }
  void add(std::size_t i, V8 v) {
    V8& p = part[i % GatheredSamples::kLanes / hn::Lanes(F8())];
    p = hn::Add(p, v);
  }
  float total() const {
    HWY_ALIGN float lane[GatheredSamples::kLanes];
    for (std::size_t i = 0; i < GatheredSamples::kLanes; i += hn::Lanes(F8()))
      hn::Store(part[i / hn::Lanes(F8())], F8(), lane + i);
    return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
  }
};

/// Appends the samples of one range, of whose array `readable` samples may be read.
HWY_INLINE void GatherRange(const float* positions, const float* normals, SampleRange range, std::size_t readable,
                            const Vec3f& center, float limit, GatheredSamples& ball) {
  const F8 d;
  const U8 du;
  const V8 cx = hn::Set(d, center.x), cy = hn::Set(d, center.y), cz = hn::Set(d, center.z), most = hn::Set(d, limit);
  std::size_t n = ball.size();
  std::uint32_t i = range.first;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  for (; i < range.last && i + lanes <= readable; i += lanes) {
    V8 x, y, z;
    hn::LoadInterleaved3(d, positions + 3 * static_cast<std::size_t>(i), x, y, z);
    x = hn::Sub(x, cx), y = hn::Sub(y, cy), z = hn::Sub(z, cz);
    auto in = hn::Lt(Square(x, y, z), most);
    if (range.last - i < lanes) in = hn::And(in, hn::FirstN(d, range.last - i));
    if (hn::AllFalse(d, in)) continue;
    V8 nx, ny, nz;
    hn::LoadInterleaved3(d, normals + 3 * static_cast<std::size_t>(i), nx, ny, nz);
    hn::StoreU(hn::Compress(x, in), d, ball.row(0) + n);
    hn::StoreU(hn::Compress(y, in), d, ball.row(1) + n);
    hn::StoreU(hn::Compress(z, in), d, ball.row(2) + n);
    hn::StoreU(hn::Compress(nx, in), d, ball.row(3) + n);
    hn::StoreU(hn::Compress(ny, in), d, ball.row(4) + n);
    hn::StoreU(hn::Compress(nz, in), d, ball.row(5) + n);
    hn::StoreU(hn::Compress(hn::Iota(du, i), hn::RebindMask(du, in)), du, ball.id_row() + n);
    n += hn::CountTrue(d, in);
  }
  for (; i < range.last; ++i) {
    const float* p = positions + 3 * static_cast<std::size_t>(i);
    const float x = p[0] - center.x, y = p[1] - center.y, z = p[2] - center.z;
    if (!(x * x + y * y + z * z < limit)) continue;
    const float* m = normals + 3 * static_cast<std::size_t>(i);
    const float row[6] = {x, y, z, m[0], m[1], m[2]};
    for (std::size_t r = 0; r < 6; ++r) ball.row(r)[n] = row[r];
    ball.id_row()[n++] = i;
  }
  ball.resize(n);
}

void GatherRanges(const float* positions, const float* normals, const SampleRange* ranges, std::size_t count,
                  std::size_t stride, std::size_t readable, float radius, GatheredSamples& ball) {
  const float limit = radius * radius;
  const Vec3f center = ball.center();
  for (std::size_t k = 0; k < count; ++k) {
    if (stride == 1) GatherRange(positions, normals, ranges[k], readable, center, limit, ball);
    for (std::uint32_t i = ranges[k].first; stride > 1 && i < ranges[k].last; i += static_cast<std::uint32_t>(stride))
      GatherRange(positions, normals, {i, i + 1}, 0, center, limit, ball);
  }
}

void SumBall(const GatheredSamples& ball, float inverse, BallSums& sums) {
  const F8 d;
  const V8 one = hn::Set(d, 1.0f), scale = hn::Set(d, inverse);
  PartialSum sum[7];
  for (std::size_t i = 0; i < ball.size(); i += hn::Lanes(d)) {
    const V8 offset[3] = {hn::LoadU(d, ball.position(0) + i), hn::LoadU(d, ball.position(1) + i),
                          hn::LoadU(d, ball.position(2) + i)};
    const V8 t = hn::Mul(Square(offset[0], offset[1], offset[2]), scale), rest = hn::Sub(one, t);
    const auto inside = hn::Lt(t, one);
    const V8 w = hn::IfThenElseZero(inside, hn::Mul(rest, rest));
    for (std::size_t a = 0; a < 3; ++a) {
      sum[a].add(i, hn::Mul(hn::LoadU(d, ball.normal(a) + i), w));
      sum[3 + a].add(i, hn::IfThenElseZero(inside, hn::Mul(offset[a], w)));
    }
    sum[6].add(i, w);
  }
  sums.normal = {sum[0].total(), sum[1].total(), sum[2].total()};
  sums.offset = {sum[3].total(), sum[4].total(), sum[5].total()};
  sums.weight = sum[6].total();
}

void ProjectBall(const GatheredSamples& ball, const BallFrame& frame, LocalSamples* samples, BallView& view) {
  const F8 d;
  const V8 one = hn::Set(d, 1.0f), zero = hn::Zero(d), inverse = hn::Set(d, 1 / frame.scale);
  const V8 square = hn::Set(d, 1 / (frame.scale * frame.scale)), stretch = hn::Set(d, frame.stretch);
  const V8 mx = hn::Set(d, frame.middle.x), my = hn::Set(d, frame.middle.y), mz = hn::Set(d, frame.middle.z);
  PartialSum kept, away, centre[2];
  V8 least = one, lower[2] = {one, one}, upper[2] = {hn::Neg(one), hn::Neg(one)};
  std::size_t n = 0;
  for (std::size_t i = 0; i < ball.size(); i += hn::Lanes(d)) {
    const V8 x = hn::LoadU(d, ball.position(0) + i), y = hn::LoadU(d, ball.position(1) + i),
             z = hn::LoadU(d, ball.position(2) + i);
    const V8 ox = hn::Sub(x, mx), oy = hn::Sub(y, my), oz = hn::Sub(z, mz);
    V8 t = hn::Mul(Square(ox, oy, oz), square);
    if (frame.stretch != 0) {
      const V8 above = hn::Mul(Dot(ox, oy, oz, frame.nu), inverse);
      t = hn::Add(t, hn::Mul(stretch, hn::Mul(above, above)));
    }
    const auto inside = hn::Lt(t, one);
    if (hn::AllFalse(d, inside)) continue;
    const V8 rest = hn::Sub(one, t), w = hn::IfThenElseZero(inside, hn::Mul(rest, rest));
    const V8 facing = Dot(hn::LoadU(d, ball.normal(0) + i), hn::LoadU(d, ball.normal(1) + i),
                          hn::LoadU(d, ball.normal(2) + i), frame.nu);
    const auto turned = hn::Lt(facing, zero);
    least = hn::Min(least, hn::IfThenElse(inside, facing, one));
    away.add(i, hn::IfThenElseZero(turned, w));
    kept.add(i, hn::IfThenElse(turned, zero, w));
    if (samples == nullptr) continue;
    const auto keep = hn::AndNot(turned, inside);
    const V8 across[2] = {hn::Mul(Dot(x, y, z, frame.xi), inverse), hn::Mul(Dot(x, y, z, frame.eta), inverse)};
    for (std::size_t a = 0; a < 2; ++a) {
      lower[a] = hn::Min(lower[a], hn::IfThenElse(keep, across[a], lower[a]));
      upper[a] = hn::Max(upper[a], hn::IfThenElse(keep, across[a], upper[a]));
      centre[a].add(i, hn::IfThenElseZero(keep, hn::Mul(w, across[a])));
    }
    hn::StoreU(hn::Compress(across[0], keep), d, samples->u() + n);
    hn::StoreU(hn::Compress(across[1], keep), d, samples->v() + n);
    hn::StoreU(hn::Compress(hn::Mul(Dot(x, y, z, frame.nu), inverse), keep), d, samples->w() + n);
    hn::StoreU(hn::Compress(w, keep), d, samples->weight() + n);
    n += hn::CountTrue(d, keep);
  }
  if (samples != nullptr) samples->resize(n);
  view.kept = kept.total(), view.away = away.total();
  view.least_cosine = hn::GetLane(hn::MinOfLanes(d, least));
  for (std::size_t a = 0; a < 2; ++a) {
    view.lower[a] = hn::GetLane(hn::MinOfLanes(d, lower[a]));
    view.upper[a] = hn::GetLane(hn::MaxOfLanes(d, upper[a]));
  }
  if (view.kept > 0) view.eccentricity = std::hypot(centre[0].total(), centre[1].total()) / view.kept;
}

/// Σ w r² over Σ w; axes[a]: axis a of the function, in the samples' frame and its unit.
template <int kDegree>
double MeanSquare(const LocalSamples& samples, const Vec3f (&axes)[3], const float* c) {
  const F8 d;
  PartialSum squares, weights;
  for (std::size_t i = 0; i < samples.size(); i += hn::Lanes(d)) {
    const V8 x = hn::LoadU(d, samples.u() + i), y = hn::LoadU(d, samples.v() + i), z = hn::LoadU(d, samples.w() + i);
    const V8 u = Dot(x, y, z, axes[0]), v = Dot(x, y, z, axes[1]);
    V8 g = hn::Set(d, c[0]);
    V8 power[kDegree + 1];  // monomials of degree k: uᵏ, uᵏ⁻¹ v, …, vᵏ
    power[0] = hn::Set(d, 1.0f);
    for (std::size_t k = 1, at = 1; k <= kDegree; ++k) {
      power[k] = hn::Mul(power[k - 1], v);
      for (std::size_t j = 0; j < k; ++j) power[j] = hn::Mul(power[j], u);
      for (std::size_t j = 0; j <= k; ++j) g = hn::Add(g, hn::Mul(hn::Set(d, c[at++]), power[j]));
    }
    const V8 r = hn::Sub(Dot(x, y, z, axes[2]), g), w = hn::LoadU(d, samples.weight() + i);
    squares.add(i, hn::Mul(w, hn::Mul(r, r)));
    weights.add(i, w);
  }
  return static_cast<double>(squares.total()) / static_cast<double>(weights.total());
}

double MeanSquareOfDegree(int degree, const LocalSamples& samples, const Vec3f (&axes)[3], const float* c) {
  switch (degree) {
    case 1:
      return MeanSquare<1>(samples, axes, c);
    case 2:
      return MeanSquare<2>(samples, axes, c);
    case 3:
      return MeanSquare<3>(samples, axes, c);
    case 4:
      return MeanSquare<4>(samples, axes, c);
    default:
      return MeanSquare<0>(samples, axes, c);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1 {
HWY_EXPORT(GatherRanges);
HWY_EXPORT(SumBall);
HWY_EXPORT(ProjectBall);
HWY_EXPORT(MeanSquareOfDegree);

void GatheredSamples::reserve(std::size_t n) {
  if (n + kLanes <= ids_.size()) return;
  const std::size_t room = 2 * n + 64;
  for (auto& row : rows_) row.resize(room);
  ids_.resize(room);
}

void GatheredSamples::gather(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                             std::span<const SampleRange> ranges, const Vec3f& center, float radius,
                             std::size_t stride) {
  center_ = center;
  size_ = 0;
  std::size_t most = 0;
  for (const SampleRange& range : ranges) most += (range.last - range.first + stride - 1) / stride;
  reserve(most);
  if (ranges.empty()) return;
  HWY_DYNAMIC_DISPATCH(GatherRanges)
  (&positions[0].x, &normals[0].x, ranges.data(), ranges.size(), stride, positions.size(), radius, *this);
  for (std::size_t i = size_; i < padded(); ++i)
    for (std::size_t r = 0; r < 6; ++r) rows_[r][i] = r < 3 ? std::numeric_limits<float>::infinity() : 0;
}

std::size_t GatheredSamples::count(float radius) const {
  const float limit = radius * radius;
  std::size_t n = 0;
  for (std::size_t i = 0; i < size_; ++i)
    n += rows_[0][i] * rows_[0][i] + rows_[1][i] * rows_[1][i] + rows_[2][i] * rows_[2][i] < limit;
  return n;
}

BallSums sum_ball(const GatheredSamples& ball, float radius) {
  BallSums sums;
  HWY_DYNAMIC_DISPATCH(SumBall)(ball, 1 / (radius * radius), sums);
  return sums;
}

BallView project_ball(const GatheredSamples& ball, const BallFrame& frame, LocalSamples& samples) {
  BallView view;
  samples.reserve(ball.padded());
  HWY_DYNAMIC_DISPATCH(ProjectBall)(ball, frame, &samples, view);
  return view;
}

double mean_square_of(LocalSamples& samples, const LocalFunction& own, const LocalFunction& other) {
  samples.pad();
  const float ratio = own.scale / other.scale;
  const auto turned = [&](const Vec3f& axis) {
    return Vec3f{dot(axis, own.xi), dot(axis, own.eta), dot(axis, own.nu)} * ratio;
  };
  const Vec3f axes[3] = {turned(other.xi), turned(other.eta), turned(other.nu)};
  const double square = HWY_DYNAMIC_DISPATCH(MeanSquareOfDegree)(other.degree, samples, axes, other.coefficient.data());
  return square * other.scale * other.scale;
}

BallView weigh_ball(const GatheredSamples& ball, float radius, const Vec3f& nu) {
  BallView view;
  const BallFrame frame{{}, radius, 0, {}, {}, nu};
  HWY_DYNAMIC_DISPATCH(ProjectBall)(ball, frame, nullptr, view);
  return view;
}

}  // namespace sansmesh::inline v1
#endif
