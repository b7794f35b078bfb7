// Registered surface methods and their options.
#include "sansmesh/model/surface_method.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/reconstruct.h"
#include "support/clouds.h"
#include "support/places.h"
#include "support/surface_names.h"

namespace sansmesh::inline v1 {
namespace {

TEST(SurfaceMethods, AreFoundByTheirNames) {
  std::set<std::string_view> names, summaries;
  const std::string all = SurfaceMethod::registry().names();
  EXPECT_TRUE(
      all.starts_with("partition, hoppe, adamson, kolluri, dey, extremal, apss, amls, levin, alexa, curvature, mpu"))
      << all;
  for (const SurfaceMethod* const method : SurfaceMethod::registry().all()) {
    EXPECT_EQ(&surface_method(method->name), method);
    EXPECT_TRUE(names.insert(method->name).second) << method->name;
    EXPECT_TRUE(summaries.insert(method->summary).second) << method->name << " is described as another one is";
  }
  for (const char* wrong : {"poisson", "", "APSS", "apss "}) {
    try {
      surface_method(wrong);
      ADD_FAILURE() << "'" << wrong << "' is a surface";
    } catch (const ArgumentError& error) {
      EXPECT_NE(std::string(error.what()).find("known are " + all), std::string::npos);
    }
  }
}

TEST(SurfaceMethods, NamesAreTakenOnce) {
  EXPECT_THROW(SurfaceMethod::registry().add({.name = "apss", .summary = "", .page = ""}), ArgumentError);
  EXPECT_THROW(SurfaceMethod::registry().add({.name = "", .summary = "", .page = ""}), ArgumentError);
}

TEST(SurfaceMethods, NeedAFunctionThatMakesThem) {
  EXPECT_THROW(SurfaceMethod::registry().add({.name = "no-make", .summary = "", .page = ""}), ArgumentError);
  EXPECT_EQ(SurfaceMethod::registry().find("no-make"), nullptr);
}

TEST(SurfaceMethods, HavePagesInTheDocs) {
  for (const SurfaceMethod* const method : SurfaceMethod::registry().all())
    EXPECT_TRUE(std::filesystem::is_regular_file(test::source_file("docs/methods/" + std::string(method->page))))
        << method->name << ": " << method->page;
}

/// A method with one option set to a valid value other than the default.
SurfaceOptions with(std::string_view method, std::string_view option) {
  using S = SurfaceOptions;
  SurfaceOptions o{.method = std::string(method)};
  const std::pair<std::string_view, OptionValue> values[] = {{"sharp", std::string("laguerre")},
                                                             {"smoothing", 2.0},
                                                             {"bandwidth", 0.15},
                                                             {"weights", std::string("gaussian")},
                                                             {"order", std::string("2")},
                                                             {"iterations", std::int64_t{1}},
                                                             {"epsilon", 0.8},
                                                             {"normal", std::string("covariance")},
                                                             {"reference_plane", std::string("nonlinear")},
                                                             {"polynomial", std::string("3")},
                                                             {"flow", std::string("normal")},
                                                             {"diffusion", std::string("hard")},
                                                             {"diffusion_threshold", 2.0},
                                                             {"tau", std::int64_t{1}},
                                                             {"separate_sheets", false},
                                                             {"error", 0.01},
                                                             {"depth", std::int64_t{5}},
                                                             {"smooth", true}};
  for_each_option(S::schema(), &o, [&](const OptionRow& row, void* owner) {
    if (row.name != option) return;
    for (const auto& [name, value] : values)
      if (name == option) return set_option(row, owner, value);
    ADD_FAILURE() << "no value to try " << option << " with";
  });
  if (option == "diffusion_threshold") o.diffusion = S::Diffusion::soft;  // otherwise unused
  if (option == "normal" && method == "amls") o.normal = S::Normal::iterated;
  return o;
}

TEST(SurfaceMethods, OptionsAreTakenByThoseThatUseThemOnly) {
  std::vector<std::string_view> options;
  const SurfaceOptions usual;
  for_each_option(SurfaceOptions::schema(), &usual, [&](const OptionRow& row, const void*) {
    if (row.name != "method") options.push_back(row.name);
  });
  for (const SurfaceMethod* const method : SurfaceMethod::registry().all()) {
    EXPECT_NO_THROW(SurfaceOptions{.method = std::string(method->name)}.validate()) << method->name;
    for (const std::string_view option : method->uses)
      EXPECT_NE(std::find(options.begin(), options.end(), option), options.end()) << method->name << ": " << option;
    for (const std::string_view option : options) {
      const SurfaceOptions o = with(method->name, option);
      if (method->uses_option(option)) {
        EXPECT_NO_THROW(o.validate()) << method->name << ", " << option;
        EXPECT_NE(surfaces_that_use(option).find(method->name), std::string::npos);
        continue;
      }
      try {
        o.validate();
        ADD_FAILURE() << method->name << " takes " << option;
      } catch (const ArgumentError& error) {
        const std::string said = error.what();
        const std::string_view named = option == "diffusion_threshold" ? "diffusion" : option;
        EXPECT_NE(said.find(named), std::string::npos) << said;
        EXPECT_NE(said.find(method->name), std::string::npos) << said;
      }
    }
  }
}

TEST(SurfaceMethods, ValuesAreRefusedWhereTheyMeanNothing) {
  using S = SurfaceOptions;
  const auto refused = [](const S& o, const std::string& field) {
    try {
      o.validate();
      ADD_FAILURE() << field;
    } catch (const ArgumentError& error) {
      EXPECT_NE(std::string(error.what()).find("`" + field + "`"), std::string::npos) << error.what();
    }
  };
  refused({.method = "adamson", .normal = S::Normal::iterated}, "normal");
  refused({.method = "amls", .normal = S::Normal::covariance}, "normal");
  refused({.method = "curvature", .diffusion_threshold = 1}, "diffusion_threshold");
  refused({.method = "curvature", .tau = 4}, "tau");
  refused({.method = "curvature", .diffusion = S::Diffusion::hard, .diffusion_threshold = 0}, "diffusion_threshold");
  refused({.method = "amls", .epsilon = 0}, "epsilon");
  refused({.method = "amls", .order = 3}, "order");
  refused({.method = "amls", .order = 8}, "order");
}

/// The model's normals are the requested ones: iterated, sharp, or sharpened iterated ones.
TEST(SurfaceMethods, ModelsHaveTheNormalsThatWereAskedFor) {
  SurfaceOptions o{.method = "amls", .smoothing = 1.2, .order = 4, .iterations = 3};
  Progress progress;
  const PointSet cloud = test::cube(3000);
  const std::vector<Vec3> x{{1, 0.3, 0.9}, {1, -0.2, 0.1}};
  const auto normals_of = [&](const SurfaceOptions& options) {
    const SurfaceModel model = make_surface_model(cloud, options, progress);
    std::vector<Vec3> at, normals(x.size());
    for (const Vec3& p : x) at.push_back(model.frame().from_input(p));
    std::vector<double> values(x.size());
    model.field(progress).evaluate(at, values, normals);
    for (Vec3& n : normals) n = normalized(n);
    if (model.normals()) model.normals()->refine(at, normals);
    return normals;
  };
  const std::vector<Vec3> plain = normals_of(o);
  o.normal = SurfaceOptions::Normal::iterated;
  const std::vector<Vec3> iterated = normals_of(o);
  o.sharp = SharpFormula::bilateral;
  const std::vector<Vec3> both = normals_of(o);
  o.sharp = SharpFormula::laguerre;
  const std::vector<Vec3> laguerre = normals_of(o);
  // Only h/√ε matters, for these weights as for the surface's.
  o.smoothing = 1.5, o.epsilon = 1;
  const std::vector<Vec3> narrow = normals_of(o);
  o.smoothing = 3.0, o.epsilon = 4;
  EXPECT_LT(norm(normals_of(o)[0] - narrow[0]), 1e-5);
  EXPECT_GT(norm(plain[0] - iterated[0]), 1e-4);  // next to the edge
  EXPECT_GT(norm(both[0] - iterated[0]), 1e-4);
  EXPECT_GT(norm(both[0] - laguerre[0]), 1e-5);
  for (const auto& normals : {plain, iterated, both, laguerre}) EXPECT_GT(normals[1].x, 0.98);
}

class EveryMethodOfTheTable : public testing::TestWithParam<std::string> {};

/// A sphere with default options and with each option that the method uses.
TEST_P(EveryMethodOfTheTable, MakesTheSurfaceOfASphere) {
  const SurfaceMethod& method = surface_method(GetParam());
  const std::size_t n = 2000;
  const PointSet cloud = test::sphere(n);
  const auto check = [&](SurfaceOptions choice, const std::string& what) {
    if (method.uses_option("order") && !choice.bandwidth) {  // cross validation is slow
      if (!choice.order) choice.order = 4;
      if (!choice.iterations) choice.iterations = 3;
      if (!choice.smoothing) choice.smoothing = 1.2;
    }
    ReconstructOptions options;
    options.surface = choice;
    Progress progress;
    const TriangleMesh mesh = reconstruct(cloud, options, progress).mesh;
    const MeshTopology topology = measure_topology(mesh);
    EXPECT_EQ(topology.components, 1u) << what;
    EXPECT_TRUE(topology.manifold()) << what;
    EXPECT_TRUE(topology.closed() || GetParam() == "hoppe") << what;  // planes of hoppe do not meet
    double sum = 0;
    for (const Vec3f& v : mesh.vertices) sum += std::abs(norm(v) - 1);
    EXPECT_LT(sum / static_cast<double>(mesh.vertices.size()), 0.05) << what;
  };
  check({.method = GetParam()}, "by itself");
  for (const std::string_view option : method.uses) check(with(GetParam(), option), std::string(option));
}

INSTANTIATE_TEST_SUITE_P(Names, EveryMethodOfTheTable, testing::ValuesIn(test::surface_names()),
                         [](const auto& tested) { return tested.param; });

TEST(ReconstructOptions, OptionsOfTheFitBelongToThePartition) {
  const auto refused = [](auto change, const std::string& field) {
    ReconstructOptions o;
    change(o);
    EXPECT_NO_THROW(o.validate()) << field;
    o.surface = {.method = "partition"};
    EXPECT_NO_THROW(o.validate()) << field;
    o.surface = {.method = "kolluri"};
    try {
      o.validate();
      ADD_FAILURE() << field << " is taken";
    } catch (const ArgumentError& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  };
  refused([](ReconstructOptions& o) { o.fit.depth = 5; }, "depth");
  refused([](ReconstructOptions& o) { o.fit.error = 0.1; }, "error");
  refused([](ReconstructOptions& o) { o.fit.support = 1.4; }, "support");
  refused([](ReconstructOptions& o) { o.fit.degree = 2; }, "degree");
  refused([](ReconstructOptions& o) { o.fit.sharp = false; }, "sharp");
}

TEST(ReconstructOptions, ThePartitionByNameIsThePartition) {
  const PointSet cloud = test::torus(2000);
  ReconstructOptions plain, named;
  named.surface = {.method = "partition"};
  plain.fit.depth = named.fit.depth = 4;
  Progress progress;
  const TriangleMesh a = reconstruct(cloud, plain, progress).mesh, b = reconstruct(cloud, named, progress).mesh;
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
}

}  // namespace
}  // namespace sansmesh::inline v1
