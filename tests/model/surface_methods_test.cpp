// The table of surfaces: one entry is all that a method takes.
#include "sansmesh/model/surface_methods.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "sansmesh/core/error.h"
#include "sansmesh/mesh/mesh_topology.h"
#include "sansmesh/jobs/reconstruct.h"
#include "support/clouds.h"
#include "support/places.h"
#include "support/surface_names.h"

namespace sansmesh {
namespace {

TEST(SurfaceMethods, NamesAreTheMethods) {
  std::set<std::string> names, summaries;
  for (const SurfaceMethodInfo& info : surface_methods()) {
    EXPECT_EQ(surface_method(info.name), info.method);
    EXPECT_EQ(surface_method_info(info.method).name, info.name);
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_TRUE(summaries.insert(info.summary).second) << info.name << " is described as another one is";
    EXPECT_NE(surface_method_names().find(info.name), std::string::npos);
  }
  for (const char* wrong : {"poisson", "", "APSS", "apss "}) {
    try {
      surface_method(wrong);
      ADD_FAILURE() << "'" << wrong << "' is a surface";
    } catch (const ArgumentError& error) {
      EXPECT_NE(std::string(error.what()).find("known are " + surface_method_names()), std::string::npos);
    }
  }
  EXPECT_THROW(surface_method_info(static_cast<SurfaceMethod>(surface_methods().size())), ArgumentError);
}

TEST(SurfaceMethods, HavePagesInTheDocs) {
  for (const SurfaceMethodInfo& info : surface_methods())
    EXPECT_TRUE(std::filesystem::is_regular_file(test::source_file(std::string("docs/methods/") + info.page)))
        << info.name << ": " << info.page;
}

/// An option other than it is by itself, and in range.
SurfaceOptions with(SurfaceMethod method, SurfaceOption option) {
  SurfaceOptions o{.method = method};
  switch (option) {
    case SurfaceOption::smoothing:
      o.smoothing = 2;
      break;
    case SurfaceOption::bandwidth:
      o.bandwidth = 0.15;
      break;
    case SurfaceOption::weights:
      o.weights = SurfaceWeights::gaussian;
      break;
    case SurfaceOption::epsilon:
      o.epsilon = 0.8;
      break;
    case SurfaceOption::normal:
      o.normal = method == SurfaceMethod::amls ? SurfaceOptions::Normal::iterated : SurfaceOptions::Normal::covariance;
      break;
    case SurfaceOption::plane:
      o.plane = SurfaceOptions::Plane::nonlinear;
      break;
    case SurfaceOption::polynomial:
      o.polynomial = SurfaceOptions::Polynomial::cubic;
      break;
    case SurfaceOption::flow:
      o.flow = SurfaceOptions::Flow::normal;
      break;
    case SurfaceOption::threshold:
      o.diffusion = SurfaceOptions::Diffusion::soft;  // which it is the threshold of
      o.threshold = 2;
      break;
    case SurfaceOption::tau:
      o.tau = 1;
      break;
    case SurfaceOption::order:
      o.order = 2;
      break;
    case SurfaceOption::iterations:
      o.iterations = 1;
      break;
    case SurfaceOption::diffusion:
      o.diffusion = SurfaceOptions::Diffusion::hard;
      break;
    case SurfaceOption::separate_sheets:
      o.separate_sheets = false;
      break;
    case SurfaceOption::sharp:
      o.sharp = true;
      break;
    case SurfaceOption::error:
      o.error = 0.01;
      break;
    case SurfaceOption::max_depth:
      o.max_depth = 5;
      break;
    case SurfaceOption::smooth:
      o.smooth = true;
      break;
  }
  return o;
}

TEST(SurfaceMethods, OptionsAreTakenByThoseThatHeedThemOnly) {
  for (const SurfaceMethodInfo& info : surface_methods()) {
    EXPECT_NO_THROW(SurfaceOptions{.method = info.method}.validate()) << info.name;
    for (std::size_t i = 0; i < kSurfaceOptions; ++i) {
      const auto option = static_cast<SurfaceOption>(i);
      const SurfaceOptions o = with(info.method, option);
      for (std::size_t k = 0; k < kSurfaceOptions; ++k) {
        const bool goes_with =
            option == SurfaceOption::threshold && static_cast<SurfaceOption>(k) == SurfaceOption::diffusion;
        EXPECT_EQ(o.is_set(static_cast<SurfaceOption>(k)), k == i || goes_with) << field_name(option);
      }
      if (info.heeds(option)) {
        EXPECT_NO_THROW(o.validate()) << info.name << ", " << field_name(option);
        EXPECT_NE(heeded_by(option).find(info.name), std::string::npos);
        continue;
      }
      try {
        o.validate();
        ADD_FAILURE() << info.name << " takes " << field_name(option);
      } catch (const ArgumentError& error) {
        const std::string said = error.what();
        const char* const named = option == SurfaceOption::threshold ? "diffusion" : field_name(option);
        EXPECT_NE(said.find(named), std::string::npos) << said;
        EXPECT_NE(said.find(info.name), std::string::npos) << said;
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
  refused({.method = SurfaceMethod::adamson, .normal = S::Normal::iterated}, "normal");
  refused({.method = SurfaceMethod::amls, .normal = S::Normal::covariance}, "normal");
  refused({.method = SurfaceMethod::curvature, .threshold = 1}, "threshold");
  refused({.method = SurfaceMethod::curvature, .tau = 4}, "tau");
  refused({.method = SurfaceMethod::curvature, .diffusion = S::Diffusion::hard, .threshold = 0}, "threshold");
  refused({.method = SurfaceMethod::amls, .epsilon = 0}, "epsilon");
  refused({.sharp_formula = S::SharpFormula::laguerre}, "sharp_formula");
}

/// The model's normals are those that were asked for: iterated ones, sharp ones, or the latter of the former.
TEST(SurfaceMethods, ModelsHaveTheNormalsThatWereAskedFor) {
  SurfaceOptions o{.method = SurfaceMethod::amls, .smoothing = 1.2, .order = 4, .iterations = 3};
  Progress progress;
  const PointSet cloud = test::cube(3000);
  const std::vector<Vec3> x{{1, 0.3, 0.9}, {1, -0.2, 0.1}};
  const auto normals_of = [&](const SurfaceOptions& options) {
    const SurfaceModel model = make_surface_model(cloud, options, progress);
    std::vector<Vec3> at, normals(x.size());
    for (const Vec3& p : x) at.push_back(model.place().from_input(p));
    std::vector<double> values(x.size());
    model.field(progress).evaluate(at, values, normals);
    for (Vec3& n : normals) n = normalized(n);
    if (model.normals()) model.normals()->refine(at, normals);
    return normals;
  };
  const std::vector<Vec3> plain = normals_of(o);
  o.normal = SurfaceOptions::Normal::iterated;
  const std::vector<Vec3> iterated = normals_of(o);
  o.sharp = true;
  const std::vector<Vec3> both = normals_of(o);
  o.sharp_formula = SurfaceOptions::SharpFormula::laguerre;
  const std::vector<Vec3> laguerre = normals_of(o);
  // Only h/√ε counts, of these weights as of the surface's.
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

/// A sphere of a surface by itself and with each option that it heeds.
TEST_P(EveryMethodOfTheTable, MakesTheSurfaceOfASphere) {
  const SurfaceMethodInfo& info = surface_method_info(surface_method(GetParam()));
  const std::size_t n = 2000;
  const PointSet cloud = test::sphere(n);
  const auto check = [&](SurfaceOptions choice, const std::string& what) {
    if (info.heeds(SurfaceOption::order) && !choice.bandwidth) {  // cross validation takes its time
      if (!choice.order) choice.order = 4;
      if (!choice.iterations) choice.iterations = 3;
      if (!choice.smoothing) choice.smoothing = 1.2;
    }
    ReconstructOptions options;
    options.surface = choice;
    Progress progress;
    const TriangleMesh mesh = reconstruct(cloud, options, progress);
    const MeshTopology topology = measure_topology(mesh);
    EXPECT_EQ(topology.components, 1u) << what;
    EXPECT_TRUE(topology.manifold()) << what;
    EXPECT_TRUE(topology.closed() || GetParam() == "hoppe") << what;  // whose planes do not meet
    double sum = 0;
    for (const Vec3f& v : mesh.vertices) sum += std::abs(norm(v) - 1);
    EXPECT_LT(sum / static_cast<double>(mesh.vertices.size()), 0.05) << what;
  };
  check({.method = info.method}, "by itself");
  for (const SurfaceOption option : info.options) check(with(info.method, option), field_name(option));
}

INSTANTIATE_TEST_SUITE_P(Names, EveryMethodOfTheTable, testing::ValuesIn(test::surface_names()),
                         [](const auto& tested) { return tested.param; });

TEST(ReconstructOptions, OptionsOfTheFitBelongToThePartition) {
  const auto refused = [](auto change, const std::string& field) {
    ReconstructOptions o;
    change(o);
    EXPECT_NO_THROW(o.validate()) << field;
    o.surface = SurfaceOptions{.method = SurfaceMethod::partition};
    EXPECT_NO_THROW(o.validate()) << field;
    o.surface = SurfaceOptions{.method = SurfaceMethod::kolluri};
    try {
      o.validate();
      ADD_FAILURE() << field << " is taken";
    } catch (const ArgumentError& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  };
  refused([](ReconstructOptions& o) { o.max_depth = 5; }, "max_depth");
  refused([](ReconstructOptions& o) { o.error = 0.1; }, "error");
  refused([](ReconstructOptions& o) { o.support = 1.4; }, "support");
  refused([](ReconstructOptions& o) { o.max_degree = 2; }, "max_degree");
  refused([](ReconstructOptions& o) { o.sharp = false; }, "sharp");
}

TEST(ReconstructOptions, ThePartitionByNameIsThePartition) {
  const PointSet cloud = test::torus(2000);
  ReconstructOptions plain, named;
  named.surface = SurfaceOptions{.method = SurfaceMethod::partition};
  plain.max_depth = named.max_depth = 4;
  Progress progress;
  const TriangleMesh a = reconstruct(cloud, plain, progress), b = reconstruct(cloud, named, progress);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
}

}  // namespace
}  // namespace sansmesh
