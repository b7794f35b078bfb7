// Arithmetic with bit-identical results on every instruction set. Highway's multiply-add rounds once or twice depending
// on the processor, and its reciprocals are approximations that differ between vendors, so kernels use these functions
// instead. (Kernels must also keep sums independent of the number of lanes.) Included once per instruction set.
#if defined(SANSMESH_CORE_PORTABLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SANSMESH_CORE_PORTABLE_INL_H_
#undef SANSMESH_CORE_PORTABLE_INL_H_
#else
#define SANSMESH_CORE_PORTABLE_INL_H_
#endif

#include <hwy/highway.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::portable {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace pn = portable::HWY_NAMESPACE;  // Otherwise the compiler finds Highway's functions of the same names.

#if !HWY_NATIVE_FMA

/// a b + c lane by lane; the standard library rounds once.
template <class V>
HWY_NOINLINE V MulAddLanes(const V& a, const V& b, const V& c) {
  const hn::DFromV<V> d;
  HWY_ALIGN float x[hn::MaxLanes(hn::DFromV<V>())], y[hn::MaxLanes(hn::DFromV<V>())], z[hn::MaxLanes(hn::DFromV<V>())];
  hn::Store(a, d, x), hn::Store(b, d, y), hn::Store(c, d, z);
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) z[i] = std::fma(x[i], y[i], z[i]);
  return hn::Load(d, z);
}

#if HWY_ARCH_X86 && HWY_TARGET < HWY_EMU128

/// a b + c in double precision, where the product is exact. Rounding the sum first to double and then to float differs
/// from a single rounding only where the double is halfway between two floats, or for denormal floats: then `doubtful`
/// is set.
template <class V, class D = hn::DFromV<V>>
HWY_INLINE hn::Vec<D> MulAddHalf(const V& a, const V& b, const V& c, bool& doubtful) {
  const D d;
  const hn::RepartitionToWide<hn::Twice<D>> wide;
  const hn::Repartition<std::uint32_t, decltype(wide)> words;
  const auto sum = hn::Add(hn::Mul(hn::PromoteTo(wide, a), hn::PromoteTo(wide, b)), hn::PromoteTo(wide, c));
  // A double has 29 bits below the 24 of a float, all in the lower word.
  const auto rest = hn::And(hn::BitCast(words, sum), hn::Set(words, 0x1fffffffu));
  const auto size = hn::Abs(sum), zero = hn::Zero(wide);
  const auto tiny = hn::And(hn::Gt(size, zero), hn::Lt(size, hn::Set(wide, 0x1p-125)));
  doubtful = !hn::AllFalse(words, hn::Eq(rest, hn::Set(words, 0x10000000u))) || !hn::AllFalse(wide, tiny);
  return hn::DemoteTo(d, sum);
}

/// a b + c, rounded once. Not inlined: kernels would take about three times as long to compile.
template <class V>
HWY_NOINLINE V MulAdd(const V& a, const V& b, const V& c) {
  const hn::DFromV<V> d;
  const hn::Half<decltype(d)> half;
  bool low = false, high = false;
  const auto lower = pn::MulAddHalf(hn::LowerHalf(half, a), hn::LowerHalf(half, b), hn::LowerHalf(half, c), low);
  const auto upper = pn::MulAddHalf(hn::UpperHalf(half, a), hn::UpperHalf(half, b), hn::UpperHalf(half, c), high);
  if (HWY_UNLIKELY(low || high)) return pn::MulAddLanes(a, b, c);
  return hn::Combine(d, upper, lower);
}

#else

template <class V>
HWY_INLINE V MulAdd(const V& a, const V& b, const V& c) {
  return pn::MulAddLanes(a, b, c);
}

#endif

/// c − a b, rounded once.
template <class V>
HWY_INLINE V NegMulAdd(const V& a, const V& b, const V& c) {
  return pn::MulAdd(hn::Neg(a), b, c);
}
/// a b − c, rounded once.
template <class V>
HWY_INLINE V MulSub(const V& a, const V& b, const V& c) {
  return pn::MulAdd(a, b, hn::Neg(c));
}

#else

/// a b + c, rounded once.
template <class V>
HWY_INLINE V MulAdd(const V& a, const V& b, const V& c) {
  return hn::MulAdd(a, b, c);
}
/// c − a b, rounded once.
template <class V>
HWY_INLINE V NegMulAdd(const V& a, const V& b, const V& c) {
  return hn::NegMulAdd(a, b, c);
}
/// a b − c, rounded once.
template <class V>
HWY_INLINE V MulSub(const V& a, const V& b, const V& c) {
  return hn::MulSub(a, b, c);
}

#endif

/// 1/√x for normal numbers x > 0; relative error 9e-8.
template <class V>
HWY_INLINE V ReciprocalSqrt(const V& x) {
  const hn::DFromV<V> d;
  const hn::RebindToSigned<decltype(d)> di;
  // Halving and negating the exponent by a bit shift gives an error of some percent. A Newton step with balanced
  // constants reduces it to 6.5e-4, and a Halley step (5/2 e³) to float precision.
  const V seed = hn::BitCast(d, hn::Sub(hn::Set(di, 0x5f600000), hn::ShiftRight<1>(hn::BitCast(di, x))));
  const V first =
      hn::Mul(hn::Mul(hn::Set(d, 0.248881566f), seed), pn::NegMulAdd(hn::Mul(x, seed), seed, hn::Set(d, 4.77852876f)));
  const V left = pn::NegMulAdd(hn::Mul(x, first), first, hn::Set(d, 1.0f));  // 1 − x y²
  return pn::MulAdd(hn::Mul(first, left), pn::MulAdd(left, hn::Set(d, 0.375f), hn::Set(d, 0.5f)), first);
}

/// eˣ for x <= 88; relative error 8e-8; 0 below −87.
template <class V>
HWY_INLINE V Exp(const V& x) {
  const hn::DFromV<V> d;
  const hn::RebindToSigned<decltype(d)> di;
  const V least = hn::Set(d, -87.0f), low = hn::Max(x, least);
  // x = n ln 2 + r with |r| <= ln 2 / 2: adding 3 · 2²² rounds to integers and leaves n in the lowest bits.
  const V shift = hn::Set(d, 12582912.0f);
  const V shifted = pn::MulAdd(low, hn::Set(d, 1.44269504f), shift);
  const V n = hn::Sub(shifted, shift);
  const V r = pn::MulAdd(n, hn::Set(d, 1.90465421e-9f), pn::NegMulAdd(n, hn::Set(d, 0.693147182f), low));
  // Taylor polynomial; its remainder r⁸/8! is below 6e-9.
  V sum = hn::Set(d, 1.0f / 5040);
  for (const float term : {1.0f / 720, 1.0f / 120, 1.0f / 24, 1.0f / 6, 1.0f / 2, 1.0f, 1.0f})
    sum = pn::MulAdd(sum, r, hn::Set(d, term));
  const auto scaled = hn::Add(hn::BitCast(di, sum), hn::ShiftLeft<23>(hn::BitCast(di, shifted)));
  return hn::IfThenElseZero(hn::Ge(x, least), hn::BitCast(d, scaled));
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::portable
HWY_AFTER_NAMESPACE();

#endif
