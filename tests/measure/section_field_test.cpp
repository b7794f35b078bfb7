#include <gtest/gtest.h>

#include <numbers>

#include "measure/measure_shapes.h"
#include "sansmesh/error.h"
#include "sansmesh/measure/section.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

using std::numbers::pi;

TEST(SectionField, VerticesLieOnTheZeroSet) {
  const test::TorusField torus;
  for (const CutPlane& plane : {axis_plane(2, 0.1), axis_plane(0, 0.2), cut_plane({1, 2, 3}, 0.3)}) {
    const Section s = section_field(torus, plane, {.resolution = 200, .box = {}});
    ASSERT_FALSE(s.curves.empty());
    EXPECT_TRUE(s.closed());
    for (const SectionCurve& c : s.curves) {
      std::vector<double> values(c.points.size());
      torus.evaluate(c.points, values);
      for (const double v : values) ASSERT_NEAR(v, 0, 1e-12);
      for (const Vec3& p : c.points) ASSERT_NEAR(plane.height(p), 0, 1e-12);
    }
  }
}

TEST(SectionField, AreaAndLengthConvergeWithTheSquareOfTheStep) {
  const test::SphereField sphere(1, {0.1, -0.2, 0.3});
  double last_area = 0, last_length = 0;
  for (int resolution = 25; resolution <= 400; resolution *= 2) {
    const Section s = section_field(sphere, cut_plane({2, 1, 2}, 0.9 + 0.6), {.resolution = resolution, .box = {}});
    ASSERT_EQ(s.curves.size(), 1u);
    // (2, 1, 2) / 3 · centre = 0.2: the plane at 0.5 passes the centre at 0.3.
    const double area = pi * 0.91 - s.area, length = 2 * pi * std::sqrt(0.91) - s.length;
    EXPECT_GT(area, 0);
    EXPECT_GT(length, 0);
    if (last_area > 0) {
      EXPECT_LT(area, 0.3 * last_area);
      EXPECT_LT(length, 0.3 * last_length);
    }
    last_area = area, last_length = length;
  }
  EXPECT_LT(last_area, 3e-5);
}

TEST(SectionField, AgreesWithTheMesh) {
  const Section field = section_field(test::TorusField(), axis_plane(2, 0.1));
  const Section mesh = section_mesh(test::torus_mesh(800, 400), axis_plane(2, 0.1));
  ASSERT_EQ(field.curves.size(), 2u);
  EXPECT_NEAR(field.area, mesh.area, 2e-4);
  EXPECT_NEAR(field.length, mesh.length, 2e-3);
}

TEST(SectionField, CurvesOpenWhereTheyLeaveTheBoxOrTheDomain) {
  const test::SphereField sphere(1);
  const Section cut = section_field(sphere, axis_plane(2, 0), {.resolution = 300, .box = Box3{{0, -2, -2}, {2, 2, 2}}});
  ASSERT_EQ(cut.curves.size(), 1u);
  EXPECT_FALSE(cut.closed());
  EXPECT_NEAR(cut.length, pi, 1e-3);
  EXPECT_NEAR(cut.curves[0].points.front().y, -1, 1e-4);

  class HalfSphere : public test::SphereField {
   public:
    HalfSphere() : SphereField(1) {}
    void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                            std::span<std::uint8_t> inside) const override {
      evaluate(x, values, gradients);
      for (std::size_t i = 0; i < x.size(); ++i) inside[i] = x[i].y > 0;
    }
  };
  const Section half = section_field(HalfSphere(), axis_plane(2, 0), {.resolution = 300, .box = {}});
  ASSERT_EQ(half.curves.size(), 1u);
  EXPECT_FALSE(half.closed());
  EXPECT_NEAR(half.length, pi, 0.03);
}

TEST(SectionField, PlanesThatMissOrOnlyTouch) {
  const test::SphereField sphere(1);
  EXPECT_TRUE(section_field(sphere, axis_plane(0, 5)).curves.empty());
  EXPECT_TRUE(section_field(sphere, axis_plane(0, 1.2)).curves.empty());
  EXPECT_TRUE(section_field(sphere, cut_plane({1, 1, 0}, 2.6)).curves.empty());
  EXPECT_THROW(section_field(sphere, axis_plane(0, 0), {.resolution = 1, .box = {}}), ArgumentError);
  EXPECT_TRUE(
      section_field(sphere, axis_plane(0, 0), {.resolution = 10, .box = Box3{{5, 5, 5}, {6, 6, 6}}}).curves.empty());
}

TEST(SectionField, ConvergesWithWrongGradients) {
  class Crooked : public test::SphereField {
   public:
    Crooked() : SphereField(1) {}
    void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
      SphereField::evaluate(x, values, gradients);
      for (double& v : values) v = std::copysign(std::sqrt(std::abs(v)), v);
      for (std::size_t i = 0; i < gradients.size(); ++i) gradients[i] = i % 2 ? Vec3{NAN, 0, 0} : Vec3{-1, 5, 2};
    }
  };
  const Section s = section_field(Crooked(), axis_plane(2, 0.3), {.resolution = 100, .box = {}});
  ASSERT_EQ(s.curves.size(), 1u);
  for (const Vec3& p : s.curves[0].points) EXPECT_NEAR(norm(p), 1, 1e-9);
}

TEST(SectionField, DoesNotDependOnTheNumberOfThreads) {
  const test::TorusField torus;
  test::compare_threads(
      [&] {
        return section_field(torus, cut_plane({1, 1, 1}, 0.1));
      },
      [](const Section& one, const Section& many) {
        ASSERT_EQ(one.curves.size(), many.curves.size());
        for (std::size_t c = 0; c < one.curves.size(); ++c) EXPECT_EQ(one.curves[c].plane, many.curves[c].plane);
      });
}

}  // namespace
}  // namespace sansmesh::inline v1
