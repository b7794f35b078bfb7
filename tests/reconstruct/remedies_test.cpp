// Remedies that notes and advice name: each is read from its text, applied to the cloud that causes it, and removes the
// defect.
#include "sansmesh/points/remedies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <regex>
#include <set>

#include "sansmesh/advice.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/option.h"
#include "sansmesh/points.h"
#include "sansmesh/reconstruct.h"
#include "support/clouds.h"
#include "support/notes.h"
#include "support/places.h"

namespace sansmesh::inline v1 {
namespace {

/// Option named in a remedy, with its value if it has one.
struct NamedOption {
  std::string name;
  std::optional<std::string> value;
};

NamedOption option_in(std::string_view remedy) {
  static const std::regex pattern("`(\\w+)(?: = ([^`]+))?`");
  std::match_results<std::string_view::const_iterator> found;
  if (!std::regex_search(remedy.begin(), remedy.end(), found, pattern)) return {};
  return {found.str(1), found[2].matched ? std::optional(found.str(2)) : std::nullopt};
}

/// Sets the option by its name, or by that of a flag turned off. `value`: of an option without one in the remedy.
/// Returns false if there is no such option.
template <class Options>
bool apply(const NamedOption& option, Options& options, double value = 0) {
  bool known = false;
  for_each_option(Options::schema(), &options, [&](const OptionRow& row, void* owner) {
    const bool negative = !row.negative.empty() && row.negative == option.name;
    if (row.name != option.name && !negative) return;
    known = true;
    if (row.kind == OptionKind::flag)
      set_option(row, owner, !negative && option.value.value_or("true") == "true");
    else if (option.value)
      set_option(row, owner, *option.value);
    else
      set_option(row, owner, value);
  });
  return known;
}

ReconstructResult made_of(const PointSet& cloud, const ReconstructOptions& options = {}) {
  Progress progress;
  return reconstruct(cloud, options, progress);
}

// ------------------------------------------------------------------------------------------------------- clouds

/// n random samples in the box of the cloud, with random normals.
PointSet with_clutter(PointSet cloud, std::size_t n) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-0.6f, 0.6f);
  std::normal_distribution<float> gauss;
  const Box3f box = bounds(cloud);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3f s = box.size();
    cloud.positions.push_back(box.center() +
                              Vec3f{uniform(random) * s.x, uniform(random) * s.y, uniform(random) * s.z});
    cloud.normals.push_back(normalized(Vec3f{gauss(random), gauss(random), gauss(random)}));
  }
  return cloud;
}

struct PlateShape {
  float bend = 0, hole = 0;
};

/// Square of edge 1 that faces up, without the samples within `hole` of its middle.
PointSet plate(std::size_t n, const PlateShape& shape) {
  PointSet cloud;
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(-0.5f, 0.5f);
  while (cloud.size() < n) {
    const float x = uniform(random), y = uniform(random);
    if (std::hypot(x, y) < shape.hole) continue;
    cloud.positions.push_back({x, y, shape.bend * std::sin(3 * x)});
    cloud.normals.push_back(normalized(Vec3f{-3 * shape.bend * std::cos(3 * x), 0, 1}));
  }
  return cloud;
}

/// Ball without the part above z.
PointSet cut_ball(std::size_t n, float z) {
  const PointSet ball = test::sphere(n);
  PointSet cloud;
  for (std::size_t i = 0; i < n; ++i) {
    if (ball.positions[i].z > z) continue;
    cloud.positions.push_back(ball.positions[i]);
    cloud.normals.push_back(ball.normals[i]);
  }
  return cloud;
}

/// Ball with bumps, so that it slides nowhere on itself.
Vec3 bumpy(const Vec3& d) {
  return d * (1 + 0.15 * std::sin(4 * d.x + 1) + 0.12 * std::cos(5 * d.y) + 0.1 * std::sin(3 * d.z + 2 * d.x));
}

/// Three scans of the bumpy ball, one of them off by half a degree and two spacings.
PointSet unaligned_scans() {
  PointSet cloud;
  std::mt19937 random(1);
  std::normal_distribution<double> gauss;
  for (std::uint16_t s = 0; s < 3; ++s) {
    const double angle = 0.5 * std::numbers::pi * s, turn = s == 1 ? 0.5 * std::numbers::pi / 180 : 0;
    const Vec3 eye = normalized(Vec3{std::cos(angle), std::sin(angle), s % 2 ? 0.4 : -0.4});
    for (int k = 0; k < 14000; ++k) {
      const Vec3 d = normalized(Vec3{gauss(random), gauss(random), gauss(random)});
      if (dot(d, eye) < 0) continue;
      Vec3 p = bumpy(d) + d * (0.001 * gauss(random));
      p = {p.x * std::cos(turn) - p.y * std::sin(turn), p.x * std::sin(turn) + p.y * std::cos(turn), p.z};
      if (s == 1) p = p + Vec3{0.04, 0.04, 0};
      cloud.positions.push_back(Vec3f(p));
      cloud.scan_of_point.push_back(s);
    }
    cloud.scanners.push_back(Vec3f(eye * 10.0));
    cloud.scan_names.push_back("scan" + std::to_string(s));
  }
  return cloud;
}

PointSet ball_and_sparse_ball() { return test::joined(test::sphere(8000), test::sphere(100), 1, {4, 0, 0}); }
PointSet ball_and_sparser_ball() { return test::joined(test::sphere(8000), test::sphere(30), 1, {4, 0, 0}); }
PointSet ball_around_plate() { return test::joined(test::sphere(8000), plate(1500, {})); }
PointSet ball_with_hole() { return cut_ball(12000, 0.2f); }
PointSet half_ball() { return cut_ball(12000, -0.1f); }
PointSet plate_with_hole() { return plate(10000, {.bend = 0.1f, .hole = 0.1f}); }

/// Terrain under birds.
PointSet plate_and_strays() {
  PointSet cloud = plate(8000, {.bend = 0.1f});
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-0.5f, 0.5f);
  for (int i = 0; i < 150; ++i) {
    cloud.positions.push_back({uniform(random), uniform(random), 2.4f + 4 * uniform(random)});
    cloud.normals.push_back({0, 0, 1});
  }
  return cloud;
}

/// Ground, and a plate of vegetation above it.
PointSet ground_and_vegetation() {
  PointSet cloud = test::joined(plate(8000, {.bend = 0.1f}), plate(2000, {}), 1, {0, 0, 0.5f});
  std::vector<std::uint8_t> classes(cloud.size(), 2);
  std::fill(classes.begin() + 8000, classes.end(), std::uint8_t{5});
  cloud.attributes.set("classification", std::move(classes));
  return cloud;
}

/// Airborne samples of gentle ground with houses and trees, without classes and normals.
PointSet unclassified_town() {
  PointSet cloud;
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 14400; ++i) {
    const double x = 120 * uniform(random), y = 120 * uniform(random), ground = std::sin(x / 20);
    const double dx = std::fmod(x, 30.0) - 15, dy = std::fmod(y, 30.0) - 15;
    const bool house = std::abs(dx) < 5 && std::abs(dy) < 4, tree = std::hypot(dx - 10, dy - 9) < 4;
    const double object = house ? 7 : tree && uniform(random) < 0.6 ? 3 + 6 * uniform(random) : 0;
    cloud.positions.push_back(Vec3f(Vec3{x, y, ground + object}));
  }
  return cloud;
}

/// The same ground without anything above it, and an object that is nearly a height field.
PointSet bare_ground() {
  PointSet cloud = unclassified_town();
  for (Vec3f& p : cloud.positions) p.z = std::sin(p.x / 20);
  return cloud;
}
PointSet bare_bowl() {
  PointSet cloud = cut_ball(12000, -0.1f);
  cloud.normals.clear();
  return cloud;
}

// ------------------------------------------------------------------------------------------------------ defects

double lost(const ReconstructResult& made) { return made.report.lost; }
double border(const ReconstructResult& made) { return static_cast<double>(measure_topology(made.mesh).boundary_edges); }
double no_border(const ReconstructResult& made) { return border(made) > 0 ? 0 : 1; }
double loops(const ReconstructResult& made) { return static_cast<double>(measure_topology(made.mesh).boundary_loops); }
double highest(const ReconstructResult& made) {
  return made.mesh.origin.z + static_cast<double>(bounds(made.mesh).upper.z);
}
double missing_parts(const ReconstructResult& made) { return std::max(0, 2 - made.report.components); }
double deviation(const ReconstructResult& made) { return made.report.noise; }

struct Case {
  const char* code;
  const char* option;
  PointSet (*cloud)();
  double (*defect)(const ReconstructResult&);
  double before;     ///< least defect without the remedy
  double after;      ///< largest defect with it
  double value = 0;  ///< value of an option without a value in its text
};

const Case kCases[] = {
    {"scans_disagree", "align", unaligned_scans, deviation, 0.002, 0.0012},
    {"classes_left_out", "class", ground_and_vegetation, missing_parts, 1, 0},
    {"unclassified_survey", "class", unclassified_town, highest, 6, 2},
    {"clutter", "remove_outliers", ball_and_sparser_ball, missing_parts, 1, 0},
    {"parts_left_out", "components", ball_and_sparse_ball, missing_parts, 1, 0},
    {"lost_samples", "components", ball_and_sparse_ball, lost, 0.01, 0},
    {"lost_samples", "remove_outliers", plate_and_strays, lost, 0.01, 0.002},
    {"lost_samples", "open", ball_around_plate, lost, 0.01, 0.001},
};
const Case kAdviceCases[] = {
    {"advice_open", "open", half_ball, border, 1, 0},
    {"advice_open", "fill_holes", plate_with_hole, loops, 2, 1, 0.3},
    {"advice_closed", "open", ball_with_hole, no_border, 1, 0},
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.code << ", " << c.option; }

const Remedy* row_of(const Case& c) {
  for (const Remedy& r : kRemedies)
    if (r.code == c.code && r.option == c.option) return &r;
  return nullptr;
}

class Remedies : public testing::TestWithParam<Case> {};

TEST_P(Remedies, RemoveTheDefect) {
  const Case& c = GetParam();
  const PointSet cloud = c.cloud();
  ReconstructResult made = made_of(cloud);
  EXPECT_GE(c.defect(made), c.before);
  const auto note = std::find_if(made.notes.begin(), made.notes.end(), [&](const Note& n) { return n.code == c.code; });
  ASSERT_NE(note, made.notes.end());
  ASSERT_TRUE(row_of(c));
  EXPECT_EQ(note->remedy, row_of(c)->text);
  ReconstructOptions options;
  ASSERT_TRUE(apply(option_in(note->remedy), options, c.value)) << note->remedy;
  made = made_of(cloud, options);
  EXPECT_FALSE(test::has_note(made.notes, c.code));
  // Kept samples may be a small part, which has a remedy of its own.
  for (const Note& n : made.notes) {
    EXPECT_EQ(n.text.find('`'), std::string::npos) << "an option outside of the remedy: " << n.text;
    if (!n.remedy.empty()) EXPECT_TRUE(apply(option_in(n.remedy), options)) << n.remedy;
  }
  if (!made.notes.empty()) made = made_of(cloud, options);
  EXPECT_LE(c.defect(made), c.after);
}

INSTANTIATE_TEST_SUITE_P(Notes, Remedies, testing::ValuesIn(kCases));

/// Recommended mesh.
Recommendation mesh_advice(const PointSet& cloud) {
  Progress progress;
  const Advice advice = advise(cloud, progress);
  const auto found = std::find_if(advice.recommendations.begin(), advice.recommendations.end(),
                                  [](const Recommendation& r) { return r.aim == Recommendation::Aim::mesh; });
  return found == advice.recommendations.end() ? Recommendation() : *found;
}

class AdvisedRemedies : public testing::TestWithParam<Case> {};

TEST_P(AdvisedRemedies, RemoveTheDefect) {
  const Case& c = GetParam();
  const PointSet cloud = c.cloud();
  const Remedy* remedy = row_of(c);
  ASSERT_TRUE(remedy);
  const std::string why = mesh_advice(cloud).why;
  ASSERT_NE(why.find(remedy->text), std::string::npos) << why;
  ReconstructOptions options;
  EXPECT_GE(c.defect(made_of(cloud, options)), c.before);
  ASSERT_TRUE(apply(option_in(remedy->text), options, c.value));
  EXPECT_LE(c.defect(made_of(cloud, options)), c.after);
}

INSTANTIATE_TEST_SUITE_P(Advice, AdvisedRemedies, testing::ValuesIn(kAdviceCases));

TEST(Remedies, AllOfTheTableAreTested) {
  std::set<std::string> tested;
  for (const Case& c : kCases) tested.insert(std::string(c.code) + " " + c.option);
  for (const Case& c : kAdviceCases) tested.insert(std::string(c.code) + " " + c.option);
  for (const Remedy& r : kRemedies)
    EXPECT_TRUE(tested.contains(std::string(r.code) + " " + std::string(r.option))) << r.code << " " << r.option;
}

TEST(Remedies, OnlyOfSurveysNameTheGround) {
  for (const auto cloud : {bare_ground, bare_bowl, plate_and_strays, ball_around_plate, unaligned_scans, half_ball})
    EXPECT_FALSE(test::has_note(made_of(cloud()).notes, "unclassified_survey"));
}

// Notes on clouds and on their surfaces take their remedies from the table.
TEST(Remedies, NoSourceBypassesTheTable) {
  const std::regex own("\\.remedy = (?!\\{\\})");
  std::size_t sources = 0;
  const auto check = [&](const std::filesystem::path& file) {
    std::ifstream in(file);
    EXPECT_TRUE(in) << file;
    ++sources;
    for (std::string line; std::getline(in, line);) EXPECT_FALSE(std::regex_search(line, own)) << file << ": " << line;
  };
  for (const char* room : {"points", "partition", "function", "meshing", "model", "advise"})
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(test::source_file(std::string("sansmesh/") + room))) {
      const std::string name = entry.path().filename().string();
      if (entry.is_regular_file() && name != "remedies.h" && name != "mesh_csg.cpp") check(entry.path());
    }
  for (const char* job : {"meshes/curvature", "surfaces/diagnose", "surfaces/fit_function", "surfaces/mesh_of_function",
                          "surfaces/project"})
    check(test::source_file(std::string("sansmesh/jobs/") + job + ".cpp"));
  EXPECT_GT(sources, 100u);
}

TEST(Remedies, StraysLeaveAsAdvised) {
  PointSet cloud = with_clutter(test::sphere(20000), 40);
  ASSERT_TRUE(mesh_advice(cloud).remove_outliers);
  EXPECT_GT(lost(made_of(cloud)), 0.001);
  ReconstructOptions options;
  options.cloud.remove_outliers = true;
  EXPECT_LT(lost(made_of(cloud, options)), 0.0002);
}

TEST(Remedies, NoiseLeavesAsAdvised) {
  const PointSet cloud = test::sphere(8000, 0.02);
  Progress progress;
  const Advice advice = advise(cloud, progress);
  const auto denoised = std::find_if(advice.recommendations.begin(), advice.recommendations.end(),
                                     [](const Recommendation& r) { return r.aim == Recommendation::Aim::points; });
  ASSERT_NE(denoised, advice.recommendations.end());
  ProjectOptions options;
  options.method = denoised->surface;
  const auto rms = [](const PointSet& points) {
    double sum = 0;
    for (const Vec3f& p : points.positions) sum += std::pow(norm(points.origin + Vec3(p)) - 1, 2);
    return std::sqrt(sum / static_cast<double>(points.size()));
  };
  EXPECT_LT(rms(project({.points = cloud}, options, progress).points), 0.2 * rms(cloud));
}

}  // namespace
}  // namespace sansmesh::inline v1
