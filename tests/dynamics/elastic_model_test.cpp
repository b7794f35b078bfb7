#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "dynamics/body_checks.h"
#include "sansmesh/dynamics/block_solver.h"
#include "sansmesh/dynamics/corotational_model.h"
#include "sansmesh/dynamics/polar_rotation.h"
#include "sansmesh/dynamics/spring_model.h"
#include "support/tet_shapes.h"

namespace sansmesh::inline v1 {
namespace {

TetMesh little_box() { return test::box_of_tets({0, 0, 0}, {1, 0.8, 0.6}, 2, 2, 1); }

std::unique_ptr<ElasticModel> springs_of(const TetMesh& mesh, double damping = 0) {
  return std::make_unique<SpringModel>(vertex_graph(mesh.tets, mesh.vertices.size()), mesh.vertices, 100, damping);
}

std::unique_ptr<ElasticModel> elastic_of(const TetMesh& mesh, double damping = 0) {
  return std::make_unique<CorotationalModel>(mesh.tets, mesh.vertices, 1000, 0.3, damping);
}

Eigen::Matrix3d dense(const Matrix3& m) {
  Eigen::Matrix3d d;
  d << m.a.x, m.b.x, m.c.x, m.a.y, m.b.y, m.c.y, m.a.z, m.b.z, m.c.z;
  return d;
}

Eigen::MatrixXd matrix_of(ElasticModel& model, const std::vector<Vec3>& x, double h) {
  const std::size_t n = x.size();
  std::vector<Vec3> f(n), p(n), q(n);
  model.linearize(x, h, f);
  Eigen::MatrixXd matrix(3 * n, 3 * n);
  for (std::size_t c = 0; c < 3 * n; ++c) {
    p.assign(n, {}), q.assign(n, {});
    p[c / 3][c % 3] = 1;
    model.add_rows(0, n, p, q);
    for (std::size_t r = 0; r < 3 * n; ++r) {
      matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = q[r / 3][r % 3];
    }
  }
  return matrix;
}

TEST(ElasticModel, ForcesAreTheSlopeOfTheEnergy) {
  const TetMesh mesh = little_box();
  for (const auto& model : {springs_of(mesh), elastic_of(mesh)}) {
    auto x = test::sum(mesh.vertices, test::random_vectors(mesh.vertices.size(), 0.1, 3));
    std::vector<Vec3> f(x.size());
    ASSERT_TRUE(model->forces(x, {}, f));
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const double at = x[i][k], d = 1e-5;
        x[i][k] = at + d;
        const double up = model->energy(x);
        x[i][k] = at - d;
        const double down = model->energy(x);
        x[i][k] = at;
        EXPECT_NEAR(f[i][k], (down - up) / (2 * d), 1e-6 * (1 + norm(f[i])));
      }
    }
  }
}

TEST(ElasticModel, TheMatrixIsThatOfTheDerivatives) {
  // For stretched springs nothing is clamped.
  const TetMesh mesh = little_box();
  const auto model = springs_of(mesh);
  std::vector<Vec3> x = test::sum(mesh.vertices, test::random_vectors(mesh.vertices.size(), 0.01, 3)), up(x), down(x);
  for (Vec3& p : x) p *= 1.3;
  const Eigen::MatrixXd matrix = matrix_of(*model, x, 1);
  for (std::size_t c = 0; c < 3 * x.size(); ++c) {
    const double at = x[c / 3][c % 3], d = 1e-5;
    x[c / 3][c % 3] = at + d;
    model->forces(x, {}, up);
    x[c / 3][c % 3] = at - d;
    model->forces(x, {}, down);
    x[c / 3][c % 3] = at;
    for (std::size_t r = 0; r < 3 * x.size(); ++r) {
      const double slope = (down[r / 3][r % 3] - up[r / 3][r % 3]) / (2 * d);
      EXPECT_NEAR(matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)), slope, 1e-4);
    }
  }
}

TEST(ElasticModel, TheMatrixIsSymmetricAndSemidefiniteWhateverTheShape) {
  const TetMesh mesh = little_box();
  for (const double damping : {0.0, 0.01}) {
    for (const auto& model : {springs_of(mesh, damping), elastic_of(mesh, damping)}) {
      for (const double size : {0.0, 0.1, 0.5}) {  // the last with inverted tetrahedra
        auto x = test::sum(mesh.vertices, test::random_vectors(mesh.vertices.size(), size, 9));
        for (Vec3& p : x) p *= 0.7;  // compressed springs
        const Eigen::MatrixXd matrix = matrix_of(*model, x, 0.1);
        const double scale = matrix.norm();
        EXPECT_LT((matrix - matrix.transpose()).norm(), 1e-14 * scale);
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues();
        EXPECT_GT(values.minCoeff(), -1e-12 * scale);
        for (std::size_t i = 0; i < x.size(); ++i) {
          const SymmetricBlock block = model->diagonal(i);
          const auto r = static_cast<Eigen::Index>(3 * i);
          EXPECT_NEAR(block.xx, matrix(r, r), 1e-12 * scale);
          EXPECT_NEAR(block.xy, matrix(r, r + 1), 1e-12 * scale);
          EXPECT_NEAR(block.xz, matrix(r, r + 2), 1e-12 * scale);
          EXPECT_NEAR(block.yz, matrix(r + 1, r + 2), 1e-12 * scale);
        }
      }
    }
  }
}

TEST(ElasticModel, ConjugateGradientsSolveWhatDenseMatricesSolve) {
  const TetMesh mesh = little_box();
  const std::size_t n = mesh.vertices.size();
  const auto model = springs_of(mesh);
  const auto x = test::sum(mesh.vertices, test::random_vectors(n, 0.1, 9));
  const double h = 0.3;
  Eigen::MatrixXd matrix = matrix_of(*model, x, h);
  const std::vector<double> masses(n, 2);
  matrix += 2 * Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
  BlockSolver solver;
  solver.prepare(*model, masses);
  std::vector<VertexConstraint> constraints(n);
  constraints[1].kind = VertexConstraint::Kind::held;
  constraints[4] = {VertexConstraint::Kind::plane, normalized(Vec3{1, 2, 3})};
  const auto b = test::random_vectors(n, 1, 4);
  auto w = test::random_vectors(n, 1, 5);
  const auto given = w;
  const SolverReport report = solver.solve(constraints, b, 0, 0, 1e-13, 1000, w);
  EXPECT_TRUE(report.converged && report.finite);
  EXPECT_EQ(w[1], given[1]);
  EXPECT_NEAR(dot(w[4] - given[4], constraints[4].normal), 0, 1e-14);
  for (std::size_t i = 0; i < n; ++i) {
    Vec3 left = b[i];
    for (std::size_t c = 0; c < 3 * n; ++c) {
      for (std::size_t k = 0; k < 3; ++k) {
        left[k] -= matrix(static_cast<Eigen::Index>(3 * i + k), static_cast<Eigen::Index>(c)) * w[c / 3][c % 3];
      }
    }
    EXPECT_LT(norm(constraints[i].filter(left)), 1e-11);
  }
}

TEST(ElasticModel, ConjugateGradientsDoNotTakeInfinityForASolution) {
  const TetMesh mesh = little_box();
  const std::size_t n = mesh.vertices.size();
  const auto model = springs_of(mesh);
  matrix_of(*model, mesh.vertices, 0.3);
  const std::vector<double> masses(n, 2);
  BlockSolver solver;
  solver.prepare(*model, masses);
  std::vector<Vec3> w(n);
  const SolverReport report =
      solver.solve(std::vector<VertexConstraint>(n), std::vector<Vec3>(n, {1e300, 0, 0}), 0, 0, 1e-3, 1000, w);
  EXPECT_FALSE(report.converged || report.finite);
}

TEST(CorotationalModel, TurnedBodiesHaveNoForces) {
  const TetMesh mesh = little_box();
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 50; ++k) {
    const auto model = elastic_of(mesh);
    Turn q{normal(random), normal(random), normal(random), normal(random)};
    const double size = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    q = {q.w / size, q.x / size, q.y / size, q.z / size};
    const Matrix3 r = q.matrix();
    std::vector<Vec3> x, f(mesh.vertices.size());
    for (const Vec3& p : mesh.vertices) x.push_back(Vec3{5, 6, 7} + r.a * p.x + r.b * p.y + r.c * p.z);
    model->forces(x, {}, f);
    for (const Vec3& force : f) EXPECT_LT(norm(force), 1e-10);
    EXPECT_LT(model->energy(x), 1e-20);
  }
}

TEST(PolarRotation, IsTheNearestOneAndNeverAReflection) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  const auto any = [&] { return Vec3{normal(random), normal(random), normal(random)}; };
  for (int k = 0; k < 10000; ++k) {
    Matrix3 f{any(), any(), any()};
    if (k % 4 == 1) f.c = f.a * normal(random) + f.b * normal(random) + any() * 1e-7;     // nearly planar
    if (k % 4 == 2) f.b = f.a * normal(random) + any() * 1e-5, f.c = f.a + any() * 1e-6;  // nearly collinear
    if (k % 4 == 3) f.a *= -1;
    const Matrix3 r = nearest_turn(f, {}).matrix();
    ASSERT_NEAR(r.determinant(), 1, 1e-12) << k;
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(dense(f), Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d s = svd.singularValues();
    if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) s[2] = -s[2];
    const double trace = dot(r.a, f.a) + dot(r.b, f.b) + dot(r.c, f.c);
    ASSERT_NEAR(trace, s.sum(), 1e-9 * s[0]) << k;  // the largest of any rotation
  }
}

TEST(PolarRotation, LeavesHalfTurnsAndMirrors) {
  const Matrix3 half{{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
  const Matrix3 r = nearest_turn(half, {}).matrix();
  EXPECT_LT(norm(r.a - half.a) + norm(r.b - half.b) + norm(r.c - half.c), 1e-12);
  // Mirrored, stretches 3, 2 and −1: only the last changes sign.
  const Matrix3 s = nearest_turn({{3, 0, 0}, {0, 2, 0}, {0, 0, -1}}, {}).matrix();
  EXPECT_LT(norm(s.a - Vec3{1, 0, 0}) + norm(s.b - Vec3{0, 1, 0}), 1e-12);
  const Matrix3 none = nearest_turn({{}, {}, {}}, {}).matrix();
  EXPECT_EQ(none.a, (Vec3{1, 0, 0}));
}

}  // namespace
}  // namespace sansmesh::inline v1
