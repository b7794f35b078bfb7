// Solids of half-spaces, balls and cylinders for tests of creases: exact, small, slow.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "sansmesh/field/piecewise_field.h"

namespace sansmesh::test {

/// A smooth function and its gradient.
using SmoothPiece = std::function<double(const Vec3&, Vec3&)>;

/// A tree of minima, maxima and complements over smooth pieces.
struct Solid {
  enum class Kind { kPiece, kUnion, kIntersection, kComplement };
  Kind kind = Kind::kPiece;
  SmoothPiece piece;
  std::vector<Solid> parts;
};

inline Solid half_space(const Vec3& normal, double offset) {
  const Vec3 n = normalized(normal);
  return {Solid::Kind::kPiece,
          [=](const Vec3& x, Vec3& g) {
            g = n;
            return dot(n, x) - offset;
          },
          {}};
}
inline Solid ball(const Vec3& centre, double radius) {
  return {Solid::Kind::kPiece,
          [=](const Vec3& x, Vec3& g) {
            g = normalized(x - centre);
            return norm(x - centre) - radius;
          },
          {}};
}
/// Infinite.
inline Solid cylinder(const Vec3& point, const Vec3& axis, double radius) {
  const Vec3 a = normalized(axis);
  return {Solid::Kind::kPiece,
          [=](const Vec3& x, Vec3& g) {
            const Vec3 d = x - point - a * dot(x - point, a);
            g = normalized(d);
            return norm(d) - radius;
          },
          {}};
}
inline Solid unite(std::vector<Solid> parts) { return {Solid::Kind::kUnion, {}, std::move(parts)}; }
inline Solid intersect(std::vector<Solid> parts) { return {Solid::Kind::kIntersection, {}, std::move(parts)}; }
inline Solid complement(Solid part) {
  Solid s{Solid::Kind::kComplement, {}, {}};
  s.parts.push_back(std::move(part));
  return s;
}
inline Solid subtract(Solid a, Solid b) { return intersect({std::move(a), complement(std::move(b))}); }

/// Rows of a rotation matrix that is unrelated to the lattice's axes.
inline std::array<Vec3, 3> tilted_axes() {
  const Vec3 a = normalized(Vec3{0.8, 0.33, 0.21});
  const Vec3 b = normalized(cross(a, Vec3{0.1, -0.3, 0.9}));
  return {a, b, cross(a, b)};
}
inline std::array<Vec3, 3> straight_axes() { return {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}; }

inline Solid box(const Vec3& centre, const Vec3& half, const std::array<Vec3, 3>& axes = straight_axes()) {
  std::vector<Solid> parts;
  for (std::size_t k = 0; k < 3; ++k) {
    parts.push_back(half_space(axes[k], dot(axes[k], centre) + half[k]));
    parts.push_back(half_space(-axes[k], -dot(axes[k], centre) + half[k]));
  }
  return intersect(std::move(parts));
}

class SolidField : public PiecewiseField {
 public:
  explicit SolidField(const Solid& solid) { root_ = add(solid, 1); }

  Box3 bounds() const override { return {{-1, -1, -1}, {1, 1, 1}}; }
  std::uint32_t pieces() const override { return static_cast<std::uint32_t>(pieces_.size()); }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Found f = find(root_, x[i]);
      values[i] = f.value;
      if (!gradients.empty()) gradients[i] = f.gradient;
    }
  }
  void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const override {
    for (std::size_t i = 0; i < x.size(); ++i) piece[i] = find(root_, x[i]).piece;
  }
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      Vec3 g;
      values[i] = pieces_[piece].sign * pieces_[piece].f(x[i], g);
      if (!gradients.empty()) gradients[i] = g * pieces_[piece].sign;
    }
  }

 private:
  struct Leaf {
    SmoothPiece f;
    double sign;
  };
  struct Node {
    bool leaf, least;
    std::uint32_t piece = 0;
    std::vector<Node> parts = {};
  };
  struct Found {
    double value;
    Vec3 gradient;
    std::uint32_t piece;
  };

  Node add(const Solid& s, double sign) {
    if (s.kind == Solid::Kind::kComplement) return add(s.parts[0], -sign);
    if (s.kind == Solid::Kind::kPiece) {
      pieces_.push_back({s.piece, sign});
      return {true, false, static_cast<std::uint32_t>(pieces_.size() - 1)};
    }
    Node node{false, (s.kind == Solid::Kind::kUnion) == (sign > 0)};
    for (const Solid& part : s.parts) node.parts.push_back(add(part, sign));
    return node;
  }
  Found find(const Node& n, const Vec3& x) const {
    if (n.leaf) {
      Found f{0, {}, n.piece};
      f.value = pieces_[n.piece].sign * pieces_[n.piece].f(x, f.gradient);
      f.gradient *= pieces_[n.piece].sign;
      return f;
    }
    Found best = find(n.parts[0], x);
    for (std::size_t k = 1; k < n.parts.size(); ++k) {
      const Found f = find(n.parts[k], x);
      if (n.least ? f.value < best.value : f.value > best.value) best = f;
    }
    return best;
  }

  std::vector<Leaf> pieces_;
  Node root_{};
};

}  // namespace sansmesh::test
