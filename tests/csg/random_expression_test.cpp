// Random expressions equal the combination of their parts, for one point and for many.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "csg/catalogue.h"
#include "sansmesh/csg/parse_csg.h"
#include "sansmesh/field/piece_expression.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// A text, and its expected value.
struct Meaning {
  std::string text;
  std::function<double(const Vec3&)> value;
};

double smooth_least(double a, double b, double r) {
  return std::abs(a - b) < r ? (a + b) / 2 - (r * r + (a - b) * (a - b)) / (4 * r) : std::min(a, b);
}

class Writer {
 public:
  explicit Writer(unsigned seed) : random_(seed) {}

  /// Long alternations, which the parser turns into equally deep trees.
  Meaning chain(int links, int depth) {
    Meaning all = expression(depth);
    for (int k = 0; k < links; ++k) {
      const Meaning part = expression(depth);
      const auto f = all.value, g = part.value;
      if (pick(2) == 0) {
        all = {all.text + " - " + part.text, [=](const Vec3& x) { return std::max(f(x), -g(x)); }};
      } else {
        all = {all.text + " | " + part.text, [=](const Vec3& x) { return std::min(f(x), g(x)); }};
      }
    }
    return all;
  }

  Meaning expression(int depth) {
    if (depth == 0) return primitive();
    switch (pick(10)) {
      case 0:
        return combined(depth, true);
      case 1:
      case 2:
        return combined(depth, false);
      case 3:
        return blended(depth);
      case 4: {
        const Meaning a = expression(depth - 1);
        return {"~" + a.text, [f = a.value](const Vec3& x) { return -f(x); }};
      }
      case 5:
        return grown(depth);
      case 6: {
        const Meaning a = chain(pick(4), depth - 1);
        return {"(" + a.text + ")", a.value};
      }
      case 7:
      case 8:
        return moved(depth);
      default:
        return primitive();
    }
  }

 private:
  int pick(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  /// Lengths of few digits, so that many parts have faces in the same planes.
  double length() { return 0.1 * (1 + pick(12)); }
  Vec3 place() { return {0.1 * (pick(21) - 10), 0.1 * (pick(21) - 10), 0.1 * (pick(21) - 10)}; }
  Vec3 direction() {
    const Vec3 d = place();
    return norm(d) > 0 ? d : Vec3{0, 0, 1};
  }
  static std::string text(const Vec3& v) { return fmt::format("({},{},{})", v.x, v.y, v.z); }

  Meaning primitive() {
    const Vec3 c = place(), n = direction();
    const double r = length(), h = length();
    switch (pick(7)) {
      case 0:
        return of(fmt::format("sphere({}, {})", r, text(c)), csg::sphere(c, r));
      case 1: {
        const Vec3 half = Vec3{r, h, length()} * 0.5;
        return of(fmt::format("box(({},{},{}), {})", 2 * half.x, 2 * half.y, 2 * half.z, text(c)),
                  csg::box(c - half, c + half));
      }
      case 2:
        return of(fmt::format("cylinder(r={}, h={}, axis={}, center={})", r, h, text(n), text(c)),
                  csg::cylinder(c, n, r, h));
      case 3:
        return of(fmt::format("cone(r={}, h={}, axis={}, center={})", r, h, text(n), text(c)),
                  csg::cone(c, n, r, 0, h));
      case 4:
        return of(fmt::format("torus(R={}, r={}, axis={}, center={})", 2 * r, r, text(n), text(c)),
                  csg::torus(c, n, 2 * r, r));
      case 5:
        return of(fmt::format("capsule(r={}, from={}, to={})", r, text(c), text(c + n)), csg::capsule(c, c + n, r));
      default:
        return of(fmt::format("plane({}, {})", text(n), r), csg::half_space(n, r));
    }
  }
  static Meaning of(std::string text, const Solid& solid) {
    return {std::move(text), [=](const Vec3& x) { return value_at(solid, x); }};
  }

  Meaning combined(int depth, bool intersection) {
    std::vector<Meaning> parts;
    const int count = 2 + pick(5);
    for (int k = 0; k < count; ++k) parts.push_back(expression(depth - 1));
    std::string text = intersection ? "intersection(" : "union(";
    for (const Meaning& m : parts) text += (&m == &parts[0] ? "" : ", ") + m.text;
    return {text + ")", [=](const Vec3& x) {
              double all = parts[0].value(x);
              for (const Meaning& m : parts) all = intersection ? std::max(all, m.value(x)) : std::min(all, m.value(x));
              return all;
            }};
  }

  Meaning blended(int depth) {
    const Meaning a = expression(depth - 1), b = expression(depth - 1);
    const double r = length();
    const auto f = a.value, g = b.value;
    switch (pick(3)) {
      case 0:
        return {fmt::format("union({}, {}, r={})", a.text, b.text, r),
                [=](const Vec3& x) { return smooth_least(f(x), g(x), r); }};
      case 1:
        return {fmt::format("intersection({}, {}, r={})", a.text, b.text, r),
                [=](const Vec3& x) { return -smooth_least(-f(x), -g(x), r); }};
      default:
        return {fmt::format("difference({}, {}, r={})", a.text, b.text, r),
                [=](const Vec3& x) { return -smooth_least(-f(x), g(x), r); }};
    }
  }

  Meaning grown(int depth) {
    const Meaning a = expression(depth - 1);
    const double d = length();
    const auto f = a.value;
    switch (pick(4)) {
      case 0:
        return {fmt::format("offset({}, {})", a.text, d), [=](const Vec3& x) { return f(x) - d; }};
      case 1:
        return {fmt::format("offset({}, -{})", a.text, d), [=](const Vec3& x) { return f(x) + d; }};
      case 2:
        return {fmt::format("shell({}, {})", a.text, d), [=](const Vec3& x) { return std::abs(f(x)) - d / 2; }};
      default:
        return {fmt::format("shell({}, {}, inside)", a.text, d),
                [=](const Vec3& x) { return std::abs(f(x) + d / 2) - d / 2; }};
    }
  }

  Meaning moved(int depth) {
    const Meaning a = expression(depth - 1);
    const auto f = a.value;
    const Vec3 v = direction();
    switch (pick(4)) {
      case 0:
        return {fmt::format("translate({}, {})", a.text, text(v)), [=](const Vec3& x) { return f(x - v); }};
      case 1: {
        const double s = length();
        return {fmt::format("scale({}, {})", a.text, s), [=](const Vec3& x) { return s * f(x / s); }};
      }
      case 2: {
        const Vec3 n = normalized(v);
        return {fmt::format("mirror({}, {})", a.text, text(v)),
                [=](const Vec3& x) { return f(x - n * (2 * dot(n, x))); }};
      }
      default: {
        const double degrees = 15.0 * (1 + pick(23)), angle = -degrees * std::numbers::pi / 180;
        const Vec3 u = normalized(v);
        return {fmt::format("rotate({}, {}, {})", a.text, degrees, text(v)), [=](const Vec3& x) {
                  const double c = std::cos(angle), s = std::sin(angle);
                  return f(x * c + cross(u, x) * s + u * (dot(u, x) * (1 - c)));
                }};
      }
    }
  }

  std::mt19937 random_;
};

/// Points of few digits, where faces meet, and others.
std::vector<Vec3> places_to_ask() {
  std::vector<Vec3> x = random_points(150, 3);
  std::mt19937 random(11);
  std::uniform_int_distribution<int> step(-20, 20);
  for (int k = 0; k < 150; ++k) x.push_back({0.1 * step(random), 0.1 * step(random), 0.1 * step(random)});
  x.push_back({1e6, -1e6, 3e5});
  return x;
}

void expect_as_meant(const Meaning& meant, const std::vector<Vec3>& x) {
  SCOPED_TRACE(meant.text.substr(0, 3000));
  const Solid solid = parse_csg(meant.text, [](const std::string&) { return csg::sphere({}, 1); });
  std::vector<double> value(x.size()), one(1);
  std::vector<Vec3> gradient(x.size()), slope(1);
  std::vector<std::uint32_t> piece(x.size()), active(1);
  solid.evaluate(x, value, gradient);
  solid.active(x, piece);
  auto expression = solid.expression(1e-12);
  if (expression && expression->nodes().size() > 2000) expression = nullptr;  // each point evaluates all of them
  const Box3 box = solid.bounds();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto at = std::span<const Vec3>(x).subspan(i, 1);
    solid.evaluate(at, one, slope);
    solid.active(at, active);
    ASSERT_EQ(one[0], value[i]) << i;
    ASSERT_EQ(slope[0], gradient[i]) << i;
    ASSERT_EQ(active[0], piece[i]) << i;
    const double room = 1e-11 * (1 + norm(x[i])), expected = meant.value(x[i]);
    ASSERT_NEAR(value[i], expected, room) << i;
    ASSERT_LE(norm(gradient[i]), 1 + 1e-9) << i;
    solid.evaluate_piece(piece[i], at, one, slope);
    ASSERT_NEAR(one[0], value[i], room) << i;
    for (std::size_t k = 0; k < 3 && expected < -1e-9; ++k) {
      ASSERT_GE(x[i][k], box.lower[k] - 1e-9) << i;
      ASSERT_LE(x[i][k], box.upper[k] + 1e-9) << i;
    }
    if (!expression || std::abs(expected) < 1e-9 * (1 + norm(x[i]))) continue;
    expression->evaluate(at, one);
    ASSERT_EQ(one[0] < 0, expected < 0) << i << ": " << one[0] << ", not " << expected;
  }
}

TEST(RandomExpression, SaysWhatItsPartsSay) {
  const std::vector<Vec3> x = places_to_ask();
  for (unsigned seed = 0; seed < 150 && !::testing::Test::HasFailure(); ++seed) {
    Writer writer(seed);
    expect_as_meant(seed % 3 == 0 ? writer.chain(12, 1) : writer.expression(1 + static_cast<int>(seed % 4)), x);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
