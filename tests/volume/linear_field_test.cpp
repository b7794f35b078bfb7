#include <cmath>
#include <limits>

#include "sansmesh/error.h"
#include "support/any_threads.h"
#include "volume/volume_checks.h"

namespace sansmesh::test {
namespace {

TEST(LinearField, ReproducesLinearFunctionsOnEveryGrid) {
  for (const NamedGrid& grid : all_grids(linear_function)) {
    SCOPED_TRACE(grid.name);
    const auto volume = volume_of(grid.data, grid.association);
    const auto field = field_of(volume, "linear");
    const auto x = points_within(*volume, 500);
    std::vector<double> values(x.size());
    std::vector<Vec3> gradients(x.size());
    std::vector<std::uint8_t> inside(x.size());
    field->evaluate(x, {values, gradients, inside});
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_NEAR(values[i], linear_function(x[i]), 1e-9) << i;
      ASSERT_NEAR(norm(gradients[i] - kLinearGradient), 0, 1e-6) << i;
      ASSERT_EQ(inside[i], 1) << i;
    }
  }
}

TEST(LinearField, IsFiniteEverywhereAndZeroAtNonFinitePoints) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), huge = 1e300;
  const std::vector<Vec3> x{{nan, 0, 0}, {0, 1.0 / 0.0, 0}, {huge, -huge, huge}, {50, 60, 70}, {-0.01, 0.5, 0.5}};
  for (const NamedGrid& grid : all_grids(linear_function))
    for (const auto method : {"linear", "nearest"}) {
      SCOPED_TRACE(grid.name);
      const auto field = field_of(volume_of(grid.data, grid.association), method);
      std::vector<double> values(x.size(), 7), spacings(x.size());
      std::vector<Vec3> gradients(x.size());
      std::vector<std::uint8_t> inside(x.size(), 9);
      field->evaluate(x, {values, gradients, inside});
      field->spacing(x, spacings);
      for (std::size_t i = 0; i < x.size(); ++i) {
        EXPECT_TRUE(std::isfinite(values[i]) && is_finite(gradients[i])) << i;
        EXPECT_GT(spacings[i], 0) << i;
        if (i < 4) EXPECT_EQ(inside[i], 0) << i;
      }
      EXPECT_EQ(values[0], 0);
      EXPECT_EQ(values[1], 0);
    }
}

TEST(LinearField, IsContinuousAcrossPlaneFaces) {
  // Rough values reveal discontinuities.
  const auto rough = [](const Vec3& x) { return std::sin(1e4 * x.x) + std::cos(3e4 * x.y) * std::sin(2e4 * x.z); };
  for (const auto& [name, data] :
       {std::pair{"tetrahedra", tetrahedra_grid({5, 5, 5}, rough)}, std::pair{"mixed", mixed_grid({7, 4, 4}, rough)}})
    for (const Association a : {Association::points, Association::cells}) {
      SCOPED_TRACE(name);
      const auto volume = volume_of(data, a);
      const auto field = field_of(volume, "linear");
      std::vector<Vec3> x;
      for (std::size_t c = 0; c < volume->cells.size(); c += 3)
        for (const CellFace& face : cell_faces(volume->cells.shapes[c])) {
          Vec3 middle, away;
          for (std::size_t k = 0; k < face.count; ++k)
            middle += volume->corner(volume->cells[c][face.corner[k]]) * ((k == 0 ? 1.5 : 1.0) / (face.count + 0.5));
          for (const std::uint32_t p : volume->cells[c])
            away += (middle - volume->corner(p)) / static_cast<double>(volume->cells[c].size());
          x.push_back(middle + away * 1e-8);
          x.push_back(middle - away * 1e-8);
        }
      std::vector<double> values(x.size());
      field->evaluate(x, {values});
      for (std::size_t i = 0; i < x.size(); i += 2) ASSERT_NEAR(values[i], values[i + 1], 1e-5) << i;
    }
}

TEST(LinearField, StaysWithinTheRangeOfSamplesAtCorners) {
  const auto step = [](const Vec3& x) { return x.x + 0.3 * x.y > 0.6 ? 1.0 : 0.0; };
  for (const NamedGrid& grid : all_grids(step)) {
    if (grid.association == Association::cells) continue;
    SCOPED_TRACE(grid.name);
    const auto volume = volume_of(grid.data);
    if (!volume->higher.empty()) continue;  // quadratic functions leave it
    const auto x = points_within(*volume, 1000);
    std::vector<double> values(x.size());
    field_of(volume, "linear")->evaluate(x, {values});
    for (const double v : values) ASSERT_TRUE(v >= -1e-9 && v <= 1 + 1e-9) << v;
  }
}

TEST(LinearField, AnswersDependOnThePointAlone) {
  const auto volume = volume_of(o_grid({17, 5, 6}, linear_function));
  const auto field = field_of(volume, "linear");
  const auto x = points_within(*volume, 5000);
  const auto all = [&] {
    std::vector<double> values(x.size());
    field->evaluate(x, {values});
    return values;
  };
  expect_equal_for_any_threads(all);
  const auto together = all();
  for (std::size_t i = 0; i < x.size(); i += 97) {
    double alone = 0;
    field->evaluate({&x[i], 1}, {{&alone, 1}});
    EXPECT_EQ(alone, together[i]);
  }
}

TEST(NearestField, AnswersTheNearestSample) {
  for (const NamedGrid& grid : all_grids(linear_function)) {
    SCOPED_TRACE(grid.name);
    const auto volume = volume_of(grid.data, grid.association);
    const auto field = field_of(volume, "nearest");
    const auto x = points_within(*volume, 100);
    std::vector<double> values(x.size());
    field->evaluate(x, {values});
    for (std::size_t i = 0; i < x.size(); ++i) {
      double least = std::numeric_limits<double>::infinity(), value = 0;
      for (std::size_t s = 0; s < volume->size(); ++s)
        if (const double d = squared_norm(volume->position(s) - x[i]); d < least)
          least = d, value = volume->attributes.find("f")->number(s);
      ASSERT_EQ(values[i], value) << i;
    }
  }
}

TEST(Reconstruction, ErrorsNameTheCause) {
  const auto volume = volume_of(lattice_grid({3, 3, 3}, linear_function));
  Progress progress;
  EXPECT_THROW(volume_method("cubist"), ArgumentError);
  EXPECT_EQ(volume_method("linear").name, "linear");
  VolumeReconstructionOptions options;
  options.method = "linear";
  try {
    reconstruct_volume(volume, "g", options, progress);
    FAIL();
  } catch (const ArgumentError& e) {
    EXPECT_NE(std::string(e.what()).find('f'), std::string::npos);
  }
  options.degree = 2;
  EXPECT_THROW(reconstruct_volume(volume, "f", options, progress), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::test
