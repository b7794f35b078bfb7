#include "sansmesh/surface/bilateral_normals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sansmesh/error.h"
#include "sansmesh/surface/implicit_surface.h"
#include "support/clouds.h"

namespace sansmesh::inline v1 {
namespace {

double degrees(const Vec3& a, const Vec3& b) {
  return std::acos(std::min(1.0, std::abs(dot(normalized(a), normalized(b))))) * 57.29578;
}

TEST(BilateralNormals, BecomeThoseOfTheFacesOfACube) {
  const PointSet cloud = test::cube(12000);
  Progress progress;
  const ImplicitSurface field = make_implicit_surface(prepare_samples(cloud, progress), {}, progress);
  const BilateralNormals normals(field.samples(), {});
  // Points on two faces, at least 0.4 spacings off their common edge.
  std::vector<Vec3> x;
  std::vector<Vec3> truth;
  const double spacing = field.report().spacing;
  for (double y = -0.8; y <= 0.8; y += 0.01)
    for (const double off : {0.4, 0.7, 1.0, 1.5}) {
      x.push_back({1, y, 1 - off * spacing}), truth.push_back({1, 0, 0});
      x.push_back({1 - off * spacing, y, 1}), truth.push_back({0, 0, 1});
    }
  std::vector<double> values(x.size());
  std::vector<Vec3> smooth(x.size()), sharpened(x.size());
  field.evaluate(x, values, smooth);
  sharpened = smooth;
  normals.refine(x, sharpened);
  std::size_t wrong_before = 0, wrong_after = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    wrong_before += degrees(smooth[i], truth[i]) > 3;
    wrong_after += degrees(sharpened[i], truth[i]) > 3;
  }
  EXPECT_GT(wrong_before, x.size() / 3);
  EXPECT_LT(wrong_after, x.size() / 50);
}

TEST(BilateralNormals, LeaveSmoothSurfacesAlone) {
  const PointSet cloud = test::torus(20000);
  Progress progress;
  const ImplicitSurface field = make_implicit_surface(prepare_samples(cloud, progress), {}, progress);
  const BilateralNormals normals(field.samples(), {});
  std::vector<Vec3> x(cloud.positions.begin(), cloud.positions.end()), a(x.size()), b(x.size());
  std::vector<double> values(x.size());
  field.evaluate(x, values, a);
  b = a;
  normals.refine(x, b);
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += degrees(a[i], b[i]);
  EXPECT_LT(sum / static_cast<double>(x.size()), 1.0);
}

TEST(FaceField, IsTheHeightOverTheFaceNextToAnEdge) {
  const PointSet cloud = test::cube(12000);
  Progress progress;
  const ImplicitSurface field = make_implicit_surface(prepare_samples(cloud, progress), {}, progress);
  const BilateralNormals normals(field.samples(), {});
  const FaceField faces(field, normals);
  const double spacing = field.report().spacing;
  // Points just inside two faces, next to their common edge, where the field rounds it off.
  std::vector<Vec3> x;
  for (double y = -0.8; y <= 0.8; y += 0.01) {
    x.push_back({1 - 0.1 * spacing, y, 1 - 0.6 * spacing});
    x.push_back({1 - 0.6 * spacing, y, 1 - 0.1 * spacing});
  }
  std::vector<double> rounded(x.size()), sharp(x.size());
  field.evaluate(x, rounded);
  faces.evaluate(x, sharp);
  double rounded_error = 0, sharp_error = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    rounded_error += std::abs(rounded[i] + 0.1 * spacing);
    sharp_error += std::abs(sharp[i] + 0.1 * spacing);
  }
  EXPECT_LT(sharp_error, 0.3 * rounded_error);
}

TEST(BilateralNormals, RefuseBadOptions) {
  EXPECT_THROW(BilateralOptions{.height = 0}.validate(), ArgumentError);
  EXPECT_THROW(BilateralOptions{.iterations = -1}.validate(), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
