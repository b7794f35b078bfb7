// Function files are read back to the bit.
#include <cmath>
#include <random>

#include "function/edit_shapes.h"
#include "io/io_test_tools.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/reconstruct.h"
#include "sansmesh/surface_function.h"
#include "support/any_threads.h"
#include "support/same_bytes.h"
#include "support/section_bytes.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// Survey coordinates: far from zero, and in a small unit.
PointSet moved_far(PointSet cloud) {
  cloud.origin = {431234.5, 5812345.25, 812};
  for (Vec3f& p : cloud.positions) p *= 0.01f;
  return cloud;
}

std::vector<Vec3> places(const FittedFunction& function, std::size_t n = 4000) {
  const Box3 box = function.field.bounds();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-0.5, 1.5);
  std::vector<Vec3> result = function.field.seeds();
  while (result.size() < n) {
    const Vec3 t{uniform(random), uniform(random), uniform(random)}, size = box.upper - box.lower;
    result.push_back(box.lower + Vec3{t.x * size.x, t.y * size.y, t.z * size.z});
  }
  return result;
}

void expect_same_function(const FittedFunction& a, const FittedFunction& b) {
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.field.bounds().lower, b.field.bounds().lower);
  EXPECT_EQ(a.field.bounds().upper, b.field.bounds().upper);
  const std::vector<Vec3> x = places(a);
  std::vector<double> va(x.size()), vb(x.size());
  std::vector<Vec3> ga(x.size()), gb(x.size());
  a.field.evaluate(x, va, ga);
  b.field.evaluate(x, vb, gb);
  EXPECT_TRUE(same_bytes(va, vb));
  EXPECT_TRUE(same_bytes(ga, gb));
}

void expect_same_mesh(const TriangleMesh& a, const TriangleMesh& b) {
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_TRUE(same_bytes(a.vertices, b.vertices));
  EXPECT_TRUE(same_bytes(a.triangles, b.triangles));
  EXPECT_TRUE(same_bytes(a.normals, b.normals));
  EXPECT_TRUE(same_bytes(a.colors, b.colors));
}

TEST(FunctionFile, ReadIsWhatWasWritten) {
  const Folder folder;
  FitOptions smooth;
  smooth.sharp = false, smooth.degree = 2, smooth.support = 1.4, smooth.depth = 6, smooth.error = 1e-3;
  const std::pair<PointSet, FitOptions> cases[] = {{sphere(1500), {}},
                                                   {colored(cube(6000)), {}},
                                                   {moved_far(colored(torus(2000))), {}},
                                                   {sphere(2000, 0.01), smooth}};
  for (const auto& [cloud, options] : cases) {
    const FittedFunction before = fitted(cloud, options);
    for (const char* name : {"f.smf", "f.smf.gz"}) {
      write_fitted_function(folder / name, before);
      const FittedFunction after = read_fitted_function(folder / name);
      expect_same_function(before, after);
      const PointSet &a = *before.samples, &b = *after.samples;
      EXPECT_EQ(a.origin, b.origin);
      EXPECT_TRUE(same_bytes(a.positions, b.positions));
      EXPECT_TRUE(same_bytes(a.normals, b.normals));
      EXPECT_TRUE(same_bytes(a.colors, b.colors));
      const PartitionReport &r = before.field.report(), &s = after.field.report();
      EXPECT_EQ(r.noise, s.noise);
      EXPECT_EQ(r.error, s.error);
      EXPECT_EQ(r.accuracy, s.accuracy);
      EXPECT_EQ(r.area, s.area);
      EXPECT_EQ(r.spacing, s.spacing);
      EXPECT_EQ(r.depth, s.depth);
      EXPECT_EQ(r.functions, s.functions);
      EXPECT_EQ(r.functions_of_degree, s.functions_of_degree);
      EXPECT_EQ(r.creased, s.creased);
      const PartitionOptions &o = before.field.data().options, &q = after.field.data().options;
      EXPECT_EQ(o.max_depth, q.max_depth);
      EXPECT_EQ(o.error, q.error);
      EXPECT_EQ(o.support, q.support);
      EXPECT_EQ(o.max_degree, q.max_degree);
      EXPECT_EQ(o.coverage, q.coverage);
      EXPECT_EQ(o.sharp, q.sharp);
      EXPECT_EQ(before.field.data().basis.variance, after.field.data().basis.variance);
      EXPECT_EQ(before.field.data().basis.finest, after.field.data().basis.finest);
      // Writing it again gives the same file.
      write_fitted_function(folder / (std::string("again") + name), after);
      EXPECT_EQ(slurp(folder / name), slurp(folder / (std::string("again") + name)));
    }
    expect_same_mesh(meshed(before), meshed(read_fitted_function(folder / "f.smf")));
  }
}

/// A fit by the published method has the same values after reading, also beyond the cube, and the same walk through its
/// blocks.
TEST(FunctionFile, KeepsFitsOfThePaper) {
  Progress progress;
  FitOptions options;
  options.fit = FitMethod::paper;
  options.threshold = 5e-4;
  options.coverage = kPaperCoverage;
  const FittedFunction function = fit_surface_function(moved_far(torus(4000)), options, progress);
  const Folder folder;
  write_fitted_function(folder / "paper.smf", function);
  const FittedFunction read = read_fitted_function(folder / "paper.smf");
  expect_same_function(function, read);
  ASSERT_TRUE(read.field.data().paper);
  EXPECT_EQ(read.field.data().paper->threshold, 5e-4);
  EXPECT_EQ(read.field.data().paper->coverage, kPaperCoverage);
  MeshReport report;
  const TriangleMesh mesh = mesh_function(function, {}, progress, &report);
  EXPECT_GT(report.simplices, 0u);
  EXPECT_TRUE(measure_topology(mesh).closed());
  expect_same_mesh(mesh, mesh_function(read, {}, progress));
  // Whole blocks are also available, and are enhanced.
  MeshOptions blocks;
  blocks.mesher = Mesher::blocks;
  const TriangleMesh other = mesh_function(read, blocks, progress, &report);
  EXPECT_EQ(report.simplices, 0u);
  EXPECT_LT(other.triangles.size(), mesh.triangles.size());
  EXPECT_TRUE(measure_topology(other).closed());
}

TEST(FunctionFile, RemembersThatItsSamplesAreOfFaces) {
  const Folder folder;
  const PointSet mesh = joined_meshes(ball_mesh(5), ball_mesh(1), 0.06f, {1.5f, 0.2f, 0});
  PointSet cloud = mesh;
  cloud.triangles.clear();
  for (const PointSet& points : {mesh, cloud}) {
    const FittedFunction before = fitted(points);
    write_fitted_function(folder / "f.smf", before);
    const FittedFunction after = read_fitted_function(folder / "f.smf");
    EXPECT_EQ(before.samples->of_faces, !points.triangles.empty());
    EXPECT_EQ(after.samples->of_faces, before.samples->of_faces);
    EXPECT_EQ(find_components(meshed(after)).size(), points.triangles.empty() ? 1u : 2u);
    expect_same_mesh(meshed(before), meshed(after));
  }
}

/// Files of version 1.0 have no slopes: they are computed from the functions, with the same result.
TEST(FunctionFile, OldFilesGetTheirSlopes) {
  const Folder folder;
  FittedFunction before = fitted(colored(cube(4000)));
  const std::span<const float> slopes = before.field.data().slopes.view();
  EXPECT_EQ(slopes.size(), before.field.functions().size());
  write_fitted_function(folder / "new.smf", before);
  std::vector<RawSection> sections = unpacked(slurp(folder / "new.smf"));
  ASSERT_EQ(std::erase_if(sections, [](const RawSection& s) { return s.name == "SLOPE"; }), 1u);
  const FittedFunction old = read_fitted_function(folder.put("old.smf", packed(sections)));
  EXPECT_TRUE(same_bytes(old.field.data().slopes.view(), slopes));
  EXPECT_TRUE(same_bytes(read_fitted_function(folder / "new.smf").field.data().slopes.view(), slopes));
  expect_same_function(before, old);
  write_fitted_function(folder / "again.smf", old);
  EXPECT_EQ(slurp(folder / "again.smf"), slurp(folder / "new.smf"));
}

TEST(FunctionFile, ReconstructIsFitAndMesh) {
  const Folder folder;
  const PointSet cloud = moved_far(colored(torus(2500)));
  Progress progress;
  const TriangleMesh whole = reconstruct(cloud, {}, progress).mesh;
  write_fitted_function(folder / "f.smf", fitted(cloud));
  expect_same_mesh(whole, meshed(read_fitted_function(folder / "f.smf")));
}

TEST(FunctionFile, WithoutSamples) {
  const Folder folder;
  const FittedFunction before = fitted(colored(sphere(1500)));
  write_fitted_function(folder / "all.smf", before);
  write_fitted_function(folder / "f.smf", before, false);
  EXPECT_LT(std::filesystem::file_size(folder / "f.smf") + 1500 * 27, std::filesystem::file_size(folder / "all.smf"));
  const FittedFunction after = read_fitted_function(folder / "f.smf");
  ASSERT_NE(after.samples, nullptr);
  EXPECT_EQ(after.samples->size(), 0u);
  expect_same_function(before, after);
  const TriangleMesh mesh = meshed(after);
  EXPECT_GT(mesh.triangles.size(), 100u);
  EXPECT_TRUE(mesh.colors.empty());
  MeshOptions trim;
  trim.trim = 0;
  EXPECT_THROW(meshed(after, trim), DataError);
}

TEST(FunctionFile, HistoryIsKeptLineByLine) {
  const Folder folder;
  FittedFunction function = fitted(sphere(500));
  function.history = {"fit of 'scan \"2\".ply'", "Größe: 3 µm", "not UTF-8: \xff", "two\nlines\x1b[31m"};
  write_fitted_function(folder / "f.smf", function);
  const std::vector<std::string> history = read_fitted_function(folder / "f.smf").history;
  ASSERT_EQ(history.size(), 4u);
  EXPECT_EQ(history[0], function.history[0]);
  EXPECT_EQ(history[1], function.history[1]);
  EXPECT_EQ(history[2], "not UTF-8: \xef\xbf\xbd");
  EXPECT_EQ(history[3], R"(two\x0alines\x1b[31m)");
}

TEST(FunctionFile, SameBytesWhateverTheThreads) {
  const Folder folder;
  const PointSet cloud = colored(torus(3000));
  expect_equal_for_any_threads([&] {
    write_fitted_function(folder / "f.smf", fitted(cloud));
    return slurp(folder / "f.smf");
  });
}

TEST(FunctionFile, EveryValueIsFinite) {
  const Folder folder;
  write_fitted_function(folder / "f.smf", fitted(cube(3000)));
  const FittedFunction function = read_fitted_function(folder / "f.smf");
  std::vector<Vec3> x = places(function);
  for (const double far : {1e3, 1e6, 1e12, 1e20, 1e30, 1e100})
    for (const Vec3& d : {Vec3{1, 0, 0}, Vec3{-1, 0.1, 3}, Vec3{0, 0, -1}}) x.push_back(d * far);
  std::vector<double> values(x.size());
  std::vector<Vec3> gradients(x.size());
  function.field.evaluate(x, values, gradients);
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_TRUE(std::isfinite(values[i]) && is_finite(gradients[i])) << norm(x[i]);
    if (norm(x[i]) > 100) {
      ASSERT_GT(values[i], 10) << norm(x[i]);
    }
  }
}

TEST(FunctionFile, NamesOfFunctionFiles) {
  EXPECT_TRUE(is_function_file("a.smf"));
  EXPECT_TRUE(is_function_file("a.smf.gz"));
  EXPECT_FALSE(is_function_file("a.ply"));
  EXPECT_FALSE(is_function_file("smf"));
  EXPECT_FALSE(is_function_file(""));
}

TEST(FunctionFile, WritesNothingThatCannotBeRead) {
  const Folder folder;
  const FittedFunction good = fitted(sphere(500));
  PartitionData data = good.field.data();
  std::vector<LocalFunction> functions = data.functions.copy();
  functions[3].coefficient[0] = std::nanf("");
  data.functions = std::move(functions);
  const FittedFunction bad{PartitionOfUnity(std::move(data)), good.frame, good.samples, {}, {}};
  expect_file_error(folder / "f.smf", "a support is invalid", [&] { write_fitted_function(folder / "f.smf", bad); });
  expect_file_error(folder / "absent/f.smf", "", [&] { write_fitted_function(folder / "absent/f.smf", good); });
  EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace
}  // namespace sansmesh::inline v1
