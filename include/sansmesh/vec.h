// Small fixed-size vectors. They are plain aggregates: arrays of them are arrays of scalars, which files, SIMD loops
// and other libraries use without conversion.
#pragma once

#include <cmath>
#include <cstddef>

namespace sansmesh::inline v1 {

/// Vector of three components of type T: a position, a direction or a colour.
template <class T>
struct VecT {
  T x{}, y{}, z{};  ///< component along that axis; 0 by default

  /// Zero vector.
  constexpr VecT() = default;
  /// Vector (x_, y_, z_).
  constexpr VecT(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  /// Casts the components of `o` to T.
  template <class U>
  constexpr explicit VecT(const VecT<U>& o) : x(static_cast<T>(o.x)), y(static_cast<T>(o.y)), z(static_cast<T>(o.z)) {}

  /// Component 0 (x), 1 (y) or 2 (z). Indices are not checked: larger `i` give z.
  constexpr T& operator[](std::size_t i) { return i == 0 ? x : i == 1 ? y : z; }
  /// Same, for a constant vector.
  constexpr const T& operator[](std::size_t i) const { return i == 0 ? x : i == 1 ? y : z; }

  /// Adds `o`, component by component.
  constexpr VecT& operator+=(const VecT& o) { return x += o.x, y += o.y, z += o.z, *this; }
  /// Subtracts `o`, component by component.
  constexpr VecT& operator-=(const VecT& o) { return x -= o.x, y -= o.y, z -= o.z, *this; }
  /// Multiplies every component by `s`.
  constexpr VecT& operator*=(T s) { return x *= s, y *= s, z *= s, *this; }
  /// a + b.
  friend constexpr VecT operator+(VecT a, const VecT& b) { return a += b; }
  /// a − b.
  friend constexpr VecT operator-(VecT a, const VecT& b) { return a -= b; }
  /// −a.
  friend constexpr VecT operator-(const VecT& a) { return {-a.x, -a.y, -a.z}; }
  /// a scaled by s.
  friend constexpr VecT operator*(VecT a, T s) { return a *= s; }
  /// a scaled by s.
  friend constexpr VecT operator*(T s, VecT a) { return a *= s; }
  /// a / s, by division rather than multiplication by 1 / s.
  friend constexpr VecT operator/(const VecT& a, T s) { return {a.x / s, a.y / s, a.z / s}; }
  /// Whether all components are equal; false for NaN.
  friend constexpr bool operator==(const VecT&, const VecT&) = default;
};

/// Vector of doubles: world coordinates and all computations.
using Vec3 = VecT<double>;
/// Vector of floats: stored positions and normals.
using Vec3f = VecT<float>;

/// Inner product ⟨a, b⟩.
template <class T>
constexpr T dot(const VecT<T>& a, const VecT<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Vector product a × b, right-handed.
template <class T>
constexpr VecT<T> cross(const VecT<T>& a, const VecT<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// ‖a‖².
template <class T>
constexpr T squared_norm(const VecT<T>& a) {
  return dot(a, a);
}

/// Euclidean length ‖a‖. Squares overflow from about 1e154 in double and 1e19 in float.
template <class T>
T norm(const VecT<T>& a) {
  return std::sqrt(dot(a, a));
}

/// a / ‖a‖, or the zero vector if ‖a‖ is not positive.
template <class T>
VecT<T> normalized(const VecT<T>& a) {
  const T n = norm(a);
  return n > T(0) ? a / n : VecT<T>{};
}

/// Whether no component is NaN or infinite.
template <class T>
bool is_finite(const VecT<T>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// Completes the unit vector n by two unit vectors to a right-handed orthonormal frame (t, b, n). Continuous except
/// where n.z changes sign (Duff et al. 2017, JCGT 6(1)).
template <class T>
void tangent_frame(const VecT<T>& n, VecT<T>& t, VecT<T>& b) {
  const T sign = std::copysign(T(1), n.z);
  const T a = T(-1) / (sign + n.z);
  const T c = n.x * n.y * a;
  t = {T(1) + sign * n.x * n.x * a, sign * c, -sign * n.x};
  b = {c, sign + n.y * n.y * a, -n.y};
}

}  // namespace sansmesh::inline v1
