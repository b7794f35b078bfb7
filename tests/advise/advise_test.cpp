#include "sansmesh/advice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/model/surface_method.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

using Aim = Recommendation::Aim;

Advice ask(const PointSet& cloud) {
  Progress progress;
  return advise(cloud, progress);
}

/// The recommendation for this aim, if any.
std::optional<Recommendation> for_aim(const Advice& advice, Aim aim) {
  for (const Recommendation& r : advice.recommendations)
    if (r.aim == aim) return r;
  return std::nullopt;
}

bool says(const Advice& advice, const std::string& words) {
  return std::any_of(advice.findings.begin(), advice.findings.end(),
                     [&](const std::string& f) { return f.find(words) != std::string::npos; });
}

TEST(Advise, FindsTheEdgesOfACube) {
  for (const std::size_t n : {3000u, 20000u}) {
    const Advice advice = ask(test::cube(n));
    // 12 edges of 2, the diagonal 2 √3.
    EXPECT_NEAR(advice.traits.crease_length, 6.9, 3) << n;
    EXPECT_TRUE(says(advice, "sharp edges:")) << n;
    EXPECT_FALSE(says(advice, "borders"));
    const auto picture = for_aim(advice, Aim::picture), mesh = for_aim(advice, Aim::mesh);
    ASSERT_TRUE(picture && mesh);
    EXPECT_TRUE(picture->sharp) << n;
    EXPECT_EQ(mesh->surface, "partition") << "has creases itself";
    EXPECT_FALSE(mesh->sharp);
    EXPECT_FALSE(mesh->remove_outliers);
  }
}

TEST(Advise, HasNoFindingsForACleanSphere) {
  const Advice advice = ask(test::sphere(20000));
  EXPECT_NEAR(advice.traits.spacing, std::sqrt(4 * std::numbers::pi / 20000), 0.1 * advice.traits.spacing);
  EXPECT_LT(advice.traits.noise_ratio(), 0.02);
  EXPECT_LT(advice.traits.density_ratio, 1.3);
  EXPECT_EQ(advice.traits.outliers, 0);
  EXPECT_EQ(advice.traits.creases, 0);
  EXPECT_EQ(advice.traits.borders, 0);
  EXPECT_EQ(advice.findings.size(), 1u) << "that there is no noise";
  EXPECT_EQ(advice.recommendations.front().aim, Aim::mesh);
  EXPECT_FALSE(for_aim(advice, Aim::picture).value().sharp);
  EXPECT_FALSE(for_aim(advice, Aim::points)) << "nothing to smooth";
}

TEST(Advise, SmoothsNoise) {
  const std::size_t n = 20000;
  const double spacing = std::sqrt(4 * std::numbers::pi / static_cast<double>(n));
  for (const double ratio : {0.25, 0.8}) {
    const Advice advice = ask(test::sphere(n, ratio * spacing));
    EXPECT_NEAR(advice.traits.noise_ratio(), ratio, 0.3 * ratio);
    EXPECT_TRUE(says(advice, "noisy")) << ratio;
    EXPECT_FALSE(says(advice, "sharp edges:")) << ratio;
    EXPECT_FALSE(says(advice, "borders")) << ratio;
    EXPECT_EQ(for_aim(advice, Aim::points).value().surface, "partition") << ratio;
    EXPECT_EQ(for_aim(advice, Aim::curvature).value().surface, "curvature") << ratio;
  }
}

TEST(Advise, ReportsBoundsOfUnknownNoise) {
  CloudTraits few;
  few.samples = 1500, few.spacing = 1, few.most_noise = 0.3, few.noise_known = false;
  EXPECT_TRUE(says(advise(few), "cannot be distinguished from shape with so few samples: it is 0.3 spacings at most"));
  CloudTraits frame;
  frame.samples = 250000, frame.spacing = 1, frame.most_noise = 0.7, frame.step = 2.4, frame.noise_known = false;
  EXPECT_TRUE(says(advise(frame), "steps of 2.4 spacings"));
  for (const CloudTraits& t : {few, frame}) EXPECT_FALSE(says(advise(t), "no noise"));
}

TEST(Advise, RemovesStraySamplesFirst) {
  PointSet cloud = test::sphere(20000);
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> uniform(-2, 2);
  for (int i = 0; i < 200; ++i) {
    cloud.positions.push_back({uniform(generator), uniform(generator), uniform(generator)});
    cloud.normals.push_back({0, 0, 1});
  }
  const Advice advice = ask(cloud);
  EXPECT_GT(advice.traits.outliers, 0.006);
  EXPECT_LT(advice.traits.outliers, 0.011);
  EXPECT_TRUE(says(advice, "stray"));
  EXPECT_TRUE(for_aim(advice, Aim::mesh).value().remove_outliers);
  EXPECT_TRUE(for_aim(advice, Aim::picture).value().remove_outliers);
  EXPECT_LT(advice.traits.noise_ratio(), 0.05) << "stray samples are no noise";
}

TEST(Advise, ReportsTheTreatmentOfNormals) {
  SANSMESH_NOT_SANITIZED("repeats what others run");
  PointSet cloud = test::sphere(5000);
  PointSet none = cloud, inward = cloud, mixed = cloud;
  none.normals.clear();
  for (Vec3f& n : inward.normals) n = -n;
  for (std::size_t i = 0; i < mixed.size(); ++i)
    if (mixed.positions[i].x > 0.2f && mixed.positions[i].y > 0) mixed.normals[i] = -mixed.normals[i];
  EXPECT_FALSE(says(ask(cloud), "normals"));
  EXPECT_TRUE(says(ask(none), "no normals"));
  EXPECT_TRUE(says(ask(inward), "point inward"));
  EXPECT_TRUE(says(ask(mixed), "not oriented consistently"));
  std::mt19937 random(4);
  std::normal_distribution<float> gauss;
  for (Vec3f& n : cloud.normals) n = normalized(Vec3f{gauss(random), gauss(random), gauss(random)});
  EXPECT_TRUE(says(ask(cloud), "unrelated"));
}

TEST(Advise, FindsBorders) {
  PointSet half;
  const PointSet ball = test::sphere(20000);
  for (std::size_t i = 0; i < ball.size(); ++i) {
    if (ball.positions[i].y < 0) continue;
    half.positions.push_back(ball.positions[i]);
    half.normals.push_back(ball.normals[i]);
  }
  const Advice advice = ask(half);
  EXPECT_NEAR(advice.traits.border_length, 2 * std::numbers::pi / 3, 1.2);  // diagonal of 2 × 1 × 2
  EXPECT_TRUE(says(advice, "borders"));
  EXPECT_GT(advice.traits.open, 0.99);
  EXPECT_TRUE(says(advice, "open: the surface bounds no solid"));
  EXPECT_NE(for_aim(advice, Aim::mesh).value().why.find("ends where the samples end"), std::string::npos);
}

TEST(Advise, DistinguishesOpenScenesFromSolids) {
  EXPECT_EQ(ask(test::cube(3000)).traits.open, 0);
  // A floor, and a ball above it with an eighth of the total area.
  PointSet scene;
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j) {
      const float x = 0.1f * static_cast<float>(i), y = 0.1f * static_cast<float>(j);
      scene.positions.push_back({x, y, 0.2f * std::sin(x)});
      scene.normals.push_back(normalized(Vec3f{-0.2f * std::cos(x), 0, 1}));
    }
  const Advice floor = ask(scene);
  EXPECT_GT(floor.traits.open, 0.99);
  EXPECT_FALSE(says(floor, "% of the surface bounds no solid"));
  PointSet strays = scene;
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> uniform(1, 9);
  for (int i = 0; i < 100; ++i) {
    strays.positions.push_back({uniform(generator), uniform(generator), uniform(generator)});
    strays.normals.push_back({0, 0, 1});
  }
  const Advice untidy = ask(strays);
  EXPECT_TRUE(says(untidy, "stray"));
  EXPECT_FALSE(for_aim(untidy, Aim::mesh).value().remove_outliers) << "they do no harm there";
  const Advice both = ask(test::joined(scene, test::sphere(1400), 1.05f, {5, 5, 3}));
  EXPECT_NEAR(both.traits.open, 100 / (100 + 4 * std::numbers::pi * 1.05 * 1.05), 0.05);
  EXPECT_TRUE(says(both, "% of the surface bounds no solid"));
}

TEST(Advise, CountsTheOpenEdgesOfFaces) {
  // A lattice of n × n on a sphere without its poles: two loops of n edges each; with the hole of a quadrilateral
  // another of 4.
  const std::uint32_t n = 60;
  PointSet band;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const double u = 2 * std::numbers::pi * i / n, v = 0.3 + 2.5 * j / (n - 1);
      band.positions.push_back(Vec3f(Vec3{std::cos(u) * std::sin(v), std::sin(u) * std::sin(v), std::cos(v)}));
      if (j + 1 == n || (i == 20 && j == 30)) continue;
      const std::uint32_t a = i * n + j, b = (i + 1) % n * n + j;
      band.triangles.push_back({a, a + 1, b});
      band.triangles.push_back({b, a + 1, b + 1});
    }
  const Advice advice = ask(band);
  EXPECT_EQ(advice.traits.open_edges, 2 * n + 4);
  EXPECT_EQ(advice.traits.open_loops, 3u);
  EXPECT_TRUE(says(advice, "124 open edges of the faces in 3 loops"));
  EXPECT_NE(for_aim(advice, Aim::mesh).value().why.find("`fill_holes`"), std::string::npos);
  // Separate triangles are joined at equal positions, as in `info` and `measure`; triangles that touch nothing have no
  // finding.
  PointSet soup;
  for (const auto& t : band.triangles) {
    const auto base = static_cast<std::uint32_t>(soup.size());
    for (const std::uint32_t v : t) soup.positions.push_back(band.positions[v]);
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  EXPECT_EQ(ask(soup).traits.open_edges, 2 * n + 4);
  for (const Triangle& t : soup.triangles) {
    const Vec3f middle = (soup.positions[t[0]] + soup.positions[t[1]] + soup.positions[t[2]]) / 3.0f;
    for (const std::uint32_t v : t) soup.positions[v] = middle + 0.9f * (soup.positions[v] - middle);
  }
  EXPECT_EQ(ask(soup).traits.open_edges, 0u);
}

TEST(Advise, FindsUnevenSampling) {
  PointSet uneven;
  const PointSet ball = test::sphere(40000);
  for (std::size_t i = 0; i < ball.size(); ++i) {
    if (ball.positions[i].x < 0 && i % 36 != 0) continue;
    uneven.positions.push_back(ball.positions[i]);
    uneven.normals.push_back(ball.normals[i]);
  }
  const Advice advice = ask(uneven);
  EXPECT_GT(advice.traits.density_ratio, 3.5);  // 6, except for the lines through every 36th sample of the spiral
  EXPECT_LT(advice.traits.density_ratio, 7);
  EXPECT_TRUE(says(advice, "uneven"));
  EXPECT_LT(ask(ball).traits.density_ratio, 1.3);
}

TEST(Advise, RecommendsWhatTheMethodUses) {
  PointSet strays = test::cube(6000);
  for (int i = 0; i < 60; ++i) {
    strays.positions.push_back({3 * std::cos(0.1f * float(i)), 3 * std::sin(0.1f * float(i)), 0.05f * float(i)});
    strays.normals.push_back({0, 0, 1});
  }
  for (const PointSet& cloud : {test::cube(6000), test::sphere(6000, 0.02), strays})
    for (const Recommendation& r : ask(cloud).recommendations) {
      EXPECT_TRUE(!r.sharp || surface_method(r.surface).uses_option("sharp")) << aim_word(r.aim);
      EXPECT_GT(r.why.size(), 10u);
    }
}

TEST(Advise, RejectsPointsWithoutASurface) {
  PointSet few = test::sphere(8), line, empty;
  for (int i = 0; i < 400; ++i) line.positions.push_back({static_cast<float>(i), 2, 3});
  EXPECT_THROW(ask(few), DataError);
  EXPECT_THROW(ask(line), DataError);
  EXPECT_THROW(ask(empty), DataError);
  for (const std::size_t n : {9u, 12u, 25u, 60u}) {
    const Advice advice = ask(test::sphere(n));
    EXPECT_TRUE(says(advice, "few samples")) << n;
    EXPECT_TRUE(std::isfinite(advice.traits.density_ratio) && std::isfinite(advice.traits.crease_length)) << n;
  }
}

TEST(Advise, DoesNotDependOnUnitOrThreads) {
  const PointSet cloud = test::cube(8000);
  PointSet large = cloud;
  for (Vec3f& p : large.positions) p *= 1024.0f;
  test::compare_threads([&] { return ask(cloud); },
                        [](const Advice& one, const Advice& many) {
                          EXPECT_EQ(one.findings, many.findings);
                          EXPECT_EQ(one.traits.crease_length, many.traits.crease_length);
                        });
  const Advice one = ask(cloud), scaled = ask(large);
  EXPECT_EQ(one.findings, scaled.findings);
  EXPECT_DOUBLE_EQ(1024 * one.traits.spacing, scaled.traits.spacing);
}

}  // namespace
}  // namespace sansmesh::inline v1
