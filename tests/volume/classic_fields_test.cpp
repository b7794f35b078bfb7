// Common properties of point-wise reconstructions, and the guarantees of each method.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "sansmesh/error.h"
#include "sansmesh/volume/cells/cell_tetrahedra.h"
#include "support/any_threads.h"
#include "support/sanitizers.h"
#include "volume/volume_checks.h"

namespace sansmesh::test {
namespace {

using Method = std::string;  // name of a method

const Method kOnAllGrids[] = {"shepard", "sibson", "mean-value", "rbf", "bernstein"};
const Method kOnLattices[] = {"cubic", "lagrange"};

double smooth(const Vec3& x) { return std::sin(2 * x.x + 0.3) * std::cos(1.7 * x.y) + std::exp(-x.z) * x.x; }

bool suits(const Method& method, const SampledVolume& volume) {
  if (method == "sinc") return volume.lattice && volume.lattice->uniform;
  if (method == "cubic" || method == "lagrange") return volume.lattice.has_value();
  return true;
}

/// Calls visit(volume, field, name) for each grid and each method that supports it.
template <class Visit>
void for_each_field(const VolumeFunction& f, std::span<const Method> methods, const Visit& visit) {
  for (const NamedGrid& grid : all_grids(f)) {
    const auto volume = volume_of(grid.data, grid.association);
    for (const Method& method : methods)
      if (suits(method, *volume)) {
        const std::string name = method + ", " + grid.name;
        SCOPED_TRACE(name);
        visit(*volume, *field_of(volume, method), method);
      }
  }
}

std::vector<Method> all_of_them() {
  std::vector<Method> all(std::begin(kOnAllGrids), std::end(kOnAllGrids));
  all.insert(all.end(), std::begin(kOnLattices), std::end(kOnLattices));
  all.push_back("sinc");
  return all;
}

TEST(ClassicFields, ReproduceConstants) {
  for_each_field([](const Vec3&) { return 3.25; }, all_of_them(),
                 [](const SampledVolume& volume, const VolumeField& field, const Method&) {
                   const auto x = points_within(volume, 60);
                   std::vector<double> values(x.size());
                   std::vector<Vec3> gradients(x.size());
                   std::vector<std::uint8_t> inside(x.size());
                   field.evaluate(x, {values, gradients, inside});
                   for (std::size_t i = 0; i < x.size(); ++i) {
                     ASSERT_NEAR(values[i], 3.25, 1e-9) << i;
                     ASSERT_NEAR(norm(gradients[i]), 0, 1e-6) << i;
                     ASSERT_EQ(inside[i], 1) << i;
                   }
                 });
}

TEST(ClassicFields, ReproduceStraightFunctions) {
  for_each_field(linear_function, std::vector<Method>{"mean-value", "rbf", "bernstein", "cubic", "lagrange"},
                 [](const SampledVolume& volume, const VolumeField& field, const Method&) {
                   const auto x = points_within(volume, 100);
                   std::vector<double> values(x.size());
                   std::vector<Vec3> gradients(x.size());
                   field.evaluate(x, {values, gradients});
                   for (std::size_t i = 0; i < x.size(); ++i) {
                     ASSERT_NEAR(values[i], linear_function(x[i]), 1e-6) << i;
                     ASSERT_NEAR(norm(gradients[i] - kLinearGradient), 0, 1e-4) << i;
                   }
                 });
}

// Natural neighbours reproduce them inside the convex hull of the samples, except for rounding near its surface.
TEST(ClassicFields, NaturalNeighboursReproduceStraightFunctions) {
  for (const GridData& data : {lattice_grid({6, 5, 7}, linear_function), stretched_grid({7, 6, 5}, linear_function),
                               tetrahedra_grid({5, 4, 6}, linear_function), scattered_grid(300, linear_function)}) {
    const auto volume = volume_of(data);
    const auto field = field_of(volume, "sibson");
    auto x = points_within(*volume, 400);
    std::erase_if(x, [](const Vec3& p) { return std::min({p.x, p.y, p.z, 1 - p.x, 1 - p.y, 1 - p.z}) < 0.1; });
    ASSERT_GT(x.size(), 30u);
    for (const std::uint32_t s : {7u, 11u, 60u}) x.push_back(volume->position(s));  // and at samples
    std::vector<double> values(x.size());
    std::vector<Vec3> gradients(x.size());
    field->evaluate(x, {values, gradients});
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_NEAR(values[i], linear_function(x[i]), 2e-3) << i;
      if (i + 3 < x.size()) ASSERT_NEAR(norm(gradients[i] - kLinearGradient), 0, 0.02) << i;
    }
  }
}

TEST(ClassicFields, InterpolateTheirSamples) {
  for_each_field(smooth, all_of_them(),
                 [](const SampledVolume& volume, const VolumeField& field, const Method& method) {
                   const bool at_corners = method == "mean-value" || method == "bernstein";
                   // Means of nearby values; cells with corners do not include the samples on the faces of coarser
                   // cells.
                   if (at_corners && (!volume.cell_sample.empty() || volume.facts.blocks > 1)) return;
                   std::vector<Vec3> x;
                   std::vector<double> f;
                   const Attribute& array = *volume.attributes.find("f");
                   for (std::size_t s = 0; s < volume.size(); s += 3)
                     x.push_back(volume.position(s)), f.push_back(array.number(s));
                   std::vector<double> values(x.size());
                   std::vector<Vec3> gradients(x.size());
                   field.evaluate(x, {values, gradients});
                   for (std::size_t i = 0; i < x.size(); ++i) {
                     ASSERT_NEAR(values[i], f[i], 1e-6) << i;
                     ASSERT_TRUE(is_finite(gradients[i])) << i;
                   }
                 });
}

TEST(ClassicFields, GradientsAreDerivativesOfTheValues) {
  for_each_field(smooth, all_of_them(),
                 [](const SampledVolume& volume, const VolumeField& field, const Method& method) {
                   const auto x = points_within(volume, 40);
                   const double h = 1e-6;
                   std::vector<Vec3> shifted;
                   for (const Vec3& p : x)
                     for (std::size_t k = 0; k < 3; ++k)
                       for (const double side : {-h, h}) {
                         shifted.push_back(p);
                         shifted.back()[k] += side;
                       }
                   std::vector<double> values(x.size()), around(shifted.size());
                   std::vector<Vec3> gradients(x.size());
                   field.evaluate(x, {values, gradients});
                   field.evaluate(shifted, {around});
                   std::size_t wrong = 0;
                   for (std::size_t i = 0; i < x.size(); ++i) {
                     Vec3 difference;
                     for (std::size_t k = 0; k < 3; ++k)
                       difference[k] = (around[6 * i + 2 * k + 1] - around[6 * i + 2 * k]) / (2 * h);
                     if (!(norm(gradients[i] - difference) < 1e-3 * (1 + norm(difference)))) ++wrong;
                   }
                   // Fields that are only continuous may have a kink within h of a point.
                   const bool kinks = method == "mean-value" || method == "bernstein" || method == "lagrange";
                   EXPECT_LE(wrong, kinks || volume.in_cells ? 1u : 0u);
                 });
}

TEST(ClassicFields, AreContinuousAcrossFaces) {
  for (const GridData& data : {bent_grid({5, 4, 5}, smooth), mixed_grid({7, 4, 4}, smooth), o_grid({13, 4, 4}, smooth),
                               scattered_grid(200, smooth)}) {
    const auto volume = volume_of(data);
    std::vector<Vec3> x;  // pairs on both sides of the triangles of faces
    std::vector<std::array<std::uint8_t, 3>> triangles;
    for (std::size_t c = 0; c < volume->cells.size(); c += 3) {
      const auto cell = volume->cells[c];
      triangles.clear();
      detail::face_triangles(volume->cells.shapes[c], cell, triangles);
      for (const auto& t : triangles) {
        const Vec3 a = volume->corner(cell[t[0]]), b = volume->corner(cell[t[1]]), d = volume->corner(cell[t[2]]);
        const Vec3 at = a * 0.2 + b * 0.35 + d * 0.45, across = normalized(cross(b - a, d - a)) * 3e-8;
        x.push_back(at - across);
        x.push_back(at + across);
      }
    }
    for (const Method& method : kOnAllGrids) {
      SCOPED_TRACE(method);
      std::vector<double> values(x.size());
      std::vector<std::uint8_t> inside(x.size());
      field_of(volume, method)->evaluate(x, {values, {}, inside});
      for (std::size_t i = 0; i < x.size(); i += 2)
        if (inside[i] && inside[i + 1]) ASSERT_NEAR(values[i], values[i + 1], 2e-5) << i;
    }
  }
}

TEST(ClassicFields, AreFiniteEverywhereAndContinueALittle) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  const std::vector<Vec3> x{{nan, 0, 0}, {0, infinite, 0}, {1e300, -1e300, 1e300}, {50, 60, 70}, {-0.01, 0.5, 0.5}};
  for_each_field(smooth, all_of_them(), [&](const SampledVolume& volume, const VolumeField& field, const Method&) {
    std::vector<double> values(x.size(), 7), spacings(x.size());
    std::vector<Vec3> gradients(x.size(), {7, 7, 7});
    std::vector<std::uint8_t> inside(x.size(), 7);
    field.evaluate(x, {values, gradients, inside});
    field.spacing(x, spacings);
    for (std::size_t i = 0; i < x.size(); ++i) {
      EXPECT_TRUE(std::isfinite(values[i]) && is_finite(gradients[i])) << i;
      EXPECT_LT(std::abs(values[i]), 100) << i;
      EXPECT_GT(spacings[i], 0) << i;
      if (i < 4) EXPECT_EQ(inside[i], 0) << i;
    }
    EXPECT_EQ(values[0], 0);
    EXPECT_EQ(values[1], 0);
    // All corners and samples, where local systems and cells degenerate; under sanitizers a subset.
    const std::size_t every = test::kAddressSanitizer ? 7 : 1;
    std::vector<Vec3> places;
    for (std::size_t c = 0; c < volume.corners.size(); c += every) places.push_back(volume.corners[c]);
    for (std::size_t s = 0; s < volume.size(); s += every) places.push_back(volume.position(s));
    std::vector<double> at(places.size());
    std::vector<Vec3> slopes(places.size());
    field.evaluate(places, {at, slopes});
    for (std::size_t i = 0; i < places.size(); ++i) ASSERT_TRUE(std::isfinite(at[i]) && norm(slopes[i]) < 1e4) << i;
  });
}

// Points around the volume, near it and far away.
TEST(ClassicFields, AnswersDoNotDependOnTheRequest) {
  std::vector<Method> all = all_of_them();
  all.insert(all.end(), {"nearest", "linear", "mls", "mls-detail", "amls"});
  for (const GridData& data : {lattice_grid({6, 5, 7}, smooth), bent_grid({5, 5, 5}, smooth)})
    for (const auto association : {Association::points, Association::cells}) {
      const auto volume = volume_of(data, association);
      const Box3 box = volume->bounds();
      auto x = points_within(*volume, 50);
      for (int i = 0; i < 125; ++i) {
        constexpr double kAlong[] = {-3, -0.03, 0.4, 1.07, 2};
        const Vec3 u{kAlong[i % 5], kAlong[i / 5 % 5], kAlong[i / 25]};
        x.push_back(box.lower + Vec3{u.x * box.size().x, u.y * box.size().y, u.z * box.size().z});
      }
      for (const Method& method : all) {
        if (!suits(method, *volume)) continue;
        SCOPED_TRACE(method);
        const auto field = field_of(volume, method);
        const std::size_t n = x.size();
        std::vector<double> alone(n), with_gradients(n), with_all(n);
        std::vector<Vec3> gradients(n), all_gradients(n);
        std::vector<std::uint8_t> inside(n);
        field->evaluate(x, {alone});
        field->evaluate(x, {with_gradients, gradients});
        field->evaluate(x, {with_all, all_gradients, inside});
        for (std::size_t i = 0; i < n; ++i) {
          ASSERT_EQ(alone[i], with_gradients[i]) << i;
          ASSERT_EQ(alone[i], with_all[i]) << i;
          ASSERT_EQ(gradients[i], all_gradients[i]) << i;
        }
      }
    }
}

TEST(ClassicFields, AnswersDependOnThePointAlone) {
  for (const Method& method : all_of_them()) {
    SCOPED_TRACE(method);
    const auto volume =
        volume_of(suits(method, *volume_of(o_grid({9, 4, 4}, smooth))) ? o_grid({17, 5, 6}, smooth)
                                                                       : lattice_grid({7, 6, 8}, smooth));
    const auto field = field_of(volume, method);
    const auto x = points_within(*volume, 300);
    const auto all = [&] {
      std::vector<double> values(x.size());
      std::vector<Vec3> gradients(x.size());
      field->evaluate(x, {values, gradients});
      for (const Vec3& g : gradients) values.insert(values.end(), {g.x, g.y, g.z});
      return values;
    };
    expect_equal_for_any_threads(all);
    const auto together = all();
    for (std::size_t i = 0; i < x.size(); i += 97) {
      double alone = 0;
      Vec3 slope;
      field->evaluate({&x[i], 1}, {{&alone, 1}, {&slope, 1}});
      EXPECT_EQ(alone, together[i]);
      field->evaluate({&x[i], 1}, {{&alone, 1}});
      EXPECT_EQ(alone, together[i]);
    }
  }
}

TEST(ClassicFields, ComponentsAreIndependent) {
  for (GridData data :
       {stretched_grid({6, 5, 5}, smooth), bent_grid({5, 4, 5}, smooth), lattice_grid({6, 5, 5}, smooth)}) {
    GridBlock& block = data.blocks[0];
    std::vector<double> vectors;
    const Attribute f = *block.point_arrays.find("f");
    for (std::size_t i = 0; i < f.rows(); ++i) vectors.insert(vectors.end(), {2.0, f.number(i), -f.number(i)});
    block.point_arrays.set("v", std::move(vectors), 3);
    const auto volume = volume_of(data);
    const auto x = points_within(*volume, 50);
    for (const Method& method : all_of_them()) {
      if (!suits(method, *volume)) continue;
      SCOPED_TRACE(method);
      Progress progress;
      VolumeReconstructionOptions options;
      options.method = method;
      const auto vector = reconstruct_volume(volume, "v", options, progress);
      ASSERT_EQ(vector->components(), 3u);
      std::vector<double> values(x.size()), three(3 * x.size());
      std::vector<Vec3> gradients(x.size()), slopes(3 * x.size());
      field_of(volume, method)->evaluate(x, {values, gradients});
      vector->evaluate(x, {three, slopes});
      for (std::size_t i = 0; i < x.size(); ++i) {
        ASSERT_NEAR(three[3 * i], 2, 1e-9);
        ASSERT_NEAR(three[3 * i + 1], values[i], 1e-9);
        ASSERT_NEAR(three[3 * i + 2], -values[i], 1e-9);
        ASSERT_NEAR(norm(slopes[3 * i + 1] - gradients[i]), 0, 1e-7);
        ASSERT_NEAR(norm(slopes[3 * i + 2] + gradients[i]), 0, 1e-7);
      }
    }
  }
}

// At the surface, beyond the outermost samples, errors are at most twice those of linear interpolation.
TEST(ClassicFields, SamplesInCellsReachTheSurface) {
  for (const GridData& data :
       {lattice_grid({8, 8, 8}, smooth), bent_grid({8, 8, 8}, smooth), two_level_amr(8, smooth)}) {
    const auto volume = volume_of(data, Association::cells);
    const auto x = points_within(*volume, 400);
    const auto worst = [&](const Method& method) {
      std::vector<double> values(x.size());
      field_of(volume, method)->evaluate(x, {values});
      double most = 0;
      for (std::size_t i = 0; i < x.size(); ++i) most = std::max(most, std::abs(values[i] - smooth(x[i])));
      return most;
    };
    const double linear = worst("linear");
    for (const Method& method : {"sibson", "mean-value", "bernstein", "rbf"})
      EXPECT_LT(worst(method), 2 * linear) << method;
  }
}

// Halving the spacing reduces errors at least by these factors: 2^order, less for errors not yet asymptotic.
TEST(ClassicFields, ErrorsFallAtTheirOrder) {
  const std::pair<Method, double> factors[] = {{"shepard", 1.7}, {"sibson", 2.8}, {"mean-value", 3.3}, {"cubic", 6.5},
                                               {"lagrange", 11}, {"rbf", 3.5},    {"bernstein", 6.5}};
  const auto x = [] {
    std::mt19937 random(2);
    std::vector<Vec3> places;
    for (int i = 0; i < 300; ++i) {
      const auto uniform = [&] { return 0.2 + 0.6 * static_cast<double>(random()) / 4294967296.0; };
      const double a = uniform(), b = uniform(), c = uniform();
      places.push_back({a, b, c});
    }
    return places;
  }();
  const auto wave = [](const Vec3& p) { return std::sin(3 * p.x + 1) * std::cos(2.5 * p.y) * std::exp(0.7 * p.z); };
  for (const auto& [method, factor] : factors) {
    SCOPED_TRACE(method);
    const auto coarse = volume_of(lattice_grid({9, 9, 9}, wave)), fine = volume_of(lattice_grid({17, 17, 17}, wave));
    EXPECT_GT(mean_error(*field_of(coarse, method), x, wave), factor * mean_error(*field_of(fine, method), x, wave));
    if (!suits(method, *volume_of(bent_grid({3, 3, 3}, wave)))) continue;
    const auto tets = volume_of(tetrahedra_grid({9, 9, 9}, wave)),
               finer = volume_of(tetrahedra_grid({17, 17, 17}, wave));
    EXPECT_GT(mean_error(*field_of(tets, method), x, wave), factor * mean_error(*field_of(finer, method), x, wave));
  }
}

// Weights are relative to the steps: stretching along an axis does not change the reconstruction.
TEST(ClassicFields, LocalMethodsFollowStretchedCells) {
  for (const Method& method : {"shepard", "rbf", "mean-value", "bernstein"}) {
    SCOPED_TRACE(method);
    const auto stretch = [](const Vec3& p) { return Vec3{p.x, p.y, p.z * 1e-3}; };
    const auto at = [](const Vec3& p) { return smooth({p.x, p.y, p.z * 1e3}); };
    const auto plain = volume_of(one_block(tetrahedra_of(lattice_block({6, 6, 6})), smooth));
    const auto flat = volume_of(one_block(tetrahedra_of(curvilinear_block(lattice_block({6, 6, 6}), stretch)), at));
    const auto x = points_within(*plain, 100);
    std::vector<Vec3> y;
    for (const Vec3& p : x) y.push_back(stretch(p));
    std::vector<double> a(x.size()), b(x.size());
    field_of(plain, method)->evaluate(x, {a});
    field_of(flat, method)->evaluate(y, {b});
    // Metrics from the star's moments are invariant under stretching; mean values in tetrahedra are linear.
    for (std::size_t i = 0; i < x.size(); ++i) ASSERT_NEAR(a[i], b[i], 2e-3) << i;
  }
}

TEST(ClassicFields, ErrorsNameRequiredGridsAndRanges) {
  Progress progress;
  const auto bent = volume_of(bent_grid({4, 4, 4}, smooth)), lattice = volume_of(lattice_grid({4, 4, 4}, smooth)),
             stretched = volume_of(stretched_grid({4, 4, 4}, smooth));
  for (const Method& method : {"cubic", "sinc", "lagrange"}) EXPECT_THROW(field_of(bent, method), ArgumentError);
  EXPECT_THROW(field_of(stretched, "sinc"), ArgumentError);
  VolumeReconstructionOptions options;
  options.method = "lagrange";
  options.degree = 0;
  EXPECT_THROW(reconstruct_volume(lattice, "f", options, progress), ArgumentError);
  options = {};
  options.method = "rbf";
  options.radius = 5;
  EXPECT_THROW(reconstruct_volume(lattice, "f", options, progress), ArgumentError);
  options.radius = 2.5;
  VolumeReconstructionReport report;
  EXPECT_NE(reconstruct_volume(lattice, "f", options, progress, &report), nullptr);
  EXPECT_EQ(report.options.radius, 2.5);
  options.method = "shepard";
  options.radius.reset();
  reconstruct_volume(lattice, "f", options, progress, &report);
  EXPECT_TRUE(report.options.radius.has_value());
}

TEST(LatticeField, RangesOfCubicsContainAllValues) {
  Progress progress;
  const auto rough = [](const Vec3& x) { return std::sin(37 * x.x + 5 * x.y) + std::cos(23 * x.y * x.z) + 100; };
  for (const GridData& data : {lattice_grid({6, 9, 7}, rough), stretched_grid({7, 6, 5}, rough)})
    for (const Association a : {Association::points, Association::cells}) {
      const auto volume = volume_of(data, a);
      for (const double b : {0.0, 1.0 / 3, 1.0}) {
        VolumeReconstructionOptions options;
        options.method = "cubic", options.b = b, options.c = 0.5 * (1 - b);
        const auto field = reconstruct_volume(volume, "f", options, progress);
        const Box3 whole = field->bounds();
        const Vec3 size = whole.size();
        for (int part = 1; part < 6; ++part)
          for (int k = 0; k < 8; ++k) {
            const Vec3 edge = size * (1.0 / part),
                       at{static_cast<double>(k & 1), static_cast<double>(k >> 1 & 1), static_cast<double>(k >> 2)};
            Box3 box;
            box.lower =
                whole.lower + Vec3{at.x * (size.x - edge.x), at.y * (size.y - edge.y), at.z * (size.z - edge.z)};
            box.upper = box.lower + edge;
            ValueRange range;
            field->ranges({&box, 1}, {&range, 1});
            std::vector<Vec3> x;
            for (int p = 0; p < 1000; ++p) {
              const int tens = p / 10, hundreds = p / 100;
              x.push_back(box.lower + Vec3{p % 10 / 9.0 * edge.x, tens % 10 / 9.0 * edge.y, hundreds / 9.0 * edge.z});
            }
            std::vector<double> values(x.size());
            field->evaluate(x, {values, {}, {}});
            const auto [least, most] = std::minmax_element(values.begin(), values.end());
            EXPECT_LE(range.least, *least + 1e-9);
            EXPECT_GE(range.most, *most - 1e-9);
            // The samples' range is 4, and the largest sum of absolute weights below 2.1³; larger beyond the last
            // centres.
            if (a == Association::points) EXPECT_LT(range.most - range.least, 4 * 9.3);
          }
      }
    }
}

}  // namespace
}  // namespace sansmesh::test
