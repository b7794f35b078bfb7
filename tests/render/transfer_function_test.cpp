#include "sansmesh/volume_look.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "render/analytic_volumes.h"
#include "sansmesh/error.h"
#include "sansmesh/render/scene/color_space.h"
#include "sansmesh/render/scene/color_words.h"
#include "sansmesh/render/scene/lighting.h"
#include "sansmesh/render/volume/transfer_presets.h"
#include "sansmesh/render/volume/transfer_table.h"
#include "support/places.h"

namespace sansmesh::inline v1 {
namespace {

/// −ln(1 − o) over [0, v] for o = v, in closed form.
double ramp_depth(double v) { return (1 - v) * std::log1p(-v) + v; }

TransferFunction ramp(double most = 0.9) {
  TransferFunction f;
  f.colors = {{0, {1, 0, 0}}, {1, {1, 0, 0}}};
  f.opacities = {{0, 0}, {most, most}};
  return f;
}

TEST(TransferTable, DepthOfARampIsItsIntegral) {
  const TransferTable table(ramp());
  for (const double v : {0.05, 0.2, 0.5, 0.89}) {
    const double found = (table.at(table.coordinate(v)).depth - table.at(table.coordinate(0)).depth) / table.scale();
    EXPECT_NEAR(found, ramp_depth(v), 1e-6) << v;
  }
}

TEST(TransferTable, GoesOnBeyondItsEnds) {
  TransferFunction f = ramp();
  f.opacities = {{0, 0.5}, {0.5, 0.5}, {0.5, 0}, {1, 0}};
  const TransferTable table(f);
  const double slope = -std::log(0.5);
  const auto depth = [&](double v) { return table.at(table.coordinate(v)).depth / table.scale(); };
  EXPECT_NEAR(depth(-2) - depth(0), -2 * slope, 1e-9);
  EXPECT_NEAR(depth(0.5) - depth(0), 0.5 * slope, 1e-6);
  EXPECT_NEAR(depth(7) - depth(0.5), 0, 1e-6);
  EXPECT_TRUE(table.clear(0.6, 100));
  EXPECT_FALSE(table.clear(-5, -4));
  EXPECT_FALSE(table.clear(0.4, 0.9));
}

TEST(TransferTable, EndsOfLargeValuesAreEnds) {
  TransferFunction f = ramp();
  f.colors = {{5e17, {1, 0, 0}}, {6e17, {1, 0, 0}}};
  f.opacities = {{5e17, 0}, {5e17, 1}, {6e17, 1}};
  const TransferTable table(f);
  EXPECT_EQ(table.density(table.coordinate(2e17)).depth, 0);
  EXPECT_GT(table.density(table.coordinate(5.5e17)).depth, 0);
}

TEST(TransferTable, ColoursOfAPieceAreWeightedByExtinction) {
  // Red and clear below, blue and dense above: all emission is blue.
  TransferFunction f;
  f.mixing = ColorMixing::step;
  f.colors = {{0, {1, 0, 0}}, {0.5, {0, 0, 1}}, {1, {0, 0, 1}}};
  f.opacities = {{0, 0}, {0.5, 0}, {0.5, 0.6}, {1, 0.6}};
  const TransferTable table(f);
  const auto a = table.at(table.coordinate(0)), b = table.at(table.coordinate(1));
  const double depth = b.depth - a.depth;
  EXPECT_NEAR((b.red - a.red) / depth, 0, 1e-4);
  EXPECT_NEAR((b.blue - a.blue) / depth, 1, 1e-4);
}

TEST(TransferFunction, MixesInLabWithEvenLightness) {
  TransferFunction f;
  f.colors = {{0, {0.1f, 0.2f, 0.6f}}, {2, {0.9f, 0.8f, 0.3f}}};
  f.opacities = {{0, 0}};
  const double low = lab_of_srgb(f.color(0)).x, high = lab_of_srgb(f.color(2)).x;
  for (const double t : {0.25, 0.5, 0.75}) EXPECT_NEAR(lab_of_srgb(f.color(2 * t)).x, low + t * (high - low), 1e-3);
  f.mixing = ColorMixing::step;
  EXPECT_EQ(f.color(1.999), f.colors[0].color);
  EXPECT_EQ(f.color(2), f.colors[1].color);
}

TEST(ColorSpace, LabAndBack) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(0, 1);
  for (int i = 0; i < 200; ++i) {
    const Vec3f c{u(random), u(random), u(random)};
    EXPECT_LT(norm(srgb_of_lab(lab_of_srgb(c)) - c), 2e-4f);
    EXPECT_LT(norm(srgb_color(linear_color(c)) - c), 1e-5f);
  }
  EXPECT_NEAR(lab_of_srgb({1, 1, 1}).x, 100, 1e-3);
  // The middle between red and green along the hue is yellow.
  EXPECT_LT(norm(mix_hsv({1, 0, 0}, {0, 1, 0}, 0.5) - Vec3f{1, 1, 0}), 1e-5f);
  const Vec3f middle = mix_diverging({0.23f, 0.30f, 0.75f}, {0.70f, 0.016f, 0.15f}, 0.5);
  EXPECT_GT(std::min({middle.x, middle.y, middle.z}), 0.8f);  // the middle is light and grey
}

TEST(ColorSpace, ColoursOfHexadecimalDigits) {
  for (int level = 0; level < 256; ++level) {
    const std::string text = fmt::format("#{:02x}{:02X}00", level, 255 - level);
    const auto color = color_of_hex(text);
    ASSERT_TRUE(color) << text;
    EXPECT_EQ(*color, (Vec3f{static_cast<float>(level) / 255, static_cast<float>(255 - level) / 255, 0})) << text;
  }
  for (const char* bad : {"", "#", "#12345", "#1234567", "1234567", "#12345g", "#+12345", "# 12345", "#0x1234"})
    EXPECT_FALSE(color_of_hex(bad)) << bad;
}

TEST(TransferFunction, OwnJsonComesBackTheSame) {
  const ValueHistogram h = value_histogram(test::linear_volume({1, 2, 0}, -1));
  for (const std::string_view name : transfer_function_presets()) {
    TransferFunction f = transfer_function_preset(name, h);
    f.reference_length = 0.25;
    f.name = "a \"name\"";
    EXPECT_EQ(parse_transfer_function(transfer_function_json(f), "f.json"), f) << name;
  }
}

TEST(TransferFunction, ReadsParaViewsMaps) {
  const std::string map =
      R"([{"ColorSpace": "Diverging", "Name": "Warm", "NanColor": [1, 1, 0],
           "RGBPoints": [10, 0.23, 0.30, 0.75, 15, 0.86, 0.86, 0.86, 20, 0.7, 0.016, 0.15],
           "Points": [10, 0, 0.5, 0, 20, 0.6, 0.5, 0]}])";
  const TransferFunction f = parse_transfer_function(map, "warm.json");
  EXPECT_EQ(f.name, "Warm");
  EXPECT_EQ(f.range(), (std::pair{10.0, 20.0}));
  EXPECT_NEAR(f.opacity(15), 0.3, 1e-12);
  EXPECT_NEAR(static_cast<double>(f.color(15).x), 0.86, 1e-6);
  // A midpoint at three quarters: half the opacity is reached there.
  const TransferFunction late = parse_transfer_function(
      R"({"ColorSpace": "HSV", "RGBPoints": [0, 1, 0, 0, 1, 0, 1, 0], "Points": [0, 0, 0.75, 0, 1, 0.8, 0.5, 0]})",
      "f");
  EXPECT_NEAR(late.opacity(0.75), 0.4, 1e-9);
  EXPECT_NEAR(static_cast<double>(late.color(0.5).y), 1, 1e-6);
}

TEST(TransferFunction, BadFilesGiveOneLineWithTheirName) {
  const std::string head = R"({"version": 1, )";
  for (const std::string& text : {
           std::string(""),
           std::string("{"),
           std::string("3"),
           std::string("[]"),
           std::string("[3]"),
           head + R"("colors": [[0, "#00000g"]], "opacities": [[0, 1]]})",
           head + R"("colors": [[0, "#000000"]], "opacities": [[0, 2]]})",
           head + R"("colors": [[1, "#000000"], [0, "#000000"]], "opacities": [[0, 1]]})",
           head + R"("colors": [], "opacities": [[0, 1]]})",
           head + R"("colors": [[0, 1, 1]], "opacities": [[0, 1]]})",
           head + R"("colors": [[0, "#000000"]]})",
           head + R"("colors": [[0, "#000000"]], "opacities": [[0, 1]], "mixing": "hsl"})",
           head + R"("colors": [[0, "#000000"]], "opacities": [[0, 1]], "opacity": 3})",
           head + R"("colors": [[0, "#000000"]], "opacities": [[0, 1]], "reference_length": -1})",
           std::string(R"({"version": 2, "colors": [[0, "#000000"]], "opacities": [[0, 1]]})"),
           std::string(R"([{"ColorSpace": "RGB", "RGBPoints": [0, 1, 1]}])"),
           std::string(R"([{"ColorSpace": "XYZ", "RGBPoints": [0, 1, 1, 1]}])"),
           std::string(R"([{"IndexedColors": [0, 1, 1]}])"),
       }) {
    try {
      parse_transfer_function(text, "dir/bad.json");
      ADD_FAILURE() << text;
    } catch (const FileError& error) {
      EXPECT_EQ(std::string(error.what()).rfind("dir/bad.json", 0), 0u) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(read_transfer_function("/nowhere/at all.json"), FileError);
}

/// Values of a body of two materials in air, with noise.
std::vector<double> scanned(double air, double body, double dense, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.02 * (body - air));
  std::vector<double> values;
  for (int i = 0; i < 60000; ++i) values.push_back(air + std::abs(noise(random)));
  for (int i = 0; i < 30000; ++i) values.push_back(body + noise(random));
  for (int i = 0; i < 4000; ++i) values.push_back(dense + 3 * noise(random));
  for (int i = 0; i < 3000; ++i) values.push_back(air + (body - air) * i / 3000.0);
  return values;
}

TEST(ValueHistogram, PlacesTellOfVolumesThatFillLittleOfTheirBox) {
  const test::TwoSpecks specks({1, 0, 0});
  EXPECT_THROW(value_histogram(specks.field, 1000), DataError);
  std::vector<Vec3> points = specks.points();
  points.push_back({std::nan(""), 0, 0});
  const ValueHistogram h = value_histogram(specks.field, 1000, points);
  EXPECT_DOUBLE_EQ(h.least, specks.centers[0].x - 0.5 * specks.radius);
  EXPECT_DOUBLE_EQ(h.most, specks.centers[1].x + 0.5 * specks.radius);
  // More samples than points: some from all parts.
  const ValueHistogram fewer = value_histogram(specks.field, 10, points);
  EXPECT_LT(fewer.least, 0.2);
  EXPECT_GT(fewer.most, 0.8);
  // If the lattice suffices, samples change nothing.
  const test::FormulaVolume full = test::linear_volume({1, 0, 0});
  EXPECT_EQ(value_histogram(full, 1000, std::vector<Vec3>{{7, 0, 0}}).most, value_histogram(full, 1000).most);
}

TEST(ValueHistogram, LatticesGetFinerUntilTheVolumeIsFound) {
  test::FormulaVolume field = test::linear_volume({1, 0, 0});
  field.in = [](const Vec3& x) { return std::abs(x.x - 0.5) < 0.015; };  // between the points of the first lattice
  const ValueHistogram h = value_histogram(field, 10 * 10 * 10);
  EXPECT_GE(h.least, 0.485);
  EXPECT_LE(h.most, 0.515);
}

TEST(SuggestTransferFunction, DropsAirAndShowsBone) {
  // In Hounsfield units, in those plus 1024, and in bytes.
  for (const auto& [air, body, dense] :
       {std::array{-1000.0, 50.0, 900.0}, {24.0, 1074.0, 1924.0}, {3.0, 100.0, 190.0}}) {
    const TransferFunction f = suggest_transfer_function(value_histogram(scanned(air, body, dense, 1))).function;
    EXPECT_EQ(f.opacity(air), 0);
    EXPECT_EQ(f.opacity(air + 0.2 * (body - air)), 0);
    EXPECT_GT(f.opacity(body), 0);
    EXPECT_LT(f.opacity(body), 0.1);
    EXPECT_GT(f.opacity(dense), 0.4);
    // CT presets find bone and soft tissue in all of these units.
    const TransferFunction bone = transfer_function_preset("ct-bone", value_histogram(scanned(air, body, dense, 2)));
    EXPECT_EQ(bone.opacity(body), 0);
    EXPECT_GT(bone.opacity(dense), 0.4);
    const TransferFunction soft =
        transfer_function_preset("ct-soft-tissue", value_histogram(scanned(air, body, dense, 3)));
    EXPECT_EQ(soft.opacity(air), 0);
    EXPECT_GT(soft.opacity(body), 0.02);
  }
}

TEST(SuggestTransferFunction, ShowsRareValuesOfTheWholeRange) {
  // A stream of value 1 almost everywhere, with a wake from 0.3 to 4: no background, nothing removed.
  std::mt19937 random(5);
  std::normal_distribution<double> stream(1, 0.05);
  std::uniform_real_distribution<double> wake(0.3, 4);
  std::vector<double> values, slopes;
  for (int i = 0; i < 50000; ++i) values.push_back(stream(random)), slopes.push_back(0.1);
  for (int i = 0; i < 5000; ++i) values.push_back(wake(random)), slopes.push_back(3);
  const TransferFunction f = suggest_transfer_function(value_histogram(values, slopes)).function;
  EXPECT_LT(f.opacity(1), 0.3 * f.opacity(3.5));
  for (const double v : {0.4, 1.0, 2.0, 3.9}) EXPECT_GT(f.opacity(v), 0) << v;
  // Steep values are more opaque than flat ones of the same frequency.
  for (std::size_t i = 0; i < values.size(); ++i) slopes[i] = values[i] > 3 ? 3 : 0.1;
  const TransferFunction g = suggest_transfer_function(value_histogram(values, slopes)).function;
  EXPECT_GT(g.opacity(3.5), 1.5 * g.opacity(2.3));
}

TEST(SuggestTransferFunction, VeilsAreAboutAsStrongHoweverSteepSurfacesAre) {
  // Air and a body of 100 with denser parts, whose surface, a sixth of the values, rises by 100 over `thick`.
  for (const double thick : {1.0, 3.0}) {
    std::vector<double> values, slopes;
    for (int i = 0; i < 60000; ++i) {
      const double t = i % 6 == 0 ? (i % 997) / 997.0 : 0;
      const double body = i % 50 == 4 ? 130 : 100 + (i % 7) * 0.5;
      values.push_back(i % 6 == 0 ? 100 * t : i % 2 == 0 ? body : (i % 5) * 0.5);
      slopes.push_back(i % 6 == 0 ? 100 / thick : 0);
    }
    ValueHistogram h = value_histogram(values, slopes);
    h.diagonal = 100, h.across = 57;
    const SuggestedTransferFunction f = suggest_transfer_function(h);
    ASSERT_EQ(f.function.name, "materials");
    // Absorption along the lower half of the rise, of opacities for a fiftieth of the diagonal.
    double depth = 0;
    for (int i = 0; i < 1000; ++i)
      if (const double t = (i + 0.5) / 1000; t < 0.72)
        depth -= std::log1p(-f.function.opacity(100 * t)) / 2 * thick / 1000;
    EXPECT_GT(depth, 0.12) << thick;
    EXPECT_LT(depth, 0.28) << thick;
    EXPECT_NE(suggest_transfer_function(h, false).function.name, "materials");
  }
}

TEST(SuggestTransferFunction, ThinVolumesKeepBackAsMuchAsThickOnes) {
  std::vector<double> values;
  for (int i = 0; i <= 1000; ++i) values.push_back(0.001 * i * i);
  ValueHistogram h = value_histogram(values);
  const TransferFunction thick = suggest_transfer_function(h).function;
  h.diagonal = 10, h.across = 5.7735 / 8;
  const TransferFunction thin = suggest_transfer_function(h).function;
  double a = 0, b = 0;
  for (const double v : values) a -= std::log1p(-thick.opacity(v)), b -= std::log1p(-thin.opacity(v));
  EXPECT_GT(b / a, 4);
  EXPECT_LT(b / a, 9);
}

TEST(SuggestTransferFunction, DivergesWhereThereAreBothSigns) {
  std::vector<double> values;
  for (int i = 0; i <= 1000; ++i) values.push_back(-3 + 0.005 * i);  // −3..2
  const TransferFunction f = suggest_transfer_function(value_histogram(values)).function;
  EXPECT_NEAR(f.colors.front().value, -f.colors.back().value, 1e-12);
  const Vec3f zero = f.color(0);
  EXPECT_GT(std::min({zero.x, zero.y, zero.z}), 0.9f);
  EXPECT_NO_THROW(suggest_transfer_function(value_histogram(std::vector<double>(10, 4.0))).function.validate());
  EXPECT_THROW(value_histogram(std::vector<double>(3, std::nan(""))), DataError);
  EXPECT_THROW(transfer_function_preset("bones", value_histogram(values)), ArgumentError);
}

TEST(ExtraTransferFunction, EngineAndHeadAreMaterialsBuckyBallIsARange) {
  const std::filesystem::path folder = test::source_file("../shared/data/volumes/grids");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data";
  const auto read = [&](const char* name, auto type) {
    std::ifstream in(folder / name, std::ios::binary);
    std::vector<double> values;
    for (decltype(type) v; in.read(reinterpret_cast<char*>(&v), sizeof v);) values.push_back(v);
    return value_histogram(values);
  };
  const ValueHistogram engine = read("engine.raw", std::uint8_t{}), head = read("headsq.raw", std::int16_t{});
  for (const auto& [h, air, body, dense] : {std::tuple{&engine, 5.0, 137.0, 200.0}, {&head, 120.0, 1070.0, 1600.0}}) {
    const TransferFunction f = suggest_transfer_function(*h).function;
    EXPECT_EQ(f.opacity(air), 0);
    EXPECT_LT(f.opacity(body), 0.1);
    EXPECT_GT(f.opacity(dense), 0.3);
  }
  for (const char* name : {"bucky.raw", "nucleon.raw", "neghip.raw", "ironprot.raw"}) {
    const TransferFunction f = suggest_transfer_function(read(name, std::uint8_t{})).function;
    EXPECT_EQ(f.opacity(0), 0) << name;
    EXPECT_GT(f.opacity(150), f.opacity(60)) << name;
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
