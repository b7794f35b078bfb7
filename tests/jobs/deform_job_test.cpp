// Tests of deformation jobs: choices, reports, errors, and poses. The accuracy of the maps is tested in tests/deform.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "sansmesh/csg/solid.h"
#include "sansmesh/deform.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/meshes/solid_parts.h"
#include "sansmesh/mesh_measures.h"
#include "support/mesh_shapes.h"
#include "support/notes.h"

namespace sansmesh::test {
namespace {

/// The corners of a cube of side 2 about the origin, moved by `way`.
std::vector<Handle> corners(const std::function<Vec3(const Vec3&)>& way) {
  std::vector<Handle> handles(8);
  for (int i = 0; i < 8; ++i) {
    Handle& h = handles[static_cast<std::size_t>(i)];
    h.p = {i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0};
    h.q = way(h.p);
  }
  return handles;
}

Deformation moved_by(const Vec3& shift) {
  return Deformation(corners([&](const Vec3& p) { return p + shift; }));
}

/// Two neighbours exchange positions.
Deformation crossed() {
  std::vector<Handle> handles = corners([](const Vec3& p) { return p; });
  std::swap(handles[0].q, handles[1].q);
  return Deformation(handles);
}

PointSet cloud() {
  PointSet points;
  points.positions = {{0.5f, 0, 0}, {0, 0.25f, 0}, {0, 0, -1}};
  return points;
}

PointSet as_points(const TriangleMesh& mesh) {
  PointSet points;
  points.positions = mesh.vertices;
  points.triangles = mesh.triangles;
  return points;
}

SolidModel ball(double radius) { return SolidModel(SolidParts{"ball", csg::sphere({}, radius)}); }

std::string refused(const std::function<void()>& call) {
  try {
    call();
  } catch (const ArgumentError& error) {
    return error.what();
  }
  return "";
}

const UsePose kIgnore = [](int, const DeformedPose&) {};

TEST(DeformationValue, IsSharedAndNamesWhatIsWrong) {
  Deformation copy = moved_by({3, 0, 0});
  {
    const Deformation other = moved_by({0, 0, 2});
    copy = other;
  }
  std::vector<Vec3> x = {{0.5, 0, 0}}, moved(1);
  copy.at(1).forward->map(x, {moved, {}, {}, {}});
  EXPECT_LT(norm(moved[0] - Vec3{0.5, 0, 2}), 1e-9);
  copy.at(0).forward->map(x, {moved, {}, {}, {}});
  EXPECT_LT(norm(moved[0] - x[0]), 1e-9);
  EXPECT_EQ(copy.words(), "8 handles, rigid");
  EXPECT_EQ(copy.at(1).forward, copy.at(1).forward);

  const std::vector<Handle> two = {{.p = {0, 0, 0}, .q = {1, 0, 0}}, {.p = {1, 0, 0}, .q = {2, 0, 0}}};
  EXPECT_THROW(Deformation(two, {.kind = DeformationKind::affine}), ArgumentError);
  EXPECT_THROW(Deformation(two, {.kind = DeformationKind::affine}, {}, "two.json"), FileError);
}

TEST(DeformationInput, SaysWhatDoesNotGoTogether) {
  const auto said = [](const DeformationInput& input) { return refused([&] { input.validate(); }); };
  EXPECT_NE(said({}).find("one of `handles`"), std::string::npos);
  EXPECT_NE(said({.handles = "a.json", .map = "b.vti"}).find("one of"), std::string::npos);
  EXPECT_NE(said({.handles_from = {"a.ply"}}).find("two files"), std::string::npos);
  EXPECT_NE(said({.handles = "a.json", .vertices = {1}}).find("`handles_from`"), std::string::npos);
  EXPECT_NE(said({.handles_from = {"a", "b"}, .vertices = {1}, .handle_count = 3}).find("exclude"), std::string::npos);
  EXPECT_NE(said({.handles = "a.json", .by = {.degree = 3}}).find("nonlinear"), std::string::npos);
  EXPECT_NE(said({.handles = "a.json", .by = {.damping = 3}}).find("`cut`"), std::string::npos);
  EXPECT_NE(said({.map = "a.vti", .by = {.alpha = 2}}).find("`alpha`"), std::string::npos);
  EXPECT_EQ(said({.handles = "a.json", .by = {.alpha = 2}}), "");
}

TEST(DeformationInput, ReadsListsAsUsersWriteThem) {
  DeformationInput input;
  for_each_option(DeformationInput::schema(), &input, [&](const OptionRow& row, void* owner) {
    if (row.name == "vertices") set_option(row, owner, std::string("10, 200"));
    if (row.name == "handles_from") set_option(row, owner, std::string("a.ply,b.ply"));
    if (row.name == "kind") set_option(row, owner, std::string("affine"));
    if (row.name == "vertices") {
      EXPECT_THROW(set_option(row, owner, std::string("1,x")), ArgumentError);
      EXPECT_EQ(option_words(option_value(row, owner)), "10,200");
    }
  });
  EXPECT_EQ(input.vertices, (std::vector<std::uint32_t>{10, 200}));
  EXPECT_EQ(input.handles_from, (std::vector<std::string>{"a.ply", "b.ply"}));
  EXPECT_EQ(input.by.kind, DeformationKind::affine);
}

TEST(ReadDeformation, HandlesAndTheMapThatIsMadeOfThem) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "deform_job_handles.csv";
  std::ofstream(file) << "0,0,0,1,0,0\n1,0,0,2,0,0\n0,1,0,1,1,0\n";
  Progress progress;
  const Deformation read = read_deformation({.handles = file.string()}, progress);
  std::filesystem::remove(file);
  EXPECT_EQ(read.words(), "3 handles, rigid");
  EXPECT_EQ(read.name(), file.string());

  const DeformationMapResult made = deformation_map(read, {{0, 0, 0}, {1, 1, 1}}, "box", {.nodes = 8}, progress);
  EXPECT_TRUE(made.notes.empty());
  const Deformation again(made.block);
  EXPECT_FALSE(again.has_handles());
  EXPECT_EQ(again.words(), "by a displacement map");
  std::vector<Vec3> moved(1);
  again.at(1).forward->map(std::vector<Vec3>{{0.5, 0.5, 0.5}}, {moved, {}, {}, {}});
  EXPECT_LT(norm(moved[0] - Vec3{1.5, 0.5, 0.5}), 1e-5);
  EXPECT_NE(refused([&] {
              deformation_map(read, {{0, 0, 0}, {1, 1, INFINITY}}, "box", {}, progress);
            }).find("bounded"),
            std::string::npos);
}

TEST(ReadCut, SaysWhatIsWrong) {
  const Box3 box{{-1, -1, -1}, {1, 1, 1}};
  EXPECT_NE(read_cut(" half-plane(0,0,0; 0,0,1; 1,0,0) ", box), nullptr);
  EXPECT_NE(read_cut("polygon(0,0,0; 4,0,0; 4,4,0 | 3,1,0; 3.5,1,0; 3.5,2,0)", box), nullptr);
  for (const char* text : {"half-plane(0,0,0; 0,0,1)", "half-plane(0,0,0; 0,0,one; 1,0,2)", "polygon(0,0,0; 1,0,0)",
                           "polygon(0,0,0; 1,0,0; 0,1,0", "plane(0,0,1)"})
    EXPECT_NE(refused([&] { read_cut(text, box); }).find("`cut` "), std::string::npos) << text;
  EXPECT_THROW(read_cut("nothing.ply", box), FileError);
}

TEST(DeformJob, PosesGoFromBeforeToAfter) {
  Progress progress;
  std::vector<Vec3> places;
  const DeformResult result = deform(
      cloud(), "cloud", moved_by({2, 0, 0}), DeformAim::shape, {.frames = 3},
      [&](int pose, const DeformedPose& made) {
        EXPECT_EQ(pose, static_cast<int>(places.size()));
        const PointSet& points = std::get<PointSet>(made);
        places.push_back(points.origin + Vec3(points.positions[0]));
      },
      progress);
  ASSERT_EQ(places.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(norm(places[k] - Vec3{0.5 + static_cast<double>(k), 0, 0}), 1e-6);
  EXPECT_EQ(result.report.vertices, 3u);
  EXPECT_TRUE(result.notes.empty());
}

TEST(DeformJob, MeshesAreRefinedAndOpenedAlongCuts) {
  Progress progress;
  const PointSet mesh = as_points(octasphere(3));
  const Deformation bent(corners([](const Vec3& p) { return p.z > 0 ? Vec3{-p.y, p.x, p.z} : p; }));
  const DeformReport plain = deform(mesh, "m", bent, DeformAim::shape, {}, kIgnore, progress).report;
  EXPECT_EQ(plain.triangles, mesh.triangles.size());
  const DeformReport fine = deform(mesh, "m", bent, DeformAim::shape, {.refine = 0.005}, kIgnore, progress).report;
  EXPECT_GT(fine.added, 0u);

  const auto slot = read_cut("half-plane(-0.1,0,0.01; 0,0,1; 1,0,0)", {});
  const Deformation cut(corners([](const Vec3& p) { return Vec3{p.x, p.y, p.x > 0 ? 1.4 * p.z : p.z}; }), {}, {slot});
  std::size_t loops = 0;
  const UsePose look = [&](int, const DeformedPose& made) {
    loops = measure_topology(std::get<TriangleMesh>(made)).boundary_loops;
  };
  EXPECT_GT(deform(mesh, "m", cut, DeformAim::shape, {}, look, progress).report.cut->faces, 0u);
  EXPECT_EQ(loops, 0u);
  EXPECT_EQ(deform(mesh, "m", cut, DeformAim::shape, {.cut_open = true}, look, progress).report.cut->faces, 0u);
  EXPECT_EQ(loops, 1u);
}

TEST(DeformJob, SolidsBecomeMeshesSectionsAndPictures) {
  Progress progress;
  const Deformation moved = moved_by({3, 0, 0});
  const DeformResult mesh = deform(ball(1), moved, DeformAim::shape, {.resolution = 24}, kIgnore, progress);
  ASSERT_TRUE(mesh.report.solid.has_value());
  EXPECT_TRUE(mesh.report.solid->closed);
  EXPECT_NEAR(mesh.report.solid->volume, 4.19, 0.1);
  const DeformResult cut =
      deform(ball(1), moved, DeformAim::sections, {.planes = {parse_plane("x=3")}}, kIgnore, progress);
  ASSERT_EQ(cut.report.sections.size(), 1u);
  EXPECT_NEAR(cut.report.sections[0].area, 3.14159, 1e-3);
  EXPECT_EQ(deform(ball(1), moved, DeformAim::sections, {}, kIgnore, progress).report.sections.size(), 3u);
  DeformOptions look{.resolution = 16, .draw_handles = true};
  look.look.picture.view.width = 32, look.look.picture.view.height = 24;
  int width = 0;
  deform(
      ball(1), moved, DeformAim::picture, look,
      [&](int, const DeformedPose& made) { width = std::get<DeformedPicture>(made).image.width; }, progress);
  EXPECT_EQ(width, 32);
}

TEST(DeformJob, VolumesAreResampledAndSeenThrough) {
  GridBlock block;
  block.kind = GridKind::lattice;
  for (std::size_t k = 0; k < 3; ++k) block.axes[k] = {-2, -1, 0, 1, 2};
  std::vector<float> height, flow;
  for (int i = 0; i < 125; ++i)
    height.push_back(std::floor(0.04f * static_cast<float>(i) + 0.001f) - 2), flow.insert(flow.end(), {0, 3, 4});
  block.point_arrays.set("height", std::move(height));
  block.point_arrays.set("flow", std::move(flow), 3);
  GridData data;
  data.blocks.push_back(std::move(block));
  VolumeModel volume(std::move(data), "block.vti");
  Progress progress;
  std::vector<Note> notes;
  const Deformation moved = moved_by({5, 0, 0});

  const DeformableVolume all = deformable_volume(volume, DeformAim::shape, true, progress, notes);
  EXPECT_EQ(all.arrays, (std::vector<std::string>{"height", "flow"}));
  const DeformResult lattice = deform(
      all, moved, DeformAim::shape, {.box = Box3{{3, -2, -2}, {7, 2, 2}}, .lattice = {.size = {9}}},
      [](int, const DeformedPose& made) {
        const GridBlock& on = std::get<GridBlock>(made);
        const Attribute* const values = on.point_arrays.find("height");
        ASSERT_NE(values, nullptr);
        EXPECT_NEAR(values->number(4 + 9 * (4 + 9 * 6)), 1, 1e-4);  // at (5, 0, 1)
        EXPECT_NE(on.point_arrays.find("flow"), nullptr);
      },
      progress);
  EXPECT_EQ(lattice.report.size[0], 9u);
  EXPECT_NEAR(lattice.report.inside.value(), 1, 0.4);  // except its faces

  volume = VolumeModel(volume, {.array = "flow"});
  const DeformableVolume seen = deformable_volume(volume, DeformAim::picture, false, progress, notes);
  EXPECT_EQ(seen.fields.at(0)->components(), 1u);
  DeformOptions options{.map_nodes = 8};
  options.look.picture.view.width = 32, options.look.picture.view.height = 24;
  const DeformResult drawn = deform(
      seen, moved, DeformAim::picture, options,
      [](int, const DeformedPose& made) { EXPECT_EQ(std::get<DeformedPicture>(made).image.width, 32); }, progress);
  EXPECT_GT(drawn.report.rays, 0u);
  EXPECT_NE(refused([&] { deform(seen, moved, DeformAim::sections, {}, kIgnore, progress); }), "");
}

TEST(DeformJob, FoldsAreNotedWithTheRemedy) {
  Progress progress;
  const DeformResult folded = deform(ball(1), crossed(), DeformAim::sections, {}, kIgnore, progress);
  ASSERT_TRUE(has_note(folded.notes, "folded"));
  EXPECT_GT(folded.report.folds.share, 0.001);
  EXPECT_NE(folded.notes.back().remedy.find("`alpha`"), std::string::npos);
  EXPECT_EQ(folded.notes.back().of, "ball");
  const DeformResult points = deform(as_points(octasphere(2)), "c", crossed(), DeformAim::shape, {}, kIgnore, progress);
  EXPECT_TRUE(has_note(points.notes, "folded"));
}

TEST(DeformJob, TakesThingsOfAnyKind) {
  EXPECT_EQ(deform_kind({"box(2) - sphere(1)"}), DeformKind::solid);
  EXPECT_EQ(deform_kind({"data.vtu[t=3]"}), DeformKind::solid);
  EXPECT_EQ(deform_kind({"a.mhd", "b.mhd"}), DeformKind::volume);
  EXPECT_EQ(deform_kind({"a.ply", "b.mhd"}), DeformKind::points);
  EXPECT_THROW(deform_kind({"none.ply"}), FileError);
  EXPECT_EQ(deform_aim("a.png"), DeformAim::picture);
  EXPECT_EQ(deform_aim("a.svg"), DeformAim::sections);
  EXPECT_THROW(check_deformed("a.obj", DeformKind::volume), FileError);
  EXPECT_THROW(check_deformed("a.vti", DeformKind::solid), FileError);
  Progress progress;
  const Deformation moved = moved_by({3, 0, 0});
  const DeformSubject points = as_points(octasphere(2)), solid = ball(1);
  EXPECT_NEAR(bounds_of(points).upper.x, 1, 1e-6);
  EXPECT_NEAR(bounds_of(solid).upper.x, 1, 1e-6);
  const DeformReport mesh = deform(points, "m", moved, DeformAim::shape, {}, kIgnore, progress).report;
  EXPECT_EQ(summary_of(mesh).size(), 1u);
  const DeformReport cut = deform(solid, "", moved, DeformAim::sections, {}, kIgnore, progress).report;
  EXPECT_EQ(summary_of(cut).size(), 3u);
}

TEST(DeformJob, MapsHaveNoPosesAndNoCuts) {
  const Deformation map(moved_by({1, 0, 0}).at(1).backward);
  for (const DeformOptions& options : {DeformOptions{.frames = 3}, DeformOptions{.cut_open = true}})
    EXPECT_NE(refused([&] { options.validate(DeformAim::shape, map); }).find("needs"), std::string::npos);
}

TEST(DeformJob, RefusesWhatMeansNothing) {
  Progress progress;
  const Deformation d = moved_by({1, 0, 0});
  const auto of_cloud = [&](const DeformOptions& options, DeformAim aim = DeformAim::shape) {
    return refused([&] { deform(cloud(), "c", d, aim, options, kIgnore, progress); });
  };
  EXPECT_NE(of_cloud({.refine = 0.1}).find("`refine`"), std::string::npos);
  EXPECT_NE(of_cloud({.frames = 1}).find("`frames`"), std::string::npos);
  EXPECT_NE(of_cloud({.draw_folds = true}).find("`draw_folds`"), std::string::npos);
  EXPECT_NE(of_cloud({.planes = {parse_plane("z=0")}}).find("`plane`"), std::string::npos);
  EXPECT_NE(of_cloud({.lattice = {.size = {3, 4}}}).find("`size`"), std::string::npos);
  EXPECT_NE(of_cloud({}, DeformAim::sections), "");
  EXPECT_NE(refused([&] { deform(ball(1), d, DeformAim::shape, {.refine = 0.1}, kIgnore, progress); }).find("`refine`"),
            std::string::npos);
  const SolidModel half(SolidParts{"half", csg::half_space({0, 0, 1}, 0)});
  EXPECT_NE(refused([&] { deform(half, d, DeformAim::sections, {}, kIgnore, progress); }).find("`box`"),
            std::string::npos);
}

}  // namespace
}  // namespace sansmesh::test
