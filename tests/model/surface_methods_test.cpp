// The table of surfaces: one entry is all that a method takes.
#include "sansmesh/model/surface_methods.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "sansmesh/core/error.h"
#include "sansmesh/mesh/mesh_topology.h"
#include "sansmesh/reconstruct.h"
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
      for (std::size_t k = 0; k < kSurfaceOptions; ++k)
        EXPECT_EQ(o.is_set(static_cast<SurfaceOption>(k)), k == i) << field_name(option);
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
        EXPECT_NE(said.find(field_name(option)), std::string::npos) << said;
        EXPECT_NE(said.find(info.name), std::string::npos) << said;
      }
    }
  }
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
