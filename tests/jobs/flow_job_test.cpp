// Tests of flow jobs: opening, choices, notes, errors. The accuracy of lines and surfaces is tested in tests/flow.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/flow.h"
#include "sansmesh/flow_options.h"
#include "sansmesh/flow_pictures.h"
#include "sansmesh/pictures.h"
#include "support/notes.h"

namespace sansmesh::test {
namespace {

FlowModel formula(const char* name) { return {analytic_flow(name), name}; }

/// A lattice of 5³ points about the origin with the vectors of a rotation of the given speed, and a scalar.
GridData turning(double speed) {
  GridBlock block;
  block.kind = GridKind::lattice;
  for (std::size_t k = 0; k < 3; ++k)
    for (int i = -2; i <= 2; ++i) block.axes[k].push_back(i);
  std::vector<float> v, height;
  for (int k = -2; k <= 2; ++k)
    for (int j = -2; j <= 2; ++j)
      for (int i = -2; i <= 2; ++i) {
        const auto s = static_cast<float>(speed);
        v.insert(v.end(), {-s * static_cast<float>(j), s * static_cast<float>(i), 0.0f});
        height.push_back(static_cast<float>(k));
      }
  block.point_arrays.set("height", std::move(height));
  block.point_arrays.set("velocity", std::move(v), 3);
  GridData data;
  data.blocks.push_back(std::move(block));
  return data;
}

FlowModel of_volume(const std::string& array = "") {
  Progress progress;
  return {VolumeModel(turning(1), "turning.vti"), array, progress};
}

template <class E = ArgumentError>
std::string refused(const std::function<void()>& call) {
  try {
    call();
  } catch (const E& error) {
    return error.what();
  }
  return "";
}

bool holds(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

TEST(FlowModel, IsWhatTheFilesAndOptionsSay) {
  Progress progress;
  const FlowModel turn = open_flow({"rotation"}, {}, {}, progress);
  EXPECT_EQ(turn.name(), "rotation (formula)");
  EXPECT_FALSE(turn.volume());
  EXPECT_FALSE(turn.unsteady());
  const FlowModel volume = of_volume();
  EXPECT_EQ(volume.vectors(), "velocity");
  EXPECT_EQ(volume.name(), "velocity of turning.vti");
  EXPECT_TRUE(holds(refused<DataError>([] { of_volume("height"); }), "turning.vti: "));
  EXPECT_TRUE(holds(refused<FileError>([&] { open_flow({"nothing"}, {}, {}, progress); }), "no flow by formula"));
  EXPECT_TRUE(holds(refused([&] {
                      open_flow({"a.vti"}, {}, {.unsteady = true, .times = {0, 1}}, progress);
                    }),
                    "`times`"));
  EXPECT_TRUE(holds(refused([&] { open_flow({"a.vti", "b.vti"}, {}, {.times = {0, 1}}, progress); }), "`unsteady`"));
}

TEST(FlowModel, OutlivesWhatItWasMadeOf) {
  FlowModel copy = formula("saddle");
  {
    const FlowModel other = of_volume();
    copy = other;
  }
  std::vector<Vec3> vectors(1);
  std::vector<std::uint8_t> inside(1);
  copy.field().evaluate(std::vector<Vec3>{{1, 0, 0}}, std::vector<double>{0}, vectors, inside);
  EXPECT_EQ(inside[0], 1);
  EXPECT_NEAR(vectors[0].y, 1, 1e-6);
}

TEST(FlowModel, SeedsOfFilesLeaveOutWhatIsNotFinite) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "flow_job_seeds.csv";
  std::ofstream(file) << "x,y,z\n0.1,0,0\nnan,0,0\n0.2,0,0\n";
  std::vector<Note> notes;
  const Seeds seeds = formula("rotation").seeds("points(" + file.string() + ")", 10, notes);
  std::filesystem::remove(file);
  EXPECT_EQ(seeds.points.size(), 2u);
  ASSERT_TRUE(has_note(notes, "not_finite"));
  EXPECT_EQ(notes[0].of, file.string());
  EXPECT_TRUE(holds(refused([&] { formula("rotation").seed_curve("box(4)", notes); }), "curve"));
  EXPECT_TRUE(holds(refused([&] { formula("rotation").seed_curve("", notes); }), "`seeds`"));
}

TEST(TraceLines, ChoosesSeedsAndCarriesArrays) {
  Progress progress;
  const FlowModel flow = of_volume();
  TraceLinesOptions options;
  options.carry = "all";
  options.lines.duration = 1;
  EXPECT_EQ(arrays_along_lines(flow, options).size(), 6u);
  const TraceLinesResult made = trace_lines_of(flow, options, progress);
  EXPECT_GT(made.report.seeds, 100u);
  const Attribute* const height = made.lines.attributes.find("height");
  ASSERT_NE(height, nullptr);
  EXPECT_NEAR(height->number(0), made.lines.origin.z + static_cast<double>(made.lines.positions[0].z), 1e-4);
  options.carry = "heat";
  EXPECT_TRUE(holds(refused([&] { trace_lines_of(flow, options, progress); }), "heat"));
  EXPECT_TRUE(holds(refused([&] { trace_lines_of(formula("rotation"), options, progress); }), "`carry`"));
}

TEST(TraceLines, TellsOfSeedsOutsideAndWhereTheFlowIs) {
  Progress progress;
  const FlowModel flow = of_volume();
  const TraceLinesResult made = trace_lines_of(flow, {.seeds = "line(0,0,0, 4,0,0, 9)"}, progress);
  EXPECT_TRUE(has_note(made.notes, "outside"));
  const std::string error = refused<DataError>([&] { trace_lines_of(flow, {.seeds = "point(9,9,9)"}, progress); });
  EXPECT_TRUE(holds(error, "turning.vti: ")) << error;
  EXPECT_TRUE(holds(error, "(it is between (-2, -2, -2)")) << error;
}

TEST(TraceLines, OptionsSayWhichWay) {
  FlowLineOptions options;
  options.kind = FlowLineKind::streak, options.direction = FlowDirection::both;
  EXPECT_TRUE(holds(refused([&] { options.validate(); }), "`direction = both`"));
  for_each_option(FlowLineOptions::schema(), &options, [](const OptionRow& row, void* owner) {
    if (row.name == "kind") set_option(row, owner, std::string("stream"));
    if (row.name == "direction") set_option(row, owner, std::string("backward"));
    if (row.name == "step_length") set_option(row, owner, 0.25);
  });
  EXPECT_EQ(options.kind, FlowLineKind::path);
  EXPECT_EQ(options.direction, FlowDirection::backward);
  EXPECT_EQ(options.trace.step, 0.25);
  EXPECT_EQ(default_color(options), "speed");
}

TEST(LinePicture, HasAScaleBesideTheTubes) {
  Progress progress;
  const TraceLinesResult made = trace_lines_of(of_volume(), {.seeds = "line(0.5,0,0, 1.5,0,0, 5)"}, progress);
  LinePictureOptions options;
  options.picture.view.width = 300, options.picture.view.height = 120;
  const LinePicture drawn = line_picture(made.lines, options, "speed", progress);
  EXPECT_EQ(drawn.image.width, 300);
  EXPECT_LT(drawn.made_with.view.width, 300);
  EXPECT_EQ(drawn.color_by, "speed");
  EXPECT_LT(drawn.lower, drawn.upper);
  options.color_by = "heat";
  EXPECT_TRUE(holds(refused([&] { line_picture(made.lines, options, "speed", progress); }), "heat"));
  options.picture.view.width = 120;
  EXPECT_TRUE(holds(refused([&] { options.validate("speed"); }), "`width = 120`"));
}

TEST(TraceSurface, KindAndParticlesFollowFromFlowAndSeeds) {
  Progress progress;
  TraceSurfaceOptions options{.seeds = "line(0.5,0,-1, 0.5,0,1, 12)"};
  options.surface.duration = 1;
  const TraceSurfaceResult made = trace_surface(of_volume(), options, progress);
  EXPECT_NEAR(made.surface.report.spacing, 2.0 / 11, 1e-9);
  EXPECT_TRUE(made.notes.empty());
  options.surface.seeds = 5;
  EXPECT_NEAR(trace_surface(of_volume(), options, progress).surface.report.spacing, 0.5, 1e-9);
  options.surface.most_fronts = 2, options.surface.front_step = 0.01;
  EXPECT_TRUE(has_note(trace_surface(of_volume(), options, progress).notes, "too_many"));
  options.seeds.clear();
  EXPECT_TRUE(holds(refused([&] { options.validate(); }), "`seeds`"));
}

TEST(FlowPictures, DrawTheSurfaceInAVolume) {
  Progress progress;
  FlowPictureOptions options;
  options.trace.seeds = "line(0.5,0,-1, 0.5,0,1, 12)";
  options.trace.surface.duration = 1;
  options.picture.view.width = 320, options.picture.view.height = 120, options.picture.quality.samples = 1;
  options.frames = 2, options.color_by = "height", options.isos = {{.value = 1}};
  int frames = 0;
  const FlowPicturesResult made = flow_pictures(
      of_volume(), options, {},
      [&](int frame, const Image& image, const RenderOptions& look) {
        EXPECT_EQ(frame, frames++);
        EXPECT_EQ(image.width, 320);
        EXPECT_LT(look.view.width, 320);
      },
      progress);
  EXPECT_EQ(frames, 2);
  EXPECT_EQ(made.width, 320);
  EXPECT_GT(made.surface.particles, 0u);
  EXPECT_TRUE(holds(refused([&] { check_colors(formula("rotation"), options); }), "`iso`"));
}

TEST(FlowPictures, IsoSurfacesAreThoseOfTheSpeedWhereNoArrayIsNamed) {
  Progress progress;
  const auto picture = [&](const std::string& array) {
    FlowPictureOptions options;
    options.trace.seeds = "line(0.5,0,-1, 0.5,0,1, 12)";
    options.trace.surface.duration = 0.2;
    options.picture.view.width = 64, options.picture.view.height = 48, options.picture.quality.samples = 1;
    options.bar = false, options.isos = {{.value = 0.7}};
    options.volume_array = array, options.opacity_factor = array.empty() ? 1 : 0;
    Image drawn;
    flow_pictures(
        of_volume(), options, {}, [&](int, const Image& image, const RenderOptions&) { drawn = image; }, progress);
    return drawn.pixels;
  };
  EXPECT_EQ(picture(""), picture("velocity"));
  EXPECT_NE(picture(""), picture("height"));
}

TEST(FlowPictures, RefuseWhatMeansNothing) {
  const auto said = [](const std::function<void(FlowPictureOptions&)>& set) {
    FlowPictureOptions options;
    options.trace.seeds = "line(0,0,0, 1,0,0, 12)";
    set(options);
    return refused([&] { options.validate(); });
  };
  EXPECT_EQ(said([](FlowPictureOptions&) {}), "");
  EXPECT_TRUE(holds(said([](auto& o) { o.textured = false, o.streaks.streak_width = 3; }), "`streak_width`"));
  EXPECT_TRUE(holds(said([](auto& o) { o.textured = false, o.frames = 4; }), "`turn`"));
  EXPECT_TRUE(holds(said([](auto& o) { o.turn = 4; }), "`frames`"));
  EXPECT_TRUE(holds(said([](auto& o) { o.opacity_factor = 0.5; }), "`volume_array`"));
  EXPECT_TRUE(holds(said([](auto& o) { o.label = "speed", o.bar = false; }), "`label`"));
  EXPECT_TRUE(holds(said([](auto& o) { o.opacity = 2; }), "`opacity`"));
}

}  // namespace
}  // namespace sansmesh::test
