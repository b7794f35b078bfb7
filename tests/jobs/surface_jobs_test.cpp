// Tests of jobs on surfaces of all kinds: choices, notes, errors. Their accuracy is tested in tests/measure and
// tests/mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numbers>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/inspect.h"
#include "sansmesh/measure/signed_distance.h"
#include "sansmesh/pictures.h"
#include "support/mesh_shapes.h"
#include "support/notes.h"

namespace sansmesh::test {
namespace {

TriangleMesh moved_by(TriangleMesh mesh, const Vec3& shift, double scale = 1) {
  transform(mesh, AffineMap{{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}, shift});
  return mesh;
}

TriangleMesh without_triangles(TriangleMesh mesh, std::size_t count) {
  mesh.triangles.resize(mesh.triangles.size() - count);
  return mesh;
}

TriangleMesh points_of(TriangleMesh mesh) {
  mesh.triangles.clear();
  return mesh;
}

/// The unit sphere as a function.
AnySurface sphere_function() {
  const TriangleMesh ball = octasphere(4);
  PointSet points;
  for (const Vec3f& p : ball.vertices) points.positions.push_back(p), points.normals.push_back(p);
  Progress progress;
  return {SurfaceFunction(fit_surface_function(std::move(points), {}, progress)), "ball.smf"};
}

/// A box of sides 2, 3 and 4, whose only rotational symmetries are by 180°.
TriangleMesh brick() {
  TriangleMesh mesh = octasphere(4);
  for (Vec3f& v : mesh.vertices) {
    const float most = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    v = {v.x / most, 1.5f * v.y / most, 2 * v.z / most};
  }
  return mesh;
}

std::string error_text(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(AnySurface, IsSharedWhateverItHolds) {
  Progress progress;
  std::vector<Note> notes;
  AnySurface copy(octasphere(0), "a");
  {
    const AnySurface function = sphere_function();
    copy = function;
  }
  EXPECT_EQ(copy.kind(), AnySurface::Kind::function);
  ASSERT_NE(copy.field(), nullptr);
  EXPECT_NEAR(copy.bounds().size().x, 2, 0.1);
  EXPECT_GT(copy.mesh(progress, notes)->triangles.size(), 100u);
  std::shared_ptr<const SignedDistance> distance = copy.distance(progress, notes);
  copy = AnySurface(points_of(octasphere(1)), "b");
  EXPECT_STREQ(copy.kind_word(), "points");
  std::vector<MeasuredPoint> found(1);
  distance->measure(std::vector<Vec3>{{0, 0, 2}}, 10, found);
  EXPECT_NEAR(found[0].distance, 1, 0.01);
}

TEST(MeasureJob, TellsWhatVolumesMean) {
  Progress progress;
  const auto codes_of = [&](TriangleMesh mesh) { return measure({std::move(mesh), "a"}, progress).notes; };
  EXPECT_TRUE(codes_of(octasphere(2)).empty());
  EXPECT_TRUE(has_note(codes_of(without_triangles(octasphere(2), 1)), "open"));
  TriangleMesh inward = octasphere(2);
  for (Triangle& t : inward.triangles) std::swap(t[0], t[1]);
  EXPECT_TRUE(has_note(codes_of(inward), "faces_inward"));
  const TriangleMesh ball = octasphere(2);
  EXPECT_TRUE(has_note(codes_of(joined(ball, moved_by(inward, {}, 0.5), {})), "cavities"));
  EXPECT_TRUE(has_note(codes_of(joined(ball, moved_by(ball, {}, 0.5), {})), "nested"));
  EXPECT_TRUE(has_note(codes_of(joined(ball, ball, {0.7f, 0.1f, 0.2f})), "crossing_components"));
  EXPECT_EQ(error_text([&] { codes_of(points_of(octasphere(1))); }).rfind("a: ", 0), 0u);
}

TEST(SectionJob, ChoosesPlanes) {
  Progress progress;
  const AnySurface ball(octasphere(3), "ball.ply");
  const auto heights = [&](const SectionOptions& options) {
    std::vector<double> found;
    for (const Section& s : section(ball, options, progress).sections) found.push_back(s.plane.offset);
    return found;
  };
  EXPECT_EQ(heights({}).size(), 3u);
  EXPECT_EQ(heights({.axis = SectionAxis::z, .count = 3}), (std::vector<double>{-0.5, 0, 0.5}));
  EXPECT_EQ(heights({.axis = SectionAxis::x, .interval = 0.5}), (std::vector<double>{-0.75, -0.25, 0.25, 0.75}));
  EXPECT_EQ(heights({.axis = SectionAxis::x, .interval = -0.5}), (std::vector<double>{0.75, 0.25, -0.25, -0.75}));
  EXPECT_EQ(heights({.axis = SectionAxis::x, .interval = 0.5, .count = 2}), (std::vector<double>{-0.75, -0.25}));
  EXPECT_EQ(heights({.axis = SectionAxis::x, .interval = -0.5, .count = 2}), (std::vector<double>{0.75, 0.25}));
  EXPECT_EQ(heights({.axis = SectionAxis::x, .first = -0.5, .count = 3}), (std::vector<double>{-0.5, 0, 0.5}));
  EXPECT_EQ(heights({.axis = SectionAxis::x, .interval = 100}), (std::vector<double>{0}));
  EXPECT_EQ(heights({.planes = {parse_plane("z=0.25")}, .axis = SectionAxis::y, .first = 0.1}),
            (std::vector<double>{0.25, 0.1}));
}

TEST(SectionJob, FunctionsNeedNoMeshAndBordersAreToldOf) {
  Progress progress;
  const SectionResult round = section(sphere_function(), {.planes = {parse_plane("z=0")}, .resolution = 200}, progress);
  EXPECT_NEAR(round.sections[0].area, 3.14159, 0.01);
  EXPECT_TRUE(round.notes.empty());
  TriangleMesh half = octasphere(3);
  std::erase_if(half.triangles, [&](const Triangle& t) { return half.vertices[t[0]].x > 0.5f; });
  const SectionResult open = section({half, "half"}, {.planes = {parse_plane("z=0.1")}}, progress);
  EXPECT_TRUE(has_note(open.notes, "open_curves"));
  EXPECT_EQ(open.report.open_curves, 1u);
}

TEST(SectionJob, BadOptions) {
  Progress progress;
  const AnySurface ball(octasphere(1), "ball.ply");
  EXPECT_THROW(section(ball, {.interval = 1}, progress), ArgumentError);
  EXPECT_THROW(section(ball, {.axis = SectionAxis::x, .interval = 0}, progress), ArgumentError);
  EXPECT_THROW(section(ball, {.axis = SectionAxis::x, .first = 1, .count = 2}, progress), ArgumentError);
  EXPECT_THROW(section(ball, {.resolution = 100}, progress), ArgumentError);
  EXPECT_THROW(section({points_of(octasphere(1)), "points"}, {}, progress), DataError);
}

TEST(SectionJob, PlanesComeBackAsTheyWereWritten) {
  for (const char* const text : {"z=0.1", "x=-3", "0.6,0.8,0,1.5", "1,2,3,4"}) {
    const CutPlane plane = parse_plane(text);
    CutPlane again;
    option_of_text(text_of_option(plane), again);
    EXPECT_NEAR(norm(again.normal - plane.normal), 0, 1e-15);
    EXPECT_NEAR(again.offset, plane.offset, 1e-15);
  }
}

TEST(AssessJob, ReportsWhatThereIs) {
  Progress progress;
  const AssessReport alone = assess(octasphere(2), progress).report;
  ASSERT_TRUE(alone.topology && alone.quality);
  EXPECT_TRUE(alone.topology->closed());
  EXPECT_FALSE(alone.distance);
  EXPECT_FALSE(assess(points_of(octasphere(2)), progress).report.topology);
  PointSet cloud;
  cloud.positions = octasphere(4).vertices;
  const AssessReport both = assess(octasphere(4), cloud, {.samples = 1000}, progress).report;
  ASSERT_TRUE(both.distance && both.coverage);
  EXPECT_EQ(both.distance->to_reference.samples, 1000u);
  EXPECT_EQ(both.coverage->lost.share, 0);
}

TEST(AssessJob, FewSamplesTellOfSurfacesInOtherUnits) {
  Progress progress;
  PointSet cloud;
  cloud.positions = octasphere(3).vertices;
  const AssessResult found = assess(moved_by(octasphere(2), {}, 1000), cloud, {}, progress);
  EXPECT_TRUE(has_note(found.notes, "other_unit"));
  EXPECT_EQ(found.report.distance->to_reference.samples, 5000u);
}

TEST(AlignJob, MovesAfterWhatWasKnownBefore) {
  Progress progress;
  const AnySurface fixed(brick(), "fixed"), moving(moved_by(brick(), {10, 0, 0}), "moving");
  const AffineMap before = AffineMap::translation({-9.8, 0.05, 0});
  const AlignResult found = align(moving, fixed, {.start = AlignStart::given_pose}, progress, before);
  const TriangleMesh where = brick();
  double farthest = 0;
  for (std::size_t i = 0; i < where.vertices.size(); ++i)
    farthest = std::max(farthest, norm(found.moved.origin + Vec3(found.moved.vertices[i]) - Vec3(where.vertices[i])));
  EXPECT_LT(farthest, 0.02);
  EXPECT_NEAR(found.motion.shift.x, -10, 0.02);
  EXPECT_EQ(found.fixed->triangles.size(), where.triangles.size());
}

TEST(AlignJob, TellsWhatIsNotUniqueAndNamesWhatFitsNowhere) {
  Progress progress;
  const AnySurface ball(octasphere(4), "ball"), block(brick(), "block");
  EXPECT_TRUE(has_note(align(block, block, {.start = AlignStart::anywhere}, progress).notes, "not_unique"));
  const AnySurface large(moved_by(brick(), {}, 10), "large");
  const std::string nowhere = error_text([&] { align(large, block, {}, progress); });
  EXPECT_EQ(nowhere.rfind("large: ", 0), 0u) << nowhere;
  EXPECT_NE(nowhere.find("`find_scale`"), std::string::npos) << nowhere;
  const AnySurface tiny(without_triangles(octasphere(0), 7), "tiny");
  EXPECT_EQ(error_text([&] { align(ball, tiny, {}, progress); }).rfind("tiny: ", 0), 0u);
  EXPECT_THROW(align(ball, ball, {.iterations = 0}, progress), ArgumentError);
}

TEST(CompareJob, SignIsThePartsOnEitherSide) {
  Progress progress;
  const AnySurface part(moved_by(octasphere(5), {}, 1.05), "part"), reference(octasphere(5), "reference");
  for (const MapSide side : {MapSide::part, MapSide::reference}) {
    const CompareResult found = compare(part, reference, {.on = side}, progress);
    EXPECT_NEAR(found.map.statistics.mean, 0.05, 0.003);
    EXPECT_EQ(found.mesh.colors.size(), found.mesh.vertices.size());
    EXPECT_NE(found.mesh.attributes.find("quality"), nullptr);
    EXPECT_TRUE(found.notes.empty());
  }
}

TEST(CompareJob, TellsOfLargeTrianglesAndOfDistancesWithoutASign) {
  Progress progress;
  const AnySurface coarse(octasphere(1), "coarse"), fine(octasphere(4), "fine"),
      points(points_of(octasphere(4)), "points");
  const CompareResult corners = compare(coarse, fine, {}, progress);
  ASSERT_TRUE(has_note(corners.notes, "coarse"));
  EXPECT_EQ(corners.notes[0].of, "coarse");
  const CompareResult cut = compare(coarse, fine, {.refine = 0.1}, progress);
  EXPECT_FALSE(has_note(cut.notes, "coarse"));
  EXPECT_GT(cut.mesh.triangles.size(), octasphere(1).triangles.size());
  EXPECT_TRUE(has_note(compare(fine, points, {}, progress).notes, "no_sign"));
}

TEST(CompareJob, AlignsWhereItIsAskedTo) {
  Progress progress;
  const AnySurface fixed(brick(), "fixed"), moving(moved_by(brick(), {0.2, 0, 0}), "moving");
  EXPECT_GT(compare(moving, fixed, {}, progress).map.statistics.rms, 0.05);
  const CompareResult found =
      compare(moving, fixed, {.align = true, .alignment = {.start = AlignStart::given_pose}}, progress);
  ASSERT_TRUE(found.report.alignment);
  EXPECT_LT(found.map.statistics.rms, 0.01);
  EXPECT_NEAR(found.report.motion.shift.x, -0.2, 0.02);
  EXPECT_THROW(compare(moving, fixed, {.alignment = {.find_scale = true}}, progress), ArgumentError);
  EXPECT_THROW(compare(sphere_function(), fixed, {.on = MapSide::reference, .align = true}, progress), ArgumentError);
  EXPECT_THROW(compare(moving, fixed, {.refine = -1}, progress), ArgumentError);
}

TEST(CompareJob, DrawsTheMapBesideItsScale) {
  Progress progress;
  const AnySurface part(octasphere(4), "part.ply"), design(moved_by(octasphere(4), {0.1, 0, 0}), "design.stl");
  CompareOptions options;
  options.map.within = 0.05;
  const CompareResult made = compare(part, design, options, progress);
  RenderOptions look;
  look.view.width = 300, look.view.height = 150, look.quality.samples = 1;
  const MapPicture picture = draw_map(made, options, look, "mm", progress);
  EXPECT_EQ(picture.image.width, 300);
  EXPECT_LT(picture.made_with.view.width, 300);
  EXPECT_FALSE(picture.made_with.look.shadows);
  look.view.width = 120;
  EXPECT_NE(error_text([&] { draw_map(made, options, look, "mm", progress); }).find("`width = 120`"),
            std::string::npos);
  EXPECT_THROW(check_map_picture(look, "mm"), ArgumentError);
}

TEST(AlignJob, DrawsWhatHasMovedInOrange) {
  Progress progress;
  const AnySurface fixed(brick(), "fixed.ply"), moving(moved_by(brick(), {0.05, 0, 0}), "moving.ply");
  const AlignResult made = align(moving, fixed, {}, progress);
  RenderOptions look;
  look.view.width = 80, look.view.height = 60, look.quality.samples = 1;
  const Image image = draw_alignment(made, look, progress);
  std::size_t orange = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) orange += image.at(x, y)[0] > 1.5f * image.at(x, y)[2];
  EXPECT_GT(orange, 50u);
}

/// The unit sphere with this noise.
TriangleMesh noisy_ball(double noise, std::size_t count) {
  std::mt19937 random(3);
  std::normal_distribution<double> gauss;
  TriangleMesh points;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 n = normalized(Vec3{gauss(random), gauss(random), gauss(random)});
    points.vertices.push_back(Vec3f(n * (1 + noise * gauss(random))));
    points.normals.push_back(Vec3f(n));
  }
  return points;
}

TEST(CompareJob, NoisyPointsOnTheSurfaceAreDrawnAsOftenRedAsBlue) {
  Progress progress;
  const AnySurface scan(noisy_ball(0.02, 8000), "scan"), ball(octasphere(5), "ball");
  const CompareResult made = compare(scan, ball, {}, progress);
  RenderOptions look;
  look.view.width = 300, look.view.height = 200, look.quality.samples = 1;
  const Image image = draw_map(made, {}, look, "", progress).image;
  int red = 0, blue = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      const auto& c = image.at(x, y);
      red += c[0] > c[2] + 0.04f, blue += c[2] > c[0] + 0.04f;
    }
  EXPECT_LT(red, 2 * blue) << red << ' ' << blue;
}

TEST(CompareJob, SamplingAndNoiseOfPointsAreReported) {
  Progress progress;
  const AnySurface scan(noisy_ball(0.02, 8000), "scan"), ball(octasphere(5), "ball");
  const CompareResult onto = compare(ball, scan, {}, progress);
  ASSERT_TRUE(onto.report.reference_points);
  EXPECT_FALSE(onto.report.part_points);
  EXPECT_NEAR(onto.report.reference_points->spacing, std::sqrt(4 * std::numbers::pi / 8000), 0.01);
  EXPECT_NEAR(onto.report.reference_points->noise.deviation, 0.02, 0.004);
  // The ball is the truth, so noise and sampling cause all of the distances.
  const double rms = onto.map.statistics.rms;
  EXPECT_NEAR(onto.report.reference_points->own_rms, rms, 0.15 * rms);
  const std::vector<std::string> words = summary_of(onto, {}, "scan");
  EXPECT_TRUE(std::any_of(words.begin(), words.end(), [](const std::string& line) {
    return line.starts_with("reference ") && line.find("noise 0.0") != std::string::npos;
  }));
  const CompareResult from = compare(scan, ball, {}, progress);
  ASSERT_TRUE(from.report.part_points);
  EXPECT_FALSE(from.report.reference_points);
  EXPECT_NEAR(from.report.part_points->own_rms, from.map.statistics.rms, 0.004);
}

}  // namespace
}  // namespace sansmesh::test
