// Tests of lengths far from 1: results are right, up to limits that one line reports.
#include <fmt/core.h>

#include <cmath>
#include <filesystem>

#include "run_tool.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;

/// A spiral around a sphere with radius `size`.
std::string sphere_cloud(double size) {
  std::string text;
  for (int i = 0; i < 300; ++i) {
    const double z = 1 - (i + 0.5) / 150, r = std::sqrt(1 - z * z), a = 2.399963 * i;
    text += fmt::format("{:.9e} {:.9e} {:.9e}\n", size * r * std::cos(a), size * r * std::sin(a), size * z);
  }
  return text;
}

/// A cube of that size.
std::string cube_mesh(double size) {
  std::string text = "OFF\n8 12 0\n";
  for (int i = 0; i < 8; ++i)
    text += fmt::format("{:g} {:g} {:g}\n", size * (i & 1), size * (i >> 1 & 1), size * (i >> 2));
  return text +
         "3 0 2 3\n3 0 3 1\n3 4 5 7\n3 4 7 6\n3 0 1 5\n3 0 5 4\n3 2 6 7\n3 2 7 3\n3 0 4 6\n3 0 6 2\n3 1 3 7\n3 1 7 5\n";
}

/// Quantised x + 2 y + 4 z on a lattice of 4 × 4 × 4 points with that spacing.
std::string linear_volume(double spacing) {
  std::string text = fmt::format(
      "ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementSpacing = {0:g} {0:g} {0:g}\n"
      "ElementType = MET_FLOAT\nBinaryData = False\nElementDataFile = LOCAL\n",
      spacing);
  for (int i = 0; i < 64; ++i) text += fmt::format("{} ", i % 4 + 2 * (i / 4 % 4) + 4 * (i / 16));
  return text;
}

class Extremes : public ToolTest {};

TEST_F(Extremes, ATetrahedronOfDenormalSizeIsRefused) {
  const std::string file = source_file("tests/data/crashes/tiny_extent.xyz"), cause = "extends over 1e-40 only";
  expect_failures({{{"info", file}, 1, {"tiny_extent.xyz", cause}},
                   {{"normals", file, "-o", "n.ply"}, 1, {"tiny_extent.xyz", cause}},
                   {{"reconstruct", file, "-o", "r.ply"}, 1, {"tiny_extent.xyz", cause}},
                   {{"render", file, "-o", "p.png"}, 1, {"tiny_extent.xyz", cause}},
                   {{"convert", file, "-o", "c.ply"}, 1, {"tiny_extent.xyz", cause}}});
}

TEST_F(Extremes, CloudsMayHaveAnySizeWithinTheLimits) {
  write("one.xyz", sphere_cloud(1));
  const double spacing = json_of({"info", "one.xyz"})["spacing"];
  for (const double size : {1e-11, 1e17}) {
    write("in.xyz", sphere_cloud(size));
    EXPECT_NEAR(json_of({"info", "in.xyz"})["spacing"].get<double>() / size, spacing, 1e-4) << size;
  }
  for (const char* size : {"1e-300", "1e-60", "1e-40", "1e-20"}) {
    write("in.xyz", sphere_cloud(std::stod(size)));
    expect_failure({"info", "in.xyz"}, 1, "in.xyz: extends over 2e");
  }
  for (const double size : {1e19, 1e38, 1e300}) {
    write("in.xyz", sphere_cloud(size));
    expect_failure({"info", "in.xyz"}, 1, "in.xyz: holds no points");
  }
}

TEST_F(Extremes, APointFarAwayIsLeftOutOrCounted) {
  write("far.xyz", sphere_cloud(1) + "1e30 0 0\n");
  const nlohmann::json far = json_of({"info", "far.xyz"});
  EXPECT_EQ(far["points"], 300);
  EXPECT_EQ(far["warnings"].size(), 1u);
  write("near.xyz", sphere_cloud(1) + "1e17 0 0\n");
  EXPECT_NEAR(json_of({"info", "near.xyz"})["upper"][0].get<double>(), 1e17, 1e11);
}

TEST_F(Extremes, MeshesMayHaveAnySizeWithinTheLimits) {
  for (const double size : {1e-11, 1.0, 1e17}) {
    write("in.off", cube_mesh(size));
    const nlohmann::json whole = json_of({"measure", "in.off"})["whole"];
    EXPECT_NEAR(whole["area"].get<double>() / (size * size), 6, 1e-5) << size;
    EXPECT_NEAR(whole["volume"].get<double>() / (size * size * size), 1, 1e-5) << size;
  }
  for (const char* command : {"measure", "info"}) {
    write("in.off", cube_mesh(1e-40));
    expect_failure({command, "in.off"}, 1, "in.off: extends over 1e-40 only");
  }
}

TEST_F(Extremes, VolumesMayHaveAnySpacingWithinTheLimits) {
  for (const double spacing : {1e-35, 1.0, 1e35}) {
    write("in.mha", linear_volume(spacing));
    const std::string at = fmt::format("{0:.17g},{0:.17g},{0:.17g}", 1.5 * spacing);
    const nlohmann::json value = json_of({"volume", "probe", "in.mha", "--at", at})["values"][0];
    EXPECT_NEAR(value["value"].get<double>(), 10.5, 1e-4) << spacing;
    EXPECT_NEAR(value["gradient"][2].get<double>() * spacing, 4, 1e-4) << spacing;
  }
  const std::vector<std::pair<double, const char*>> beyond{{1e-300, "in.mha: its header gives a spacing of 1e-300"},
                                                           {1e-60, "in.mha: its header gives a spacing of 1e-60"},
                                                           {1e-40, "in.mha: extends over 3e-40 only"},
                                                           {4e35, "in.mha: reaches to 1.2e+36"},
                                                           {1e300, "in.mha: its header gives a spacing of 1e+300"}};
  for (const auto& [spacing, cause] : beyond) {
    write("in.mha", linear_volume(spacing));
    expect_failures({{{"info", "in.mha"}, 1, {cause}}, {{"volume", "probe", "in.mha", "--at", "0,0,0"}, 1, {cause}}});
  }
}

TEST_F(Extremes, WhatIsWrittenIsRead) {
  for (const char* solid : {"sphere(9e17)", "sphere(6e-13)"}) {
    json_of({"csg", solid, "-o", "s.ply", "--resolution", "12"});
    EXPECT_EQ(json_of({"measure", "s.ply"})["topology"]["components"], 1) << solid;
  }
  write("in.off", cube_mesh(1));
  write("h.txt", "0 0 0 0 0 0\n1 0 0 1e30 0 0\n0 1 0 0 1 0\n0 0 1 0 0 1\n");
  expect_failures(
      {{{"deform", "in.off", "-o", "d.ply", "--handles", "h.txt"}, 1, {"d.ply: would have coordinates up to"}},
       {{"csg", "sphere(2e18)", "-o", "s2.ply"}, 2, {"reaches out to 2e+18"}},
       {{"csg", "sphere(1e-13)", "-o", "s2.ply"}, 1, {"2e-13 across: too small"}}});
  EXPECT_FALSE(std::filesystem::exists(path("d.ply")));
}

TEST_F(Extremes, ThingsInDifferentUnitsAreAskedAbout) {
  write("mm.off", cube_mesh(1000)), write("m.off", cube_mesh(1)), write("also_m.off", cube_mesh(1.5));
  const auto warnings = [&](const char* file, const char* reference) {
    const Json json = json_of({"assess", file, reference});
    EXPECT_LT(json["to_reference"]["samples"], json["warnings"].empty() ? 500'000 : 10'000);
    return json["warnings"].dump();
  };
  EXPECT_NE(warnings("mm.off", "m.off").find("1000 times as large as the reference"), std::string::npos);
  EXPECT_NE(warnings("m.off", "mm.off").find("1000 times as small as the reference"), std::string::npos);
  EXPECT_EQ(warnings("m.off", "also_m.off"), "[]");
}

TEST_F(Extremes, OptionsBeyondAllMeasureAreErrors) {
  write("in.off", cube_mesh(1));
  const auto picture = [](std::vector<std::string> more) {
    std::vector<std::string> all{"render", "in.off", "-o", "p.png", "--width", "20", "--height", "20"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  expect_failures({{picture({"--look-at", "1e300,0,0"}), 2, {"--look-at", "too far away"}},
                   {picture({"--look-at", "1e30,0,0", "--orthographic"}), 2, {"--look-at", "too far away"}},
                   {picture({"--look-at", "0,0,0", "--orthographic", "--look-radius", "1e300"}), 2, {"--look-radius"}},
                   {picture({"--look-at", "0,0,0", "--look-radius", "1e-300"}), 2, {"--look-radius"}},
                   {{"csg", "sphere(1e-44)", "-o", "s.ply"}, 1, {"2e-44 across"}},
                   {{"csg", "sphere(1e300)", "-o", "s.ply"}, 2, {"reaches out to 1e+300"}},
                   {{"convert", "in.off", "-o", "c.ply", "--scale", "1e-40"}, 1, {"shrinks all lengths"}},
                   {{"convert", "in.off", "-o", "c.ply", "--scale", "1e300"}, 1, {"beyond 1e18"}}});
}

}  // namespace
}  // namespace sansmesh::test
