#include "sansmesh/dataset/isosurface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/dataset/isosurface_in_time.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/error.h"
#include "sansmesh/field/level_field.h"
#include "sansmesh/field/scaled_volume.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "sansmesh/volume/grid/assemble_volume.h"
#include "support/any_threads.h"
#include "support/sanitizers.h"
#include "volume/volume_grids.h"

namespace sansmesh::inline v1 {
namespace {

constexpr Vec3 kCenter{0.52, 0.5, 0.47};

/// Larger towards the centre: {f > 0.7} is the ball of radius 0.3.
double cone(const Vec3& x) { return 1 - norm(x - kCenter); }

std::shared_ptr<const Isosurface> surface_in(GridData data, double value, const std::string& method = "linear") {
  VolumeDataset dataset(std::move(data));
  Progress progress;
  VolumeReconstructionOptions options;
  options.method = method;
  const auto volume = dataset.volume("f", progress);
  const auto field = dataset.field({"f", {}, false}, options, progress);
  const auto& values = *volume->attributes.find<double>("f");
  return std::make_shared<const Isosurface>(
      volume, field, [&](std::size_t i) { return values[i]; }, value);
}

TriangleMesh mesh_of(const Isosurface& surface, const IsosurfaceOptions& options, IsosurfaceReport& report) {
  Progress progress;
  return mesh_isosurface(surface, options, progress, &report);
}

double largest_error(const TriangleMesh& mesh, double radius) {
  double error = 0;
  for (const Vec3f& v : mesh.vertices)
    error = std::max(error, std::abs(norm(mesh.origin + Vec3(v) - kCenter) - radius));
  return error;
}

struct NamedGrid {
  const char* name;
  GridData data;
};

std::vector<NamedGrid> grids_of_the_cube() {
  std::vector<NamedGrid> grids;
  grids.push_back({"lattice", test::lattice_grid({33, 33, 33}, cone)});
  grids.push_back({"stretched", test::stretched_grid({33, 33, 33}, cone, 1.05)});
  grids.push_back({"tetrahedra", test::tetrahedra_grid({25, 25, 25}, cone)});
  grids.push_back({"mixed", test::mixed_grid({22, 22, 22}, cone)});
  return grids;
}

TEST(Isosurface, OfABallIsAClosedSphereOnEveryGrid) {
  for (NamedGrid& grid : grids_of_the_cube()) {
    SCOPED_TRACE(grid.name);
    IsosurfaceReport report;
    const auto surface = surface_in(std::move(grid.data), 0.7);
    const TriangleMesh mesh = mesh_of(*surface, {}, report);
    EXPECT_TRUE(report.closed);
    EXPECT_EQ(report.components, 1u);
    const double volume = 4.0 / 3 * std::numbers::pi * 0.027;
    ASSERT_TRUE(report.volume);
    EXPECT_NEAR(*report.volume, volume, 0.02 * volume);  // positive: faces outward
    EXPECT_LT(largest_error(mesh, 0.3), 0.004);
  }
}

/// {f > value} below a plane that crosses the whole cube.
TEST(Isosurface, EndsAtTheBoundaryOfTheVolume) {
  const auto height = [](const Vec3& x) { return 0.4 - x.z; };
  for (const bool tetrahedra : {false, true}) {
    const auto surface = surface_in(
        tetrahedra ? test::tetrahedra_grid({17, 17, 17}, height) : test::lattice_grid({17, 17, 17}, height), 0);
    IsosurfaceReport report;
    const TriangleMesh open = mesh_of(*surface, {}, report);
    EXPECT_FALSE(report.closed);
    EXPECT_NEAR(report.area, 1, 0.02);
    for (const Vec3f& v : open.vertices) {
      const Vec3 x = open.origin + Vec3(v);
      EXPECT_NEAR(x.z, 0.4, 1e-5);
      EXPECT_TRUE(x.x > -0.01 && x.x < 1.01 && x.y > -0.01 && x.y < 1.01);
    }
    IsosurfaceOptions options;
    options.closed = true;
    const TriangleMesh closed = mesh_of(*surface, options, report);
    EXPECT_TRUE(report.closed);
    EXPECT_NEAR(*report.volume, 0.4, 0.004);
  }
}

TEST(Isosurface, IsEmptyInHolesOfTheVolume) {
  // A ring: the part of a lattice of hexahedra between two cylinders, cut by a plane through its axis.
  GridBlock ring = test::lattice_block({33, 5, 9}, {0, 0.5, 0}, {2 * std::numbers::pi, 1, 0.5});
  ring = test::curvilinear_block(ring, [](const Vec3& x) {
    return Vec3{x.y * std::cos(x.x), x.y * std::sin(x.x), x.z};
  });
  const auto surface = surface_in(test::one_block(std::move(ring), [](const Vec3& x) { return x.y + 0.01; }), 0);
  IsosurfaceReport report;
  const TriangleMesh mesh = mesh_of(*surface, {}, report);
  EXPECT_EQ(report.components, 2u);
  for (const Vec3f& v : mesh.vertices) {
    const Vec3 x = mesh.origin + Vec3(v);
    EXPECT_GT(std::hypot(x.x, x.y), 0.48);
  }
  EXPECT_NEAR(report.area, 2 * 0.5 * 0.5, 0.03);
}

TEST(Isosurface, ErrorsNameTheRangeOfValues) {
  try {
    surface_in(test::lattice_grid({9, 9, 9}, cone), 7);
    FAIL() << "there is no such surface";
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("between"), std::string::npos) << error.what();
  }
}

TEST(Isosurface, CombinesWithOtherSolids) {
  SANSMESH_NOT_SANITIZED("others make isosurfaces and solids, too");
  const auto surface = surface_in(test::tetrahedra_grid({25, 25, 25}, cone), 0.7);
  const Solid ball = isosurface_solid(surface);
  Progress progress;
  CsgMeshReport report;
  mesh_csg(csg::subtract(ball, csg::half_space({0, 0, 1}, kCenter.z)), {}, progress, &report);
  EXPECT_TRUE(report.closed);
  const double half = 2.0 / 3 * std::numbers::pi * 0.027;
  EXPECT_NEAR(report.volume, half, 0.02 * half);
}

TEST(Isosurface, DoesNotDependOnThreads) {
  const auto surface = surface_in(test::tetrahedra_grid({17, 17, 17}, cone), 0.7);
  test::expect_equal_for_any_threads([&] {
    IsosurfaceReport report;
    return mesh_of(*surface, {}, report).vertices;
  });
}

/// A front at x = ½ a hundredth wide, which is linear as a function for level sets.
class SteepFront final : public VolumeField, public LevelField {
 public:
  Box3 bounds() const override { return {{0, 0, 0}, {1, 1, 1}}; }
  std::size_t components() const override { return 1; }
  void spacing(std::span<const Vec3>, std::span<double> found) const override {
    std::fill(found.begin(), found.end(), 0.1);
  }
  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const override {
    each(x, wanted, [](double d) { return std::tanh(d); });
  }
  void evaluate_level(double level, std::span<const Vec3> x, const VolumeFieldValues& wanted) const override {
    each(x, wanted, [&](double d) { return d + level - std::atanh(level); });
  }

 private:
  template <class F>
  static void each(std::span<const Vec3> x, const VolumeFieldValues& wanted, const F& f) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double d = 100 * (x[i].x - 0.5), h = 1e-4;
      if (!wanted.values.empty()) wanted.values[i] = f(d);
      if (!wanted.gradients.empty()) wanted.gradients[i] = {100 * (f(d + h) - f(d - h)) / (2 * h), 0, 0};
      if (!wanted.inside.empty()) wanted.inside[i] = 1;
    }
  }
};

TEST(LevelFields, KeepTheirFunctionWhenScaled) {
  const auto front = std::make_shared<const SteepFront>();
  const double factor = 0x1p60;
  const std::unique_ptr<VolumeField> scaled = ScaledVolume::of(front, {factor});
  const auto* const levels = dynamic_cast<const LevelField*>(scaled.get());
  ASSERT_NE(levels, nullptr);
  const std::vector<Vec3> x{{0.2, 0, 0}, {0.5, 0, 0}, {0.9, 0, 0}};
  std::vector<double> values(3), expected(3);
  std::vector<Vec3> slopes(3), expected_slopes(3);
  levels->evaluate_level(0.5 * factor, x, {values, slopes});
  front->evaluate_level(0.5, x, {expected, expected_slopes});
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(values[i] / factor, expected[i], 1e-12);
    EXPECT_NEAR(slopes[i].x / factor, expected_slopes[i].x, 1e-9);
  }
}

TEST(LevelFields, GuideSurfacesThatMove) {
  Progress progress;
  const auto volume = std::make_shared<const SampledVolume>(
      assemble_volume(test::lattice_grid({11, 11, 11}, [](const Vec3& x) { return std::tanh(100 * (x.x - 0.5)); }),
                      Association::points, progress));
  const auto front = std::make_shared<const SteepFront>();
  const auto of_sample = [&](std::size_t i) { return std::tanh(100 * (volume->position(i).x - 0.5)); };
  const IsosurfaceInTime moving({{0, volume, front, of_sample}, {1, volume, front, of_sample}}, 0.25);
  std::vector<Vec3> x;
  for (const double at : {0.3, 0.4}) x.push_back(moving.frame().from_input(Vec3{at, 0.5, 0.5}));
  const std::vector<double> t{0.3, 0.3};
  std::vector<double> values(2);
  moving.evaluate(x, t, values);
  // Without the function for levels both values are equal: the front is flat on both sides.
  EXPECT_NEAR(values[0] - values[1], norm(x[0] - x[1]), 1e-3 * norm(x[0] - x[1]));
}

TEST(ValueRanges, BoundTheValuesOfNearbyCells) {
  const auto wave = [](const Vec3& x) { return std::sin(9 * x.x) * std::cos(7 * x.y) + x.z * x.z; };
  std::vector<NamedGrid> grids;
  grids.push_back({"stretched", test::stretched_grid({19, 18, 17}, wave)});
  grids.push_back({"bent", test::bent_grid({13, 12, 11}, wave)});
  grids.push_back({"tetrahedra", test::tetrahedra_grid({9, 9, 9}, wave)});
  for (NamedGrid& grid : grids) {
    SCOPED_TRACE(grid.name);
    VolumeDataset dataset(std::move(grid.data));
    Progress progress;
    const auto volume = dataset.volume("f", progress);
    const auto& values = *volume->attributes.find<double>("f");
    const Box3 box = volume->bounds();
    const LocalFrame frame = frame_for(box.center(), box.diagonal());
    const ValueRanges ranges(
        *volume, [&](std::size_t i) { return values[i]; }, frame);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int trial = 0; trial < 200; ++trial) {
      const Vec3 x =
          box.lower + Vec3{unit(random) * box.size().x, unit(random) * box.size().y, unit(random) * box.size().z};
      const double radius = 0.3 * unit(random) * unit(random);
      const ValueRange found = ranges.around(frame.from_input(x), frame.from_input(radius));
      for (std::size_t i = 0; i < volume->size(); ++i) {
        if (norm(volume->position(i) - x) > radius) continue;
        EXPECT_LE(found.least, values[i]);
        EXPECT_GE(found.most, values[i]);
      }
    }
    EXPECT_TRUE(ranges.points_with(100).empty());
    EXPECT_FALSE(ranges.points_with(0.5).empty());
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
