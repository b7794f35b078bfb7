#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/approximation/orthogonal_kernels.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h (Highway).
#include <hwy/highway.h>

#include "sansmesh/approximation/orthogonal_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// No fused multiply-add: its rounding would differ from that of instruction sets without it.
using Tag = hn::CappedTag<double, kRowLanes>;
using V = hn::Vec<Tag>;
constexpr std::size_t kWidth = hn::MaxLanes(Tag());
constexpr std::size_t kParts = kRowLanes / kWidth;

HWY_INLINE double Total(const V* parts) {
  HWY_ALIGN double s[kRowLanes];
  for (std::size_t p = 0; p < kParts; ++p) hn::Store(parts[p], Tag(), s + p * kWidth);
  return ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
}

template <std::size_t Count>
HWY_INLINE void Dots(std::size_t n, const double* HWY_RESTRICT row, const double* const* others, double* dots) {
  const Tag d;
  const double* o[Count];
  V sum[Count][kParts];
  for (std::size_t c = 0; c < Count; ++c) {
    o[c] = others[c];
    for (std::size_t p = 0; p < kParts; ++p) sum[c][p] = hn::Zero(d);
  }
  for (std::size_t i = 0; i < n; i += kRowLanes)
    for (std::size_t p = 0; p < kParts; ++p) {
      const std::size_t at = i + p * kWidth;
      const V r = hn::LoadU(d, row + at);
      for (std::size_t c = 0; c < Count; ++c) sum[c][p] = hn::Add(sum[c][p], hn::Mul(r, hn::LoadU(d, o[c] + at)));
    }
  for (std::size_t c = 0; c < Count; ++c) dots[c] = Total(sum[c]);
}

void MultiplyAndDot(std::size_t n, const double* x, const double* row, const double* const* others, std::size_t count,
                    double* out, double* dots) {
  const Tag d;
  for (std::size_t i = 0; i < n; i += kWidth)
    hn::StoreU(hn::Mul(hn::LoadU(d, x + i), hn::LoadU(d, row + i)), d, out + i);
  for (; count >= 4; count -= 4, others += 4, dots += 4) Dots<4>(n, out, others, dots);
  if (count == 3) Dots<3>(n, out, others, dots);
  if (count == 2) Dots<2>(n, out, others, dots);
  if (count == 1) Dots<1>(n, out, others, dots);
}

NormAndDot SubtractRows(std::size_t n, const double* const* others, const double* factors, std::size_t count,
                        const double* residual, double* HWY_RESTRICT row) {
  const Tag d;
  V norm[kParts], dot[kParts];
  for (std::size_t p = 0; p < kParts; ++p) norm[p] = dot[p] = hn::Zero(d);
  for (std::size_t i = 0; i < n; i += kRowLanes) {
    V r[kParts];
    for (std::size_t p = 0; p < kParts; ++p) r[p] = hn::LoadU(d, row + i + p * kWidth);
    for (std::size_t c = 0; c < count; ++c) {
      const V f = hn::Set(d, factors[c]);
      for (std::size_t p = 0; p < kParts; ++p)
        r[p] = hn::Sub(r[p], hn::Mul(f, hn::LoadU(d, others[c] + i + p * kWidth)));
    }
    for (std::size_t p = 0; p < kParts; ++p) {
      hn::StoreU(r[p], d, row + i + p * kWidth);
      norm[p] = hn::Add(norm[p], hn::Mul(r[p], r[p]));
      dot[p] = hn::Add(dot[p], hn::Mul(r[p], hn::LoadU(d, residual + i + p * kWidth)));
    }
  }
  return {Total(norm), Total(dot)};
}

double SubtractFromResidual(std::size_t n, const double* HWY_RESTRICT row, double coefficient,
                            double* HWY_RESTRICT residual) {
  const Tag d;
  const V f = hn::Set(d, coefficient);
  V sum[kParts];
  for (std::size_t p = 0; p < kParts; ++p) sum[p] = hn::Zero(d);
  for (std::size_t i = 0; i < n; i += kRowLanes)
    for (std::size_t p = 0; p < kParts; ++p) {
      const std::size_t at = i + p * kWidth;
      const V r = hn::Sub(hn::LoadU(d, residual + at), hn::Mul(f, hn::LoadU(d, row + at)));
      hn::StoreU(r, d, residual + at);
      sum[p] = hn::Add(sum[p], hn::Mul(r, r));
    }
  return Total(sum);
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1::detail {
HWY_EXPORT(MultiplyAndDot);
HWY_EXPORT(SubtractRows);
HWY_EXPORT(SubtractFromResidual);

void multiply_and_dot(std::size_t n, const double* x, const double* row, const double* const* others, std::size_t count,
                      double* out, double* dots) {
  HWY_DYNAMIC_DISPATCH(MultiplyAndDot)(n, x, row, others, count, out, dots);
}

NormAndDot subtract_rows(std::size_t n, const double* const* others, const double* factors, std::size_t count,
                         const double* residual, double* row) {
  return HWY_DYNAMIC_DISPATCH(SubtractRows)(n, others, factors, count, residual, row);
}

double subtract_from_residual(std::size_t n, const double* row, double coefficient, double* residual) {
  return HWY_DYNAMIC_DISPATCH(SubtractFromResidual)(n, row, coefficient, residual);
}

}  // namespace sansmesh::inline v1::detail
#endif
