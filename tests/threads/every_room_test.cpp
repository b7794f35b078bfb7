// Every room of the library on several threads: the same result as on one, without reports of the thread sanitizer.
// Clouds are large enough for parallel loops to be divided.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "sansmesh/advice.h"
#include "sansmesh/approximation/approximate_mls.h"
#include "sansmesh/approximation/approximate_mls_choice.h"
#include "sansmesh/approximation/moving_least_squares.h"
#include "sansmesh/approximation/radial_basis.h"
#include "sansmesh/csg/csg_functions.h"
#include "sansmesh/csg/solid.h"
#include "sansmesh/deform/maps/displacement_map.h"
#include "sansmesh/deform/maps/folds.h"
#include "sansmesh/deform/mls/mls_deformation.h"
#include "sansmesh/dynamics/soft_body.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/dynamics/tet_map.h"
#include "sansmesh/field/curvature_field.h"
#include "sansmesh/function/diagnose_function.h"
#include "sansmesh/function/edit_function.h"
#include "sansmesh/function/function_distance.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/function/function_solid.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/function/update_mesh.h"
#include "sansmesh/io.h"
#include "sansmesh/measure/body_measures.h"
#include "sansmesh/measure/distance_map.h"
#include "sansmesh/measure/mesh_signed_distance.h"
#include "sansmesh/measure/section.h"
#include "sansmesh/mesh/edit/simplify.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/meshing/face_csg.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "sansmesh/model/sample_surface.h"
#include "sansmesh/points/cleaning/duplicates.h"
#include "sansmesh/points/cleaning/outliers.h"
#include "sansmesh/points/normals/denoise_normals.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/reconstruct.h"
#include "sansmesh/render/surface/surface_caster.h"
#include "sansmesh/render/surface/surface_picture.h"
#include "sansmesh/render_options.h"
#include "sansmesh/surface/curvature.h"
#include "sansmesh/surface/curvature_colors.h"
#include "sansmesh/surface/lop.h"
#include "sansmesh/volume/grid/assemble_volume.h"
#include "sansmesh/volume/grid/volume_boundary.h"
#include "sansmesh/volume/reconstruction.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/surface_names.h"
#include "support/tet_shapes.h"
#include "volume/volume_grids.h"

namespace sansmesh::inline v1 {
namespace {

namespace fs = std::filesystem;

/// Values of any type, compared bit by bit.
class Findings {
 public:
  template <class T>
  Findings& operator<<(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* bytes = reinterpret_cast<const char*>(values.data());
    bytes_.append(bytes, bytes + values.size() * sizeof(T));
    return *this;
  }
  Findings& operator<<(const std::vector<std::vector<double>>& rows) {
    for (const std::vector<double>& row : rows) *this << row;
    return *this;
  }
  Findings& operator<<(double value) { return *this << std::vector<double>{value}; }
  Findings& operator<<(const TriangleMesh& m) { return *this << m.vertices << m.triangles << m.normals << m.colors; }
  Findings& operator<<(const PointSet& p) { return *this << p.positions << p.normals << p.colors; }
  Findings& operator<<(const Image& image) { return *this << image.pixels; }
  bool operator==(const Findings&) const = default;

 private:
  std::string bytes_;
};

/// A torus with colours, a little noise and no two samples alike.
PointSet colored_torus(std::size_t n) {
  PointSet cloud = test::torus(n);
  for (std::size_t i = 0; i < n; ++i) {
    cloud.colors.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 4), 90});
    cloud.positions[i] += cloud.normals[i] * (0.002f * std::sin(static_cast<float>(7 * i)));
  }
  return cloud;
}

/// Shared, read-only.
const FittedFunction& torus_function() {
  static const FittedFunction function = [] {
    Progress progress;
    return fit_surface_function(colored_torus(12000), {}, progress);
  }();
  return function;
}
const TriangleMesh& torus_mesh() {
  static const TriangleMesh mesh = [] {
    Progress progress;
    return mesh_function(torus_function(), {}, progress);
  }();
  return mesh;
}

std::vector<Vec3> points_about(std::size_t n, double reach) {
  std::vector<Vec3> x(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto t = static_cast<double>(i);
    x[i] = Vec3{std::sin(1.1 * t), std::cos(1.7 * t), 0.4 * std::sin(2.3 * t)} * reach;
  }
  return x;
}

TEST(EveryRoom, PointsArePrepared) {
  test::expect_equal_for_any_threads([] {
    PointSet cloud = colored_torus(40000);
    cloud.positions.insert(cloud.positions.end(), cloud.positions.begin(), cloud.positions.begin() + 5000);
    cloud.colors.insert(cloud.colors.end(), cloud.colors.begin(), cloud.colors.begin() + 5000);
    cloud.normals.clear();
    Progress progress;
    Findings found;
    found << find_duplicates(cloud) << find_outliers(cloud, {}, progress) << static_cast<double>(count_unique(cloud));
    CloudPreparation use;
    use.remove_outliers = true;
    PreparedCloud ready = prepare_cloud(std::move(cloud), use, progress);
    found << ready.points;
    denoise_normals(ready.points, {}, progress);
    return found << ready.points;
  });
}

TEST(EveryRoom, AdviceIsGiven) {
  test::compare_threads(
      [] {
        Progress progress;
        return advise(test::cube(9000), progress);
      },
      [](const Advice& one, const Advice& many) { EXPECT_EQ(one.findings, many.findings); });
}

TEST(EveryRoom, CloudsAreReconstructed) {
  test::expect_equal_for_any_threads([] {
    ReconstructOptions options;
    options.mesh.trim = 0;
    options.mesh.measure_quality = true;
    Progress progress;
    return Findings() << reconstruct(colored_torus(40000), options, progress).mesh
                      << reconstruct(test::cube(9000), {}, progress).mesh;
  });
}

TEST(EveryRoom, FunctionsAreEditedAndJudged) {
  const FittedFunction& function = torus_function();
  const TriangleMesh& mesh = torus_mesh();
  test::expect_equal_for_any_threads([&] {
    Progress progress;
    FunctionEditor editor(function);
    Edit edit;
    edit.select.ball = {Vec3{1, 0, 0}, 0.5};
    Findings found;
    Refit quadrics;
    quadrics.max_degree = 2;
    for (const auto& action : {decltype(edit.action)(quadrics), decltype(edit.action)(SetDegree{1})}) {
      edit.action = action;
      editor.apply(edit, progress);
    }
    found << update_mesh(editor.function(), mesh, editor.changed(), {}, progress);
    const Diagnosis diagnosis = diagnose_function(editor.function(), {}, progress);
    return found << diagnosis.largest_gradient << static_cast<double>(diagnosis.regions.size());
  });
}

TEST(EveryRoom, FieldsAreEvaluated) {
  const FittedFunction& function = torus_function();
  const std::vector<Vec3> x = points_about(20000, 3);
  Progress progress;
  const FunctionDistance distance(std::make_shared<const FittedFunction>(function), progress);
  test::expect_equal_for_any_threads([&] {
    Findings found;
    std::vector<double> values(x.size());
    std::vector<Vec3> gradients(x.size());
    for (const ScalarField* field :
         {static_cast<const ScalarField*>(&function.field), static_cast<const ScalarField*>(&distance)}) {
      field->evaluate(x, values, gradients);
      found << values << gradients;
    }
    std::vector<LevelSetPoint> points(x.size());
    level_set_points(function.field, x, 1e-3, points);
    for (const LevelSetPoint& p : points) found << p.k1 << p.k2;
    return found;
  });
}

TEST(EveryRoom, SolidsAreMeshed) {
  const auto function = std::make_shared<const FittedFunction>(torus_function());
  test::expect_equal_for_any_threads([&] {
    const Solid ball = csg::sphere({1, 0, 0}, 0.5), bar = csg::cylinder({0, 0, 0}, {1, 0, 0}, 0.2, 3);
    Progress progress;
    Findings found;
    CsgMeshReport report;
    found << mesh_csg(csg::subtract(csg::unite(ball, bar), csg::box({0.8, -1, 0.1}, {2, 1, 1})), {.resolution = 48},
                      progress, &report)
          << report.volume;
    CsgMeshReport by_faces;
    const auto faces = mesh_of_faces(csg::subtract(csg::unite(ball, bar), csg::box({0.8, -1, 0.1}, {2, 1, 1})), {},
                                     progress, by_faces);
    found << faces.value();
    return found << mesh_csg(csg::subtract(function_solid(function), ball), {.resolution = 48}, progress);
  });
}

TEST(EveryRoom, MeshesAreSimplifiedAndMeasured) {
  const TriangleMesh& mesh = torus_mesh();
  test::expect_equal_for_any_threads([&] {
    Progress progress;
    Findings found;
    TriangleMesh coarse = mesh;
    simplify_mesh(coarse, {.error = 1e-4, .triangles = 1500}, progress);
    const SurfaceDistance distance = measure_distance(coarse, mesh, {.samples = 40000}, progress);
    const DistanceMap map = distance_map(coarse, *signed_distance(mesh), {}, progress);
    found << coarse << distance.to_reference.mean << distance.from_reference.rms << map.distance;
    found << static_cast<double>(measure_topology(mesh).euler) << measure_quality(mesh).aspect_mean;
    const SolidMeasures solid = measure_solid(mesh);
    found << solid.whole.mass->volume;
    for (const Section& s : section_mesh(mesh, plane_series(2, -0.3, 0.13, 5), progress)) found << s.length;
    for (const Section& s :
         section_field(torus_function().field, middle_planes(torus_function().field.bounds()), {}, progress))
      found << s.area;
    const auto samples = sample_triangles(mesh.vertices, mesh.triangles, 20000);
    for (const FaceSample& s : samples) found << s.position.x;
    return found;
  });
}

class EverySurface : public testing::TestWithParam<std::string> {};

TEST_P(EverySurface, IsShownAndSampled) {
  const PointSet cloud = colored_torus(3000);
  SurfaceOptions options;
  options.method = GetParam();
  if (options.method == "apss" || options.method == "levin") options.sharp = SharpFormula::bilateral;
  if (options.method == "amls") options.order = 4, options.iterations = 3;
  test::expect_equal_for_any_threads([&] {
    Progress progress;
    const SurfaceModel model = make_surface_model(cloud, options, progress);
    SurfaceRenderOptions picture;
    picture.picture.view.width = 90, picture.picture.view.height = 70, picture.picture.quality.samples = 1,
    picture.reflection = 0.3;
    SurfaceCastOptions cast;
    cast.normals = model.normals();
    const SurfaceCaster caster = model.projection() ? SurfaceCaster(*model.projection(), model.balls(), cast)
                                                    : SurfaceCaster(model.field(progress), model.balls(), cast);
    Findings found;
    found << render_surface(caster, model.points().positions, model.colors(), picture, progress);
    return found << project_points(cloud, model, {}, progress) << resample_surface(model, 1000, {}, progress);
  });
}

INSTANTIATE_TEST_SUITE_P(Named, EverySurface, testing::ValuesIn(test::surface_names()),
                         [](const auto& tested) { return tested.param; });

TEST(EveryRoom, SurfacesWithoutAMeshAreMeshed) {
  test::expect_equal_for_any_threads([] {
    Progress progress;
    Findings found;
    ReconstructOptions options;
    for (const char* const method : {"apss", "curvature"}) {
      options.surface = {.method = method, .sharp = SharpFormula::bilateral};
      found << reconstruct(test::torus(2500), options, progress).mesh;
    }
    return found;
  });
}

TEST(EveryRoom, SamplesAreJudgedAndConsolidated) {
  test::expect_equal_for_any_threads([] {
    const PointSet cloud = test::torus(9000);
    Progress progress;
    Findings found;
    for (const FittedCurvatures& c : estimate_curvatures(cloud, {}, progress)) found << c.k1 << c.k2;
    const CurvatureColors colors(cloud, {}, progress);
    const std::vector<Vec3> x(cloud.positions.begin(), cloud.positions.end());
    std::vector<Vec3f> shown(x.size());
    colors.evaluate(x, shown);
    LopOptions lop;
    lop.points = 3000;
    lop.iterations = 3;
    return found << shown << consolidate(cloud, lop, progress);
  });
}

TEST(EveryRoom, PicturesArePainted) {
  const TriangleMesh& mesh = torus_mesh();
  test::expect_equal_for_any_threads([&] {
    RenderOptions options;
    options.view.width = 200, options.view.height = 150;
    TriangleMesh cloud = mesh;
    cloud.triangles.clear();
    return Findings() << render_mesh(mesh, options) << render_mesh(cloud, options);
  });
}

template <class Approximation>
void add_values(Findings& found, const Approximation& f, const std::vector<Position<2>>& x) {
  std::vector<double> values(x.size());
  f.evaluate(x, values);
  found << values;
}

TEST(EveryRoom, ValuesAreApproximated) {
  std::vector<Position<2>> x;
  std::vector<double> f;
  for (const Vec3& p : points_about(2500, 1)) {
    x.push_back({p.x, p.y});
    f.push_back(std::sin(3 * p.x) * p.y);
  }
  test::expect_equal_for_any_threads([&] {
    Findings found;
    for (const RbfSolver solver : {RbfSolver::kDense, RbfSolver::kSparse, RbfSolver::kLocal}) {
      const bool sparse = solver == RbfSolver::kSparse;
      add_values(
          found,
          RbfInterpolant<2>(
              x, f, {.function = sparse ? RadialFunction::kWendlandC4 : RadialFunction::kBiharmonic, .solver = solver}),
          x);
    }
    add_values(found, MovingLeastSquares<2>(x, f), x);
    add_values(found, ApproximateMls<2>(x, f), x);
    ApproximateMlsSearch search;
    search.shapes = {2, 3}, search.max_iterations = 2, search.left_out = 20, search.max_samples = 1000;
    return found << choose_shape_and_iterations<2>(x, f, {}, search).errors;
  });
}

TEST(EveryRoom, VolumesAreAsked) {
  const GridData data = test::three_overlapping_blocks(8, test::linear_function);
  test::expect_equal_for_any_threads([&] {
    Findings found;
    for (const Association a : {Association::points, Association::cells}) {
      Progress progress;
      const auto volume = std::make_shared<const SampledVolume>(assemble_volume(data, a, progress));
      VolumeReconstructionOptions options;
      options.method = "linear";
      const auto field = reconstruct_volume(volume, "f", options, progress);
      const auto x = points_about(3000, 1);
      std::vector<double> values(x.size());
      field->evaluate(x, {values});
      found << values << volume->stars.entries << volume_boundary(*volume).triangles;
    }
    return found;
  });
}

TEST(EveryRoom, SpaceIsDeformed) {
  std::vector<Handle> handles;
  for (const Vec3& q : points_about(12, 1)) {
    Handle h;
    h.q = q, h.p = q + Vec3{0.3 * q.y, 0, 0.1};
    handles.push_back(h);
  }
  const Box3 box{{-1, -1, -1}, {1, 1, 1}};
  test::expect_equal_for_any_threads([&] {
    Findings found;
    Progress progress;
    const MlsDeformation map(handles, {});
    const FoldReport folds = find_folds(map, box, {12, 12, 12}, progress);
    return found << displacement_map(map, box, {24, 24, 24}, progress).displacements().copy()
                 << *folds.determinants.point_arrays.find<float>("determinant");
  });
}

TEST(EveryRoom, BodiesFall) {
  test::expect_equal_for_any_threads([] {
    Findings found;
    const TetMesh mesh = test::box_of_tets({0, 0, 0.001}, {1, 1, 1}, 14, 14, 14);
    DynamicsScene scene;
    scene.floors.push_back({{0, 0, 0}, {0, 0, 1}, 0.5});
    for (const SoftBodyModel model : {SoftBodyModel::springs, SoftBodyModel::corotational}) {
      SoftBodyOptions options;
      options.model = model;
      SoftBody body(mesh, options, scene);
      body.advance(0.03);
      const TetMap map(mesh.tets, body.positions(), mesh.vertices);
      std::vector<Vec3> there(mesh.vertices.size());
      map.map(mesh.vertices, {there, {}, {}, {}});
      found << body.positions() << there;
    }
    return found;
  });
}

TEST(EveryRoom, FilesAreWrittenAndRead) {
  const fs::path folder = fs::temp_directory_path() / ("sansmesh_threads_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const PointSet cloud = colored_torus(40000);
  test::expect_equal_for_any_threads([&] {
    Findings found;
    for (const char* name : {"c.ply", "c.xyz", "c.csv", "c.pcd"}) {
      write_points(folder / name, cloud);
      found << read_points(folder / name);
    }
    write_points(folder / "text.ply", cloud, {.ascii = true});
    found << read_points(folder / "text.ply");
    for (const char* name : {"m.ply", "m.obj", "m.off", "m.stl"}) {
      write_mesh(folder / name, torus_mesh(), {.ascii = true});
      found << read_mesh(folder / name);
    }
    for (const char* name : {"b.glb", "b.ply", "b.stl"}) write_mesh(folder / name, torus_mesh());
    found << read_mesh(folder / "b.ply") << read_mesh(folder / "b.stl");
    write_fitted_function(folder / "f.smf", torus_function());
    std::vector<double> values(2000);
    read_fitted_function(folder / "f.smf").field.evaluate(points_about(2000, 2), values);
    return found << values;
  });
  fs::remove_all(folder);
}

}  // namespace
}  // namespace sansmesh::inline v1
