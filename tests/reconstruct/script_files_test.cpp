// Optional test, if ../shared exists next to the checkout: edits that `diagnose` proposes for a real scan leave no more
// of its samples without a surface. tests/function/diagnose_function_test.cpp has synthetic scenes.
#include <gtest/gtest.h>

#include <filesystem>

#include "sansmesh/function/diagnose_function.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh/mesh_coverage.h"
#include "support/places.h"

namespace sansmesh::inline v1 {
namespace {

/// Share of all samples; the fitted function determines which count as lost.
double share_lost(const FittedFunction& function, const PartitionReport& fitted) {
  Progress progress;
  TriangleMesh mesh = mesh_function(function, {}, progress);
  move_from_input(mesh, function.frame);
  return find_lost(mesh, *function.samples, fitted.spacing, fitted.noise).share;
}

class ExtraScripts : public ::testing::TestWithParam<const char*> {};

TEST_P(ExtraScripts, TakeNoSurfaceAwayFromSamples) {
  const std::string file = test::shared_points(GetParam());
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "an extra: there is no " << file;
  Progress progress;
  const FittedFunction function = fit_surface_function(read_points(file), {}, progress);
  FunctionEditor editor(function);
  for (const Edit& edit : diagnose_function(function, {}, progress).edits()) editor.apply(edit, progress);
  const PartitionReport& fitted = function.field.report();
  EXPECT_LE(share_lost(editor.function(), fitted), share_lost(function, fitted) + 1.0 / 20000 + 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Scans, ExtraScripts,
                         ::testing::Values("bunny_noised_20k.xyz", "bunny_scans/bun.conf", "elephant-with-holes.off",
                                           "hippo1.ply", "lidar_autzen_trim.las", "lidar_samp11.pcd", "oni.pwn",
                                           "sphere_20k_noisy.xyz", "vase_sfm_owl.vtp"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           for (char& c : name)
                             if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                           return name;
                         });

}  // namespace
}  // namespace sansmesh::inline v1
