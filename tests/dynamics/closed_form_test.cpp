// Bodies whose motion is known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "dynamics/body_checks.h"
#include "support/tet_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::ideal;
using test::kAllIntegrators;

constexpr double kPi = std::numbers::pi;
constexpr double kGravity = 9.81;

/// The first two zeros of value(), interpolated linearly between steps.
template <class Value>
std::vector<double> zeros_of(SoftBody& body, std::size_t count, const Value& value) {
  std::vector<double> zeros;
  double before = value(), at = body.time();
  for (int k = 0; k < 200000 && zeros.size() < count; ++k) {
    body.step();
    const double now = value();
    if ((before < 0) != (now < 0)) zeros.push_back(at + (body.time() - at) * before / (before - now));
    before = now, at = body.time();
  }
  return zeros;
}

TEST(ClosedForm, WeightOnASpring) {
  // A tetrahedron whose four vertices are attached to separate springs: it oscillates as a whole.
  const double k = 40, mass = 2, omega = std::sqrt(4 * k / mass);
  for (std::string_view integrator : kAllIntegrators) {
    SoftBodyOptions options = ideal(integrator, 1e-5);
    options.gravity = {0, 0, -kGravity}, options.total_mass = mass;
    DynamicsScene scene;
    scene.handles.push_back({{0, 1, 2, 3}, {{}}, {}, k});
    SoftBody body(test::one_tet(), options, scene);
    body.advance(0.05);
    const double fall = mass * kGravity / (4 * k) * (std::cos(omega * 0.05) - 1);
    EXPECT_NEAR(body.positions()[3].z, 1 + fall, 1e-3 * std::abs(fall)) << integrator;
  }
}

TEST(ClosedForm, VertexOnThreeSprings) {
  // The top of a regular tetrahedron with edges of 1, whose edges are at cos² = 2/3 to the vertical.
  const TetMesh mesh = test::turned_outward({{{0, 0, std::sqrt(2.0 / 3)},
                                              {1 / std::sqrt(3.0), 0, 0},
                                              {-0.5 / std::sqrt(3.0), -0.5, 0},
                                              {-0.5 / std::sqrt(3.0), 0.5, 0}},
                                             {{0, 1, 3, 2}},
                                             {},
                                             {}});
  SoftBodyOptions options = ideal("verlet", 1e-4);
  options.total_mass = 4, options.stiffness = 50;
  DynamicsScene scene;
  scene.fixed = {1, 2, 3};
  SoftBody body(mesh, options, scene);
  auto x = mesh.vertices;
  x[0].z += 1e-4;
  body.set_state(x, std::vector<Vec3>(4));
  const auto zeros = zeros_of(body, 2, [&] { return body.positions()[0].z - mesh.vertices[0].z; });
  ASSERT_EQ(zeros.size(), 2);
  EXPECT_NEAR(zeros[1] - zeros[0], kPi / std::sqrt(3 * 50 * 2.0 / 3), 1e-3);
}

TEST(ClosedForm, Pendulum) {
  // A stiff regular tetrahedron suspended at a corner: three masses around an axis through it.
  const TetMesh mesh{{{0, 0, 0},
                      {1 / std::sqrt(3.0), 0, -std::sqrt(2.0 / 3)},
                      {-0.5 / std::sqrt(3.0), 0.5, -std::sqrt(2.0 / 3)},
                      {-0.5 / std::sqrt(3.0), -0.5, -std::sqrt(2.0 / 3)}},
                     {{0, 1, 2, 3}},
                     {},
                     {}};
  const TetMesh outward = test::turned_outward(mesh);
  double inertia = 0, moment = 0;  // about y, for unit masses
  for (std::size_t v = 1; v < 4; ++v) {
    const Vec3 p = mesh.vertices[v];
    inertia += p.x * p.x + p.z * p.z, moment -= p.z;
  }
  const double amplitude = 0.2, small = 2 * kPi * std::sqrt(inertia / (moment * kGravity));
  const double period = small * (1 + amplitude * amplitude / 16);
  for (const SoftBodyModel model : {SoftBodyModel::springs, SoftBodyModel::corotational}) {
    for (std::string_view integrator : {"velocity-verlet", "implicit-euler"}) {
      SoftBodyOptions options = ideal(integrator, 2e-4);
      options.model = model, options.gravity = {0, 0, -kGravity}, options.total_mass = 4, options.stiffness = 2e5;
      options.young = 1e6;
      DynamicsScene scene;
      scene.fixed = {0};
      SoftBody body(outward, options, scene);
      auto x = outward.vertices;
      for (Vec3& p : x) {
        p = {std::cos(amplitude) * p.x - std::sin(amplitude) * p.z, p.y,
             std::sin(amplitude) * p.x + std::cos(amplitude) * p.z};
      }
      body.set_state(x, std::vector<Vec3>(4));
      const auto zeros = zeros_of(body, 3, [&] { return test::center_of(body).x; });
      ASSERT_EQ(zeros.size(), 3);
      EXPECT_NEAR(zeros[2] - zeros[0], period, 0.003 * period);
    }
  }
}

/// A cantilever 1 long, 0.2 high and narrower, fixed at x = 0.
struct Cantilever {
  static constexpr double kLength = 1, kHeight = 0.2, kWidth = 0.06, kModulus = 1e6, kPoisson = 0.3, kDensity = 1000;
  static constexpr double kArea = kHeight * kWidth, kSecondMoment = kArea * kHeight * kHeight / 12;
  static constexpr double kShear = kModulus / (2 * (1 + kPoisson));
  static constexpr double kFactor = 10 * (1 + kPoisson) / (12 + 11 * kPoisson);  ///< shear coefficient [cowper1966]
  TetMesh mesh;
  DynamicsScene scene;
  std::vector<std::uint32_t> end;

  explicit Cantilever(TetMesh coarse) : mesh(std::move(coarse)) {
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
      if (mesh.vertices[v].x < 1e-9) scene.fixed.push_back(v);
      if (mesh.vertices[v].x > kLength - 1e-9) end.push_back(v);
    }
  }
  static SoftBodyOptions options(double step) {
    SoftBodyOptions options = ideal("implicit-euler", step);
    options.model = SoftBodyModel::corotational, options.young = kModulus, options.poisson = kPoisson;
    options.density = kDensity, options.tolerance = 1e-6, options.iterations = 20000;
    return options;
  }
  double height(const SoftBody& body) const {
    double z = 0;
    const auto x = body.positions();
    for (const std::uint32_t v : end) z += x[v].z - mesh.vertices[v].z;
    return z / static_cast<double>(end.size());
  }
};

/// Cells as long as high, n through the height.
TetMesh cantilever_cells(std::size_t n) {
  return test::box_of_tets({0, 0, 0}, {Cantilever::kLength, Cantilever::kWidth, Cantilever::kHeight}, 5 * n, n / 3, n);
}

/// Deflection of the end under a force, relative to Timoshenko's theory.
double bend(const TetMesh& mesh) {
  Cantilever bar(mesh);
  const double force = 0.05;
  bar.scene.forces.push_back({bar.end, {0, 0, -force / static_cast<double>(bar.end.size())}});
  SoftBody body(bar.mesh, Cantilever::options(1000), bar.scene);
  for (int k = 0; k < 3; ++k) body.step();  // steps so long that inertia is negligible
  const double length = Cantilever::kLength;
  const double theory = force * length * length * length / (3 * Cantilever::kModulus * Cantilever::kSecondMoment) +
                        force * length / (Cantilever::kFactor * Cantilever::kShear * Cantilever::kArea);
  EXPECT_LT(theory, 0.01 * length);
  return -bar.height(body) / theory;
}

// Linear tetrahedra are too stiff; the error falls with the square of their size.
TEST(ClosedForm, BarSinksAsTheoryOfBeamsSays) {
  const TetMesh coarse = cantilever_cells(6);
  const double before = bend(coarse), after = bend(test::refine_uniformly(coarse));
  EXPECT_LT(before, 0.95);
  EXPECT_NEAR(after, 1, 0.05);
  EXPECT_NEAR((1 - before) / (1 - after), 4, 1.5);
}

TEST(ClosedForm, BarVibratesAsTheoryOfBeamsSays) {
  // First bending frequency of Euler and Bernoulli and that of pure shear, combined by Dunkerley's rule.
  const double root = 1.8751040687, length = Cantilever::kLength;
  const double bending =
      root * root / (length * length) *
      std::sqrt(Cantilever::kModulus * Cantilever::kSecondMoment / (Cantilever::kDensity * Cantilever::kArea));
  const double shear = 0.5 * kPi / length * std::sqrt(Cantilever::kFactor * Cantilever::kShear / Cantilever::kDensity);
  const double omega = 1 / std::sqrt(1 / (bending * bending) + 1 / (shear * shear));
  Cantilever bar(cantilever_cells(9));
  SoftBody body(bar.mesh, Cantilever::options(2 * kPi / omega / 100), bar.scene);
  // Initial velocity approximately in the shape of the first vibration.
  std::vector<Vec3> v(bar.mesh.vertices.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double s = bar.mesh.vertices[i].x;
    v[i].z = 0.02 * s * s * (6 - 4 * s + s * s) / 3;
  }
  body.set_state(bar.mesh.vertices, v);
  const auto zeros = zeros_of(body, 1, [&] { return body.time() == 0 ? 1e-30 : bar.height(body); });
  ASSERT_EQ(zeros.size(), 1);
  EXPECT_NEAR(kPi / zeros[0], omega, 0.05 * omega);
}

}  // namespace
}  // namespace sansmesh::inline v1
