#include "sansmesh/model/own_option.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "sansmesh/error.h"
#include "sansmesh/model/surface_method.h"
#include "sansmesh/model/surface_model.h"
#include "support/clouds.h"

namespace sansmesh::inline v1 {
namespace {

enum class Kernel { round, square };
constexpr std::string_view kKernels[] = {"round", "square"};

constexpr OwnOption<"plane_height", 0.5> kHeight({.text = "Distance of the plane from the origin",
                                                  .unit = "length",
                                                  .range = {-10, 10}});
constexpr OwnOption<"plane_rounds", 3> kRounds({.text = "Rounds", .range = {1, 9}});
constexpr OwnOption<"plane_flat", false> kFlat({.text = "Whether it is flat"});
constexpr OwnOption<"plane_kernel", Kernel::round> kKernel({.text = "Its weights", .choices = kKernels});
constexpr OptionRow kOwn[] = {kHeight, kRounds, kFlat, kKernel};

/// Option value of the last call that made the surface.
double height_seen = 0;

class Plane : public ScalarField {
 public:
  Box3 bounds() const override { return {{-2, -2, -2}, {2, 2, 2}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
    for (std::size_t i = 0; i < x.size(); ++i) values[i] = x[i].z;
    for (Vec3& g : gradients) g = {0, 0, 1};
  }
};

SurfaceParts make_plane(PreparedCloud& cloud, const SurfaceOptions& options, Progress&) {
  height_seen = kHeight.of(options);
  SurfaceParts parts;
  parts.field = std::make_shared<const Plane>();
  parts.support.centers = cloud.points.positions;
  parts.support.radii.assign(cloud.points.size(), 0.1f);
  return parts;
}

const Registered<SurfaceMethod> plane(
    {.name = "plane", .summary = "a plane", .page = "implicit-surfaces.md", .make = make_plane, .own = kOwn});

std::string error_of(const SurfaceOptions& options) {
  try {
    options.validate();
  } catch (const ArgumentError& error) {
    return error.what();
  }
  return "";
}

TEST(OwnOption, IsKeptUnderItsNameAndReadAsWhatItIs) {
  SurfaceOptions o{.method = "plane"};
  EXPECT_EQ(kHeight.of(o), 0.5);
  EXPECT_EQ(kRounds.of(o), 3);
  EXPECT_FALSE(kFlat.of(o));
  EXPECT_EQ(kKernel.of(o), Kernel::round);
  for_each_option(SurfaceOptions::schema(), &o, [&](const OptionRow& row, void* owner) {
    if (row.name == "plane_height") set_option(row, owner, std::int64_t{2});
    if (row.name == "plane_kernel") set_option(row, owner, std::string("square"));
  });
  EXPECT_EQ(o.own.size(), 2u);
  EXPECT_EQ(kHeight.of(o), 2);
  EXPECT_EQ(kKernel.of(o), Kernel::square);
  EXPECT_EQ(options_set(o), (std::vector<std::string_view>{"method", "plane_height", "plane_kernel"}));
  // Values as a program sets them.
  o.own = {{"plane_height", std::int64_t{3}}, {"plane_flat", true}, {"plane_kernel", std::string("square")}};
  EXPECT_EQ(error_of(o), "");
  EXPECT_EQ(kHeight.of(o), 3);
  EXPECT_TRUE(kFlat.of(o));
  EXPECT_EQ(kKernel.of(o), Kernel::square);
}

TEST(OwnOption, IsCheckedAsItsRowSaysAndHeededByItsSurfaceAlone) {
  EXPECT_EQ(error_of({.method = "plane", .own = {{"plane_rounds", std::int64_t{10}}}}),
            "`plane_rounds` must be from 1 to 9, not 10");
  EXPECT_EQ(error_of({.method = "plane", .own = {{"plane_rounds", 2.5}}}),
            "`plane_rounds` must be a whole number, not 2.5");
  EXPECT_EQ(error_of({.method = "plane", .own = {{"plane_kernel", std::string("oval")}}}),
            "`plane_kernel` must be one of round, square, not 'oval'");
  EXPECT_EQ(error_of({.method = "plane", .own = {{"plane_kernel", 0.5}}}), "`plane_kernel` must be a word, not 0.5");
  EXPECT_EQ(error_of({.method = "apss", .own = {{"plane_rounds", std::int64_t{4}}}}),
            "`plane_rounds` belongs to plane, not to the surface apss");
  EXPECT_EQ(error_of({.method = "plane", .own = {{"plane_hight", 1.0}}}),
            "no surface method has an option `plane_hight` of its own");
  EXPECT_EQ(error_of({.method = "plane", .own = {{"sharp", true}}}),
            "no surface method has an option `sharp` of its own");
}

/// Lengths are given in the unit of the input; the surface receives them in the coordinates of the cloud.
TEST(OwnOption, LengthsFollowTheCloud) {
  PointSet cloud = test::sphere(500);
  for (Vec3f& p : cloud.positions) p = p * 8.0f;
  Progress progress;
  const SurfaceModel model = make_surface_model(cloud, {.method = "plane", .own = {{"plane_height", 4.0}}}, progress);
  EXPECT_NEAR(height_seen, model.frame().from_input(4.0), 1e-12);
  EXPECT_LT(height_seen, 2);
}

}  // namespace
}  // namespace sansmesh::inline v1
