// Powers for weights, bit-identical on every instruction set. Included once per instruction set.
#if defined(SANSMESH_DEFORM_WEIGHT_POWER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SANSMESH_DEFORM_WEIGHT_POWER_INL_H_
#undef SANSMESH_DEFORM_WEIGHT_POWER_INL_H_
#else
#define SANSMESH_DEFORM_WEIGHT_POWER_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Natural logarithm of normal numbers x > 0, with an error of 2e-16 relative to the result and to the logarithm of the
/// power of two in x.
template <class V>
HWY_INLINE V LogOfNormal(const V& x) {
  const hn::DFromV<V> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  // x = 2^e m, m from √½ to √2. Subtracting these bits moves the step of the exponent to √½.
  const auto bits = hn::Sub(hn::BitCast(du, x), hn::Set(du, std::uint64_t{0x3fe6a09e667f3bcd}));
  // Shifted by 2048 to be non-negative.
  const auto moved = hn::ShiftRight<52>(hn::Add(bits, hn::Set(du, std::uint64_t{1} << 63)));
  const auto fraction = hn::And(bits, hn::Set(du, (std::uint64_t{1} << 52) - 1));
  const V m = hn::BitCast(d, hn::Add(fraction, hn::Set(du, std::uint64_t{0x3fe6a09e667f3bcd})));
  const V e =
      hn::Sub(hn::BitCast(d, hn::Or(moved, hn::Set(du, std::uint64_t{0x4330000000000000}))), hn::Set(d, 0x1p52 + 2048));
  // log m = 2 (s + s³/3 + s⁵/5 + …), |s| <= 0.172: the truncation error is below 1e-18.
  const V one = hn::Set(d, 1.0);
  const V s = hn::Div(hn::Sub(m, one), hn::Add(m, one)), square = hn::Mul(s, s);
  V sum = hn::Set(d, 1.0 / 23);
  for (const double odd : {21.0, 19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0})
    sum = hn::Add(hn::Mul(sum, square), hn::Set(d, 1 / odd));
  const V twice = hn::Add(s, s);
  const V small = hn::Add(hn::Mul(e, hn::Set(d, 1.90821492927058770002e-10)), hn::Mul(hn::Mul(twice, square), sum));
  return hn::Add(hn::Mul(e, hn::Set(d, 6.93147180369123816490e-01)), hn::Add(twice, small));
}

/// eˣ for |x| <= 700.
template <class V>
HWY_INLINE V ExpOfModerate(const V& x) {
  const hn::DFromV<V> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  // x = n ln 2 + r, |r| <= ln 2 / 2: adding 3 · 2⁵¹ rounds to an integer and leaves n in the lowest bits.
  const V shift = hn::Set(d, 6755399441055744.0);
  const V shifted = hn::Add(hn::Mul(x, hn::Set(d, 1.44269504088896338700)), shift), n = hn::Sub(shifted, shift);
  const V r = hn::Sub(hn::Sub(x, hn::Mul(n, hn::Set(d, 6.93147180369123816490e-01))),
                      hn::Mul(n, hn::Set(d, 1.90821492927058770002e-10)));
  // Taylor polynomial; the remainder r¹⁴/14! is below 5e-18.
  V sum = hn::Set(d, 1.0 / 6227020800);
  for (const double factorial :
       {479001600.0, 39916800.0, 3628800.0, 362880.0, 40320.0, 5040.0, 720.0, 120.0, 24.0, 6.0, 2.0, 1.0, 1.0})
    sum = hn::Add(hn::Mul(sum, r), hn::Set(d, 1 / factorial));
  return hn::BitCast(d, hn::Add(hn::BitCast(du, sum), hn::ShiftLeft<52>(hn::BitCast(du, shifted))));
}

/// base^alpha for alpha from 0.5 to 8, with a relative error of 1e-13 for results within 1e-300..1e300 (weights of
/// handles are 1e-60 and above). Uses only products if 2 alpha is an integer.
template <class V>
HWY_INLINE V WeightPower(const V& base, double alpha) {
  const hn::DFromV<V> d;
  const double doubled = 2 * alpha;
  const int times = static_cast<int>(doubled);
  if (doubled != times) {
    const V exponent = hn::Mul(hn::Set(d, alpha), LogOfNormal(base));
    return hn::IfThenElseZero(hn::Ge(base, hn::Set(d, 1e-300)),
                              ExpOfModerate(hn::Max(hn::Min(exponent, hn::Set(d, 700.0)), hn::Set(d, -700.0))));
  }
  V power = times % 2 ? hn::Sqrt(base) : hn::Set(d, 1.0);
  for (int k = 0; k < times / 2; ++k) power = hn::Mul(power, base);
  return power;
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#endif
