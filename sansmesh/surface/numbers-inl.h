// Numbers with optional gradients (forward differentiation), one point per lane: a formula gives values, or values with
// exact gradients. Included once for each instruction set by the kernels.
#if defined(SANSMESH_SURFACE_NUMBERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SANSMESH_SURFACE_NUMBERS_INL_H_
#undef SANSMESH_SURFACE_NUMBERS_INL_H_
#else
#define SANSMESH_SURFACE_NUMBERS_INL_H_
#endif

#include <hwy/highway.h>

#include "sansmesh/core/portable-inl.h"
#include "sansmesh/surface/sample_group.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace pn = portable::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, kGroup>;
using V = hn::Vec<Tag>;
constexpr std::size_t kLanes = hn::MaxLanes(Tag());

HWY_INLINE V Constant(float c) { return hn::Set(Tag(), c); }

/// A value, and with kGradient its derivatives with respect to the coordinates of the point.
template <bool kGradient>
struct Num;
template <>
struct Num<false> {
  V v;
};
template <>
struct Num<true> {
  V v, x, y, z;
};
using Value = Num<false>;
using Dual = Num<true>;

// Functions of these types take one as a tag. They have no constructors, because generated ones would not be compiled
// for the instruction set.
HWY_INLINE Value Number(const V& v, const Value*) { return {v}; }
HWY_INLINE Dual Number(const V& v, const Dual*) {
  const V zero = hn::Zero(Tag());
  return {v, zero, zero, zero};
}
/// A constant.
template <bool kGradient>
HWY_INLINE Num<kGradient> Fixed(float c) {
  return Number(Constant(c), static_cast<const Num<kGradient>*>(nullptr));
}

HWY_INLINE Value operator+(const Value& a, const Value& b) { return {hn::Add(a.v, b.v)}; }
HWY_INLINE Value operator-(const Value& a, const Value& b) { return {hn::Sub(a.v, b.v)}; }
HWY_INLINE Value operator*(const Value& a, const Value& b) { return {hn::Mul(a.v, b.v)}; }
HWY_INLINE Value operator/(const Value& a, const Value& b) { return {hn::Div(a.v, b.v)}; }
HWY_INLINE Value operator*(const Value& a, const V& s) { return {hn::Mul(a.v, s)}; }
HWY_INLINE Value operator+(const Value& a, const V& s) { return {hn::Add(a.v, s)}; }
HWY_INLINE Value Root(const Value& a) { return {hn::Sqrt(a.v)}; }
/// a + b s
HWY_INLINE Value AddMul(const Value& a, const Value& b, const V& s) { return {pn::MulAdd(b.v, s, a.v)}; }

HWY_INLINE Dual operator+(const Dual& a, const Dual& b) {
  return {hn::Add(a.v, b.v), hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Dual operator-(const Dual& a, const Dual& b) {
  return {hn::Sub(a.v, b.v), hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Dual operator*(const Dual& a, const Dual& b) {
  return {hn::Mul(a.v, b.v), pn::MulAdd(a.v, b.x, hn::Mul(b.v, a.x)), pn::MulAdd(a.v, b.y, hn::Mul(b.v, a.y)),
          pn::MulAdd(a.v, b.z, hn::Mul(b.v, a.z))};
}
HWY_INLINE Dual operator/(const Dual& a, const Dual& b) {
  const V inverse = hn::Div(Constant(1), b.v);
  const V q = hn::Mul(a.v, inverse);
  return {q, hn::Mul(pn::NegMulAdd(q, b.x, a.x), inverse), hn::Mul(pn::NegMulAdd(q, b.y, a.y), inverse),
          hn::Mul(pn::NegMulAdd(q, b.z, a.z), inverse)};
}
HWY_INLINE Dual operator*(const Dual& a, const V& s) {
  return {hn::Mul(a.v, s), hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
HWY_INLINE Dual operator+(const Dual& a, const V& s) { return {hn::Add(a.v, s), a.x, a.y, a.z}; }
HWY_INLINE Dual Root(const Dual& a) {
  const V root = hn::Sqrt(a.v);
  const V half = hn::Div(Constant(0.5f), root);
  return {root, hn::Mul(a.x, half), hn::Mul(a.y, half), hn::Mul(a.z, half)};
}
HWY_INLINE Dual AddMul(const Dual& a, const Dual& b, const V& s) {
  return {pn::MulAdd(b.v, s, a.v), pn::MulAdd(b.x, s, a.x), pn::MulAdd(b.y, s, a.y), pn::MulAdd(b.z, s, a.z)};
}

HWY_INLINE Value Select(const hn::Mask<Tag>& m, const Value& a, const Value& b) {
  return {hn::IfThenElse(m, a.v, b.v)};
}
HWY_INLINE Dual Select(const hn::Mask<Tag>& m, const Dual& a, const Dual& b) {
  return {hn::IfThenElse(m, a.v, b.v), hn::IfThenElse(m, a.x, b.x), hn::IfThenElse(m, a.y, b.y),
          hn::IfThenElse(m, a.z, b.z)};
}

/// Three numbers.
template <bool kGradient>
struct Num3 {
  Num<kGradient> x, y, z;
};
template <bool kGradient>
HWY_INLINE Num<kGradient> Dot(const Num3<kGradient>& a, const Num3<kGradient>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <bool kGradient>
HWY_INLINE void AddMul(Num3<kGradient>& sum, const Num<kGradient>& w, float x, float y, float z) {
  sum.x = AddMul(sum.x, w, Constant(x));
  sum.y = AddMul(sum.y, w, Constant(y));
  sum.z = AddMul(sum.z, w, Constant(z));
}

template <bool kGradient>
HWY_INLINE Num3<kGradient> Zero3() {
  return {Fixed<kGradient>(0), Fixed<kGradient>(0), Fixed<kGradient>(0)};
}

/// Coordinates of the points as numbers.
HWY_INLINE Num3<false> Coordinates(const V& x, const V& y, const V& z, const Value*) { return {{x}, {y}, {z}}; }
HWY_INLINE Num3<true> Coordinates(const V& x, const V& y, const V& z, const Dual*) {
  const V one = Constant(1), zero = hn::Zero(Tag());
  return {{x, one, zero, zero}, {y, zero, one, zero}, {z, zero, zero, one}};
}

/// A function g of d² = ‖x − x_i‖², with dx = x − x_i, and its derivative with respect to d².
HWY_INLINE Value Radial(const V& g, const V&, const V&, const V&, const V&, const Value*) { return {g}; }
HWY_INLINE Dual Radial(const V& g, const V& derivative, const V& dx, const V& dy, const V& dz, const Dual*) {
  const V two = hn::Add(derivative, derivative);
  return {g, hn::Mul(two, dx), hn::Mul(two, dy), hn::Mul(two, dz)};
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#endif
