// Projections compared with the published formulas in double precision.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/surface/projection_surface.h"
#include "sansmesh/surface/published_projection.h"
#include "source_references.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

using detail::WeighedSample;
using Plane = SurfacePlane;
using Polynomial = SurfacePolynomial;
using Flow = SurfaceFlow;
using Diffusion = SurfaceDiffusion;

constexpr double kWidePlanes = 1.6;

ProjectionSurface project_onto(const PointSet& cloud, ProjectionOptions options) {
  Progress progress;
  options.separate_sheets = false;
  return make_projection_surface(prepare_samples(cloud, progress, 0.0), options, progress);
}

/// Neighbourhood of a surface of height f over the unit disc's plane, with Gaussian weights of width h.
template <class Height>
std::vector<WeighedSample> neighbourhood(const Height& f, double h, unsigned seed = 1, std::size_t count = 200) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<WeighedSample> samples;
  while (samples.size() < count) {
    const double x = u(random), y = u(random);
    samples.push_back({{x, y, f(x, y)}, {0, 0, 1}, 1, 1 / (h * h), true});
  }
  return samples;
}

/// Solves the full system by Gaussian elimination with pivoting.
std::vector<double> solve_fully(std::vector<std::vector<double>> a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t best = c;
    for (std::size_t r = c; r < n; ++r)
      if (std::abs(a[r][c]) > std::abs(a[best][c])) best = r;
    std::swap(a[c], a[best]), std::swap(b[c], b[best]);
    for (std::size_t r = 0; r < n; ++r) {
      if (r == c) continue;
      const double f = a[r][c] / a[c][c];
      for (std::size_t k = c; k < n; ++k) a[r][k] -= f * a[c][k];
      b[r] -= f * b[c];
    }
  }
  for (std::size_t i = 0; i < n; ++i) b[i] /= a[i][i];
  return b;
}

TEST(LevinPlane, HasExactDerivatives) {
  for (const bool gaussian : {false, true}) {
    auto samples = neighbourhood([](double x, double y) { return 0.3 * x * x - 0.2 * x * y + 0.1 * x; }, 0.4);
    for (WeighedSample& s : samples) s.gaussian = gaussian;
    const Vec3 r{0.05, -0.02, 0.2};
    const detail::LevinPlane plane{normalized(Vec3{0.1, -0.2, 1}), -0.1, 0};
    Vec3 by_normal;
    double by_offset = 0;
    detail::levin_energy(samples, r, plane, &by_normal, &by_offset);
    const auto energy = [&](const Vec3& n, double t) {
      return detail::levin_energy(samples, r, {normalized(n), t, 0}, nullptr, nullptr);
    };
    const double e = 1e-6;
    EXPECT_NEAR((energy(plane.normal, plane.offset + e) - energy(plane.normal, plane.offset - e)) / (2 * e), by_offset,
                1e-6 * std::abs(by_offset));
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
      const double slope =
          (energy(plane.normal + axis * e, plane.offset) - energy(plane.normal - axis * e, plane.offset)) / (2 * e);
      EXPECT_NEAR(slope, dot(by_normal, axis), 1e-6 * norm(by_normal));
    }
  }
}

/// No nearby direction and offset have less energy, and the derivatives vanish there; neither holds at the end of the
/// iteration of planes about their own foot.
TEST(LevinPlane, IsTheMinimum) {
  const auto samples = neighbourhood([](double x, double y) { return 0.8 * x * x + 0.3 * x * y; }, 0.35, 4, 60);
  const Vec3 r{0.1, 0.05, 0.15};
  const detail::LevinPlane start{normalized(Vec3{-0.2, 0.1, 1}), -0.1, 0};
  const detail::LevinPlane best = detail::least_levin_plane(samples, r, start, 0.35);
  EXPECT_GT(best.steps, 2);
  Vec3 by_normal;
  double by_offset = 0;
  const double least = detail::levin_energy(samples, r, best, &by_normal, &by_offset);
  EXPECT_LT(least, detail::levin_energy(samples, r, start, nullptr, nullptr));
  EXPECT_LT(norm(by_normal), 1e-8);
  EXPECT_LT(std::abs(by_offset), 1e-8);
  std::mt19937 random(5);
  std::normal_distribution<double> g;
  for (const double size : {1e-3, 1e-2, 5e-2})
    for (int k = 0; k < 300; ++k) {
      const detail::LevinPlane other{normalized(best.normal + Vec3{g(random), g(random), g(random)} * size),
                                     best.offset + 0.35 * size * g(random), 0};
      EXPECT_GE(detail::levin_energy(samples, r, other, nullptr, nullptr), least);
    }
}

TEST(PlanePolynomial, ReproducesPolynomialsOfItsDegree) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int degree = 1; degree <= 4; ++degree) {
    std::array<std::array<double, 5>, 5> c{};
    for (int i = 0; i <= degree; ++i)
      for (int j = 0; i + j <= degree; ++j) c[i][j] = u(random);
    const auto f = [&](double x, double y) {
      double sum = 0;
      for (int i = 0; i <= degree; ++i)
        for (int j = 0; i + j <= degree; ++j) sum += c[i][j] * std::pow(x, i) * std::pow(y, j);
      return sum;
    };
    // In the frame of tangent_frame({0, 0, 1}), which is that of the axes.
    const auto g = detail::fit_polynomial(neighbourhood(f, 0.5), {0, 0, 0}, {0, 0, 1}, degree, false, 0.5);
    EXPECT_EQ(g.degree, degree);
    EXPECT_NEAR(g.value, c[0][0], 1e-9);
    EXPECT_NEAR(g.u, c[1][0], 1e-8);
    EXPECT_NEAR(g.v, c[0][1], 1e-8);
    EXPECT_NEAR(g.uu, 2 * c[2][0], 1e-7);
    EXPECT_NEAR(g.uv, c[1][1], 1e-7);
    EXPECT_NEAR(g.vv, 2 * c[0][2], 1e-7);
    if (degree == 4) continue;
    const auto more = [&](double x, double y) { return f(x, y) + std::pow(x, degree + 1) + std::pow(y, degree + 1); };
    const auto off = detail::fit_polynomial(neighbourhood(more, 0.5), {0, 0, 0}, {0, 0, 1}, degree, false, 0.5);
    EXPECT_GT(std::abs(off.value - c[0][0]) + std::abs(off.u - c[1][0]), 1e-3);
  }
}

TEST(PlanePolynomial, TheIncompleteOneHasNoSlopes) {
  const auto bowl = [](double x, double y) { return 0.3 + 0.7 * x * x - 0.4 * y * y + 0.5 * x * y; };
  const auto g = detail::fit_polynomial(neighbourhood(bowl, 0.5), {0, 0, 0}, {0, 0, 1}, 2, true, 0.5);
  EXPECT_NEAR(g.value, 0.3, 1e-9);
  EXPECT_NEAR(g.uu, 1.4, 1e-7);
  EXPECT_NEAR(g.uv, 0.5, 1e-7);
  EXPECT_NEAR(g.vv, -0.8, 1e-7);
  const auto slope = [&](double x, double y) { return bowl(x, y) + 0.5 * x; };
  const auto h = detail::fit_polynomial(neighbourhood(slope, 0.5), {0, 0, 0}, {0, 0, 1}, 2, true, 0.5);
  EXPECT_EQ(h.u, 0);
  EXPECT_EQ(h.v, 0);
  EXPECT_GT(std::abs(h.value - 0.3), 1e-3);
}

TEST(PlanePolynomial, LowersItsDegreeWhereSamplesAreFew) {
  const auto f = [](double x, double y) { return 1 + x - 2 * y; };
  const std::pair<std::size_t, int> expected[] = {{14, 3}, {9, 2}, {5, 1}, {2, 0}};
  for (const auto& [count, degree] : expected) {
    const auto g = detail::fit_polynomial(neighbourhood(f, 0.8, 3, count), {0, 0, 0}, {0, 0, 1}, 4, false, 0.8);
    EXPECT_EQ(g.degree, degree) << count;
    if (degree > 0) EXPECT_NEAR(g.value, 1, 1e-6) << count;
  }
}

class LevinOf : public testing::TestWithParam<SurfaceWeights> {};

/// The whole operator: descent by finite differences, then the normal equations of all samples.
TEST_P(LevinOf, ProjectsAsTheSourceSays) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others project, too");
  for (const int degree : {1, 2, 3, 4, 0}) {
    const ProjectionSurface p = project_onto(
        test::torus(2500), {.method = ProjectionMethod::levin,
                            .smoothing = kWidePlanes,
                            .plane = Plane::nonlinear,
                            .polynomial = degree == 0 ? Polynomial::incomplete : static_cast<Polynomial>(degree),
                            .weights = GetParam()});
    const test::Weighed all(p.samples(), kWidePlanes, GetParam());
    std::mt19937 random(11);
    std::uniform_real_distribution<double> u(-1, 1);
    std::vector<Vec3> x;
    for (std::size_t i = 0; i < all.x.size(); i += 250)
      x.push_back(all.x[i] + all.n[i] * (0.3 * p.samples().median_spacing * u(random)));
    std::vector<FootPoint> feet(x.size());
    p.project(x, feet);
    for (std::size_t k = 0; k < x.size(); ++k) {
      ASSERT_TRUE(feet[k].defined);
      const double h = all.width(x[k]);
      const auto energy = [&](const Vec3& n, double t) {
        double sum = 0;
        const Vec3 q = x[k] + n * t;
        for (std::size_t i = 0; i < all.x.size(); ++i) sum += std::pow(dot(n, all.x[i] - q), 2) * all.weight(i, q);
        return sum;
      };
      Vec3 n = all.least_covariance(x[k], all.mean(x[k])), a, b;
      tangent_frame(n, a, b);
      double t = dot(n, all.mean(x[k]) - x[k]), least = energy(n, t);
      // Shrinking steps along three directions while one of them reduces the energy.
      for (double step = 0.1; step > 1e-7;) {
        bool lower = false;
        for (const double sign : {-1.0, 1.0})
          for (int axis = 0; axis < 3; ++axis) {
            const Vec3 m = axis == 2 ? n : normalized(n + (axis == 0 ? a : b) * (sign * step));
            const double s = axis == 2 ? t + sign * step * h : t, e = energy(m, s);
            if (e < least) least = e, n = m, t = s, lower = true;
          }
        if (!lower) step *= 0.5;
      }
      const Vec3 q = x[k] + n * t;
      tangent_frame(n, a, b);
      std::vector<std::pair<int, int>> powers;
      if (degree == 0) powers = {{0, 0}, {2, 0}, {1, 1}, {0, 2}};
      for (int of = 0; degree > 0 && of <= degree; ++of)
        for (int j = 0; j <= of; ++j) powers.emplace_back(of - j, j);
      const std::size_t size = powers.size();
      std::vector<std::vector<double>> matrix(size, std::vector<double>(size));
      std::vector<double> right(size);
      for (std::size_t i = 0; i < all.x.size(); ++i) {
        const Vec3 d = all.x[i] - q;
        const double w = all.weight(i, q);
        if (w == 0) continue;
        std::vector<double> row;
        for (const auto& [e, f] : powers) row.push_back(std::pow(dot(d, a) / h, e) * std::pow(dot(d, b) / h, f));
        for (std::size_t r = 0; r < size; ++r) {
          for (std::size_t c = 0; c < size; ++c) matrix[r][c] += w * row[r] * row[c];
          right[r] += w * row[r] * dot(d, n);
        }
      }
      const std::vector<double> c = solve_fully(matrix, right);
      EXPECT_LT(norm(feet[k].position - (q + n * c[0])), 1e-4 * h) << "degree " << degree;
      const Vec3 normal = degree == 0 ? n : normalized(n - a * (c[1] / h) - b * (c[2] / h));
      EXPECT_LT(norm(feet[k].normal - normal), 1e-3) << "degree " << degree;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Both, LevinOf, testing::Values(SurfaceWeights::compact, SurfaceWeights::gaussian),
                         [](const auto& tested) {
                           return tested.param == SurfaceWeights::gaussian ? "gaussian" : "compact";
                         });

/// Halving the spacing divides the error by 2^(d + 1), and by 2^(d + 2) for even degrees.
TEST(LevinDegrees, SpheresConvergeAtTheirOrder) {
  SANSMESH_RUNS_ONCE("scalar code");
  const auto error = [](Polynomial polynomial, std::size_t n) {
    const PointSet cloud = test::sphere(n);
    const ProjectionSurface p = project_onto(
        cloud,
        {.method = ProjectionMethod::levin, .smoothing = 2.2, .plane = Plane::nonlinear, .polynomial = polynomial});
    std::vector<Vec3> x;
    for (std::size_t i = n / 4; i < 3 * n / 4; i += n / 100) x.push_back(normalized(Vec3(cloud.positions[i])) * 1.01);
    std::vector<FootPoint> feet(x.size());
    p.project(x, feet);
    double sum = 0;
    for (const FootPoint& f : feet) sum += std::pow(norm(f.position) - 1, 2);
    return std::sqrt(sum / static_cast<double>(x.size()));
  };
  EXPECT_NEAR(std::log2(error(Polynomial::linear, 500) / error(Polynomial::linear, 2000)), 2, 0.3);
  EXPECT_NEAR(std::log2(error(Polynomial::quadratic, 500) / error(Polynomial::quadratic, 2000)), 4, 0.5);
  EXPECT_NEAR(std::log2(error(Polynomial::cubic, 500) / error(Polynomial::cubic, 2000)), 4, 0.5);
  EXPECT_NEAR(std::log2(error(Polynomial::quartic, 300) / error(Polynomial::quartic, 1200)), 6, 0.9);
}

/// A ridge of two planes, with samples of one side far off the tangent plane of the other.
std::vector<WeighedSample> ridge() {
  return neighbourhood([](double x, double) { return x < 0.1 ? 0.0 : -1.2 * (x - 0.1); }, 0.3, 8, 400);
}

TEST(Diffusion, EndsAtItsFixedPoint) {
  SANSMESH_NOT_SANITIZED("judges results; others run the same loop");
  for (const bool along : {true, false})
    for (const int function : {0, 1, 2}) {
      detail::ProjectionKernel kernel;
      kernel.diffusion = function > 0, kernel.hard = function == 2, kernel.threshold = 0.5f;
      const std::vector<WeighedSample> samples = ridge();
      const Vec3 n{0, 0, 1}, q{0, 0, 0.05};
      const double h = 0.3, most = 0.5 / h;
      const Vec3 x = detail::diffuse(samples, kernel, q, n, h, along);
      // Σ ω_i g_i (x_i − x) at any point, exactly as published.
      const auto flow = [&](const Vec3& at) {
        Vec3 sum;
        double weights = 0;
        for (const WeighedSample& s : samples) {
          const Vec3 d = s.x - at;
          const double w = std::exp(-squared_norm(d) / (h * h)), k = std::abs(2 * dot(n, d) / squared_norm(d));
          if (squared_norm(d) >= 12 * h * h) continue;
          const double g = function == 0 || k <= most ? 1
                           : function == 2            ? 0
                                                      : most * most / (most * most + 10 * (k - most) * (k - most));
          sum += d * (w * g), weights += w;
        }
        sum = sum / weights;
        return along ? n * dot(n, sum) : sum;
      };
      if (function < 2) EXPECT_LT(norm(flow(x)), 2e-7 * h) << along << function;
      // Where the hard function jumps, the flow changes its sign.
      if (function == 2 && along && norm(flow(x)) > 2e-7 * h)
        EXPECT_LT(dot(flow(x + n * (0.01 * h)), flow(x - n * (0.01 * h))), 0);
      Vec3 slow = q;
      for (int k = 0; k < 20000 && function < 2; ++k) slow += flow(slow) * 0.1;
      if (function < 2) EXPECT_LT(norm(slow - x), 1e-4 * h) << along << function;
      if (along) EXPECT_EQ(x.x, q.x);
    }
}

TEST(Diffusion, FunctionsDiffer) {
  std::array<double, 3> z{};
  for (const int function : {0, 1, 2}) {
    detail::ProjectionKernel kernel;
    kernel.diffusion = function > 0, kernel.hard = function == 2, kernel.threshold = 0.5f;
    z[static_cast<std::size_t>(function)] = detail::diffuse(ridge(), kernel, {0, 0, 0.02}, {0, 0, 1}, 0.3, true).z;
  }
  // The plane's own height is 0: the ridge's other side pulls the mean down, less with the function of lange2005.
  EXPECT_LT(z[0], z[1] - 0.005);
  EXPECT_GT(std::abs(z[1] - z[2]), 0.001);
}

/// Hard weights are exactly 0: a distant sample that alone exceeds λ changes nothing.
TEST(Diffusion, HardIsZeroBeyondTheThreshold) {
  PointSet plane;
  for (int i = -20; i <= 20; ++i)
    for (int j = -20; j <= 20; ++j) plane.positions.push_back({0.1f * i, 0.1f * j, 0});
  PointSet with = plane;
  with.positions.push_back({0.05f, 0.05f, 0.12f});
  plane.positions.push_back({1.95f, 1.95f, 0});  // as many samples, elsewhere
  plane.normals.assign(plane.size(), {0, 0, 1}), with.normals = plane.normals;
  // Starting points are on the plane, whose samples have no curvature; the stray sample pulls up the mean plane only.
  for (const Flow flow : {Flow::fit, Flow::normal}) {
    ProjectionOptions o{.bandwidth = 0.2, .diffusion = Diffusion::hard, .threshold = 0.4, .flow = flow};
    const std::vector<Vec3> x{{0.05, 0.05, 0}};
    std::vector<FootPoint> hard(1), none(1);
    project_onto(with, o).project(x, hard);
    o.diffusion = Diffusion::none;
    project_onto(with, o).project(x, none);
    EXPECT_GT(none[0].position.z, 1e-3);
    EXPECT_NEAR(hard[0].position.z, 0, 2e-5) << static_cast<int>(flow);
  }
}

TEST(DirectionalCurvatures, AreTheLeastSquaresOfTheSource) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> u(-1, 1);
  for (const int tau : {1, 2, 3}) {
    std::vector<WeighedSample> samples;
    for (int i = 0; i < 80; ++i)
      samples.push_back({{u(random), u(random), 0.2 * u(random)}, {0, 0, 1}, 1, 1 / (0.6 * 0.6), true});
    std::vector<std::vector<double>> a(3, std::vector<double>(3));
    std::vector<double> b(3);
    for (const WeighedSample& s : samples) {
      const double rho = norm(s.x), theta = std::atan2(s.x.y, s.x.x), kappa = 2 * s.x.z / (rho * rho);
      if (rho * rho >= 12 * 0.36) continue;
      const double w = std::pow(rho, 2 * tau) * std::exp(-rho * rho / 0.36);
      const std::array<double, 3> row{1, std::cos(2 * theta), std::sin(2 * theta)};
      for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) a[r][c] += w * row[r] * row[c];
        b[r] += w * row[r] * kappa;
      }
    }
    const std::vector<double> chi = solve_fully(a, b);
    const Vec3 found = detail::fit_directional_curvatures(samples, {}, {0, 0, 1}, tau, 0.6);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], chi[i], 1e-9);
  }
}

/// The fixed point of means is below the surface by ½ κ times the mean of ρ². Seen from there a sphere has less
/// curvature: the fit without an offset finds 1 − 1/τ of the curvature, the fit with it all.
TEST(Diffusion, ItsFixedPointHidesCurvature) {
  const PointSet cloud = test::sphere(20000);
  for (const int tau : {1, 2, 3}) {
    ProjectionOptions o{.smoothing = 2, .tau = tau, .flow = Flow::normal, .weights = SurfaceWeights::gaussian};
    const ProjectionSurface source = project_onto(cloud, o);
    o.flow = Flow::fit;
    const ProjectionSurface ours = project_onto(cloud, o);
    std::vector<Vec3> x;
    for (std::size_t i = 5000; i < 15000; i += 100) x.emplace_back(cloud.positions[i]);
    std::vector<FootPoint> of_source(x.size()), of_ours(x.size());
    source.project(x, of_source), ours.project(x, of_ours);
    double found = 0, all = 0, below = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      found -= 0.5 * (of_source[i].xx + of_source[i].yy) / static_cast<double>(x.size());
      all -= 0.5 * (of_ours[i].xx + of_ours[i].yy) / static_cast<double>(x.size());
      below += (1 - norm(of_source[i].position)) / static_cast<double>(x.size());
    }
    const double h = 2 * source.samples().median_spacing;
    EXPECT_NEAR(found, 1 - 1.0 / tau, 0.03) << tau;
    EXPECT_NEAR(all, 1, 0.03) << tau;
    EXPECT_NEAR(below, 0.5 * h * h, 0.05 * h * h);
  }
}

/// Gaussian weights in the kernels of the default formulas against the scalar code, which is independent of them.
TEST(GaussianProjections, TheKernelsAgreeWithTheFormulas) {
  const PointSet cloud = test::torus(3000);
  Progress progress;
  for (const ProjectionMethod method : {ProjectionMethod::alexa, ProjectionMethod::levin}) {
    const ProjectionSurface p =
        project_onto(cloud, {.method = method, .smoothing = kWidePlanes, .weights = SurfaceWeights::gaussian});
    const test::Weighed all(p.samples(), kWidePlanes, SurfaceWeights::gaussian);
    const double h = kWidePlanes * p.samples().median_spacing;
    std::vector<Vec3> x;
    for (std::size_t i = 0; i < all.x.size(); i += 100) x.push_back(all.x[i] + all.n[i] * (0.1 * h));
    std::vector<FootPoint> feet(x.size());
    p.project(x, feet);
    for (std::size_t k = 0; k < x.size(); ++k) {
      Vec3 n = all.least_covariance(x[k], all.mean(x[k]));
      double t = dot(n, all.mean(x[k]) - x[k]);
      for (int step = 0; step < 6 && method == ProjectionMethod::levin; ++step) {
        const Vec3 q = x[k] + n * t, mean = all.mean(q);
        n = all.least_covariance(q, mean), t = dot(n, mean - x[k]);
      }
      std::vector<WeighedSample> samples;
      for (std::size_t i = 0; i < all.x.size(); ++i) samples.push_back({all.x[i], all.n[i], 1, 1 / (h * h), true});
      const Vec3 q = x[k] + n * t;
      const auto g = detail::fit_polynomial(samples, q, n, 2, false, h);
      EXPECT_LT(norm(feet[k].position - (q + n * g.value)), 1e-4 * h);
    }
  }
}

TEST(ProjectionSources, EveryChoiceFindsASphere) {
  std::vector<ProjectionOptions> choices;
  for (const int degree : {1, 3, 4, 5})
    choices.push_back({.method = ProjectionMethod::alexa, .polynomial = static_cast<Polynomial>(degree)});
  choices.push_back({.method = ProjectionMethod::levin, .plane = Plane::nonlinear});
  for (const Flow flow : {Flow::normal, Flow::free})
    for (const int tau : {1, 2, 3}) choices.push_back({.diffusion = Diffusion::soft, .tau = tau, .flow = flow});
  const PointSet cloud = test::sphere(4000);
  for (const ProjectionOptions& o : choices) {
    const ProjectionSurface p = project_onto(cloud, o);
    std::vector<Vec3> x;
    for (std::size_t i = 0; i < cloud.size(); i += 40) x.push_back(Vec3(cloud.positions[i]) * 1.01);
    std::vector<FootPoint> feet(x.size());
    p.project(x, feet);
    for (const FootPoint& f : feet) {
      ASSERT_TRUE(f.defined);
      EXPECT_NEAR(norm(f.position), 1, 3e-3);
      const bool curved = o.polynomial != Polynomial::linear && o.flow == Flow::fit;
      if (curved) EXPECT_NEAR(0.5 * (f.xx + f.yy), -1, 0.3);
    }
  }
}

TEST(ProjectionSources, AreRefusedWhereTheyMeanNothing) {
  EXPECT_THROW((ProjectionOptions{.method = ProjectionMethod::alexa, .plane = Plane::nonlinear}.validate()),
               ArgumentError);
  EXPECT_THROW((ProjectionOptions{.polynomial = Polynomial::cubic}.validate()), ArgumentError);
  EXPECT_THROW((ProjectionOptions{.method = ProjectionMethod::levin, .flow = Flow::free}.validate()), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
