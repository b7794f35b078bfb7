// Function files with right checksums and wrong contents: reading them throws one FileError.
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "function/edit_shapes.h"
#include "io/io_test_tools.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/function_file.h"
#include "support/section_bytes.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;
using Json = nlohmann::json;

class WrongContents : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const Folder folder;
    write_fitted_function(folder / "f.smf", fitted(colored(cube(4000))));
    good_ = unpacked(slurp(folder / "f.smf"));
  }

  void expect_bad(const std::vector<RawSection>& sections, const std::string& part, const std::string& what) {
    const std::string file = folder_.put("bad.smf", packed(sections));
    SCOPED_TRACE(what);
    expect_file_error(file, part, [&] { read_fitted_function(file); });
  }
  static RawSection& section(std::vector<RawSection>& sections, const std::string& name) {
    for (RawSection& s : sections)
      if (s.name == name) return s;
    throw std::runtime_error("no section " + name);
  }
  /// Changes one element of a section by `edit(element)`.
  template <class T, class Edit>
  void expect_bad_element(const std::string& name, std::size_t i, Edit&& edit, const std::string& what) {
    std::vector<RawSection> sections = good_;
    std::string& bytes = section(sections, name).bytes;
    T value = number_at<T>(bytes, i * sizeof(T));
    edit(value);
    put_number(bytes, i * sizeof(T), value);
    expect_bad(sections, "damaged: ", name + ": " + what);
  }
  template <class Edit>
  void expect_bad_meta(Edit&& edit, const std::string& what) {
    std::vector<RawSection> sections = good_;
    std::string& text = section(sections, "META").bytes;
    Json json = Json::parse(text);
    edit(json);
    text = json.dump();
    expect_bad(sections, "damaged: ", "META: " + what);
  }

  static std::vector<RawSection> good_;
  Folder folder_;
};
std::vector<RawSection> WrongContents::good_;

TEST_F(WrongContents, GoodIsRead) {
  const FittedFunction function = read_fitted_function(folder_.put("good.smf", packed(good_)));
  EXPECT_GT(function.field.report().creased, 10u);
  EXPECT_GT(function.field.functions().size(), function.field.data().supports.size());
}

TEST_F(WrongContents, Functions) {
  const auto change = [&](const char* what, auto&& edit) {
    expect_bad_element<LocalFunction>("FUNCTION", 5, edit, what);
  };
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, inf, -inf, 1e30f}) {
    change("coefficient", [&](LocalFunction& f) { f.coefficient[2] = bad; });
    change("unused coefficient", [&](LocalFunction& f) { f.coefficient[14] = bad; });
    change("centre", [&](LocalFunction& f) { f.center.y = bad; });
    change("radius", [&](LocalFunction& f) { f.radius = bad; });
    change("scale", [&](LocalFunction& f) { f.scale = bad; });
    change("normal", [&](LocalFunction& f) { f.nu.z = bad; });
    change("frame", [&](LocalFunction& f) { f.xi.x = bad; });
  }
  change("negative radius", [](LocalFunction& f) { f.radius = -f.radius; });
  change("no radius", [](LocalFunction& f) { f.radius = 0; });
  change("a ball of everything", [](LocalFunction& f) { f.radius *= 10; });
  change("no scale", [](LocalFunction& f) { f.scale = 0; });
  change("tiny scale", [](LocalFunction& f) { f.scale = 1e-40f; });
  change("elsewhere", [](LocalFunction& f) { f.center.x += 4 * f.radius; });
  for (const int degree : {-1, 5, 1 << 30}) change("degree", [&](LocalFunction& f) { f.degree = degree; });
  change("convex", [](LocalFunction& f) { f.convex = 2; });
  for (const int next : {-1, 1, 6, 7, 1 << 30}) change("next", [&](LocalFunction& f) { f.next = next; });
}

TEST_F(WrongContents, ChainsOfPieces) {
  const auto functions = section(good_, "FUNCTION").bytes.size() / sizeof(LocalFunction);
  const auto supports = section(good_, "SUPPORT").bytes.size() / sizeof(Support);
  const auto next_of = [&](std::size_t i) {
    return number_at<LocalFunction>(section(good_, "FUNCTION").bytes, i * sizeof(LocalFunction)).next;
  };
  std::size_t creased = 0;
  while (next_of(creased) == 0) ++creased;
  const auto point = [&](std::size_t i, std::size_t next, const char* what) {
    expect_bad_element<LocalFunction>(
        "FUNCTION", i, [&](LocalFunction& f) { f.next = static_cast<std::int32_t>(next); }, what);
  };
  point(creased, 0, "pieces that belong to none");
  point(creased, functions, "another piece");
  point(creased, functions + 1, "beyond the end");
  point(creased, supports, "a support");
  point(supports, supports + 1, "itself");
  point(functions - 1, supports + 1, "a circle");
  point(functions - 1, functions + 1, "beyond the end");
  expect_bad_element<LocalFunction>(
      "FUNCTION", functions - 1, [](LocalFunction& f) { f.coefficient[0] = std::nanf(""); }, "a piece");
}

TEST_F(WrongContents, Supports) {
  const auto change = [&](const char* what, auto&& edit) { expect_bad_element<Support>("SUPPORT", 7, edit, what); };
  change("level", [](Support& s) { s.level = 255; });
  change("level", [](Support& s) { s.level = static_cast<std::uint8_t>(s.level + 1); });
  change("level", [](Support& s) { s.level = 0; });
  change("code", [](Support& s) { s.code = ~std::uint64_t{0}; });
  change("code", [](Support& s) { s.code += 64; });
  change("code", [](Support& s) { s.code = 0; });
  change("foot", [](Support& s) { s.foot.x = std::nanf(""); });
  change("foot", [](Support& s) { s.area = 1e-3f, s.foot.x = 100; });
  change("area", [](Support& s) { s.area = -1; });
  change("area", [](Support& s) { s.area = 1e20f; });
  change("error", [](Support& s) { s.error = std::nanf(""); });
  change("coverage", [](Support& s) { s.coverage = 1e20f; });
  change("state", [](Support& s) { s.state = 2; });
  change("creased", [](Support& s) { s.creased = 2; });
  // The same block twice.
  std::vector<RawSection> sections = good_;
  std::string& bytes = section(sections, "SUPPORT").bytes;
  bytes.replace(sizeof(Support), sizeof(Support), bytes.substr(0, sizeof(Support)));
  expect_bad(sections, "a support is invalid", "twice");
}

TEST_F(WrongContents, Tree) {
  const std::size_t cells = section(good_, "LEVCODE").bytes.size() / 8;
  expect_bad_element<std::uint64_t>(
      "LEVCODE", 0, [](std::uint64_t& c) { c = 1; }, "root");
  expect_bad_element<std::uint64_t>(
      "LEVCODE", cells - 1, [](std::uint64_t& c) { c = 0; }, "order");
  expect_bad_element<std::uint64_t>(
      "LEVCODE", cells - 1, [](std::uint64_t& c) { c += 8; }, "not of its parent");
  for (const float bad : {-1.0f, std::nanf("")})
    expect_bad_element<float>(
        "LEVGAP", cells / 2, [&](float& g) { g = bad; }, "gap");
  for (const std::uint32_t bad : {std::uint32_t{0}, std::uint32_t{9}, ~std::uint32_t{0}})
    expect_bad_element<std::uint32_t>(
        "LEVCHILD", 1, [&](std::uint32_t& c) { c = bad; }, "child");
  expect_bad_element<std::uint32_t>(
      "LEVCHILD", 0, [](std::uint32_t& c) { c = 1; }, "first child");
}

TEST_F(WrongContents, Slopes) {
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity(), 0.0f, 0.5f, -1.0f})
    expect_bad_element<float>(
        "SLOPE", 1, [&](float& s) { s = bad; }, "slope");
  // Not a bound of its function.
  expect_bad_element<float>(
      "SLOPE", 1, [&](float& s) { s *= 0.999f; }, "slope");
}

/// Assumptions of proofs about functions.
TEST_F(WrongContents, FunctionsThatAreNotWhatTheySeem) {
  expect_bad_element<LocalFunction>(
      "FUNCTION", 1, [](LocalFunction& f) { f.xi = normalized(f.xi + f.nu * 0.01f); }, "frame that is not orthogonal");
  expect_bad_element<LocalFunction>(
      "FUNCTION", 1, [](LocalFunction& f) { f.eta = f.eta * 1.001f; }, "frame that is not of unit vectors");
  expect_bad_element<LocalFunction>(
      "FUNCTION", 1, [](LocalFunction& f) { f.degree = 1, f.coefficient.back() = 0.1f; },
      "coefficient beyond its degree");
  expect_bad_element<LocalFunction>(
      "FUNCTION", 1, [](LocalFunction& f) { f.xi = f.eta = f.nu = {}, f.degree = 1, f.coefficient[1] = 5; },
      "constant that is none");
}

TEST_F(WrongContents, Samples) {
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity(), 1e20f}) {
    expect_bad_element<Vec3f>(
        "POSITION", 3, [&](Vec3f& p) { p.x = bad; }, "position");
    expect_bad_element<Vec3f>(
        "NORMAL", 3, [&](Vec3f& n) { n.z = bad; }, "normal");
  }
}

TEST_F(WrongContents, SectionsThatDoNotFit) {
  const std::map<std::string, bool> needed{
      {"META", true},     {"FUNCTION", true}, {"SUPPORT", true}, {"LEVCODE", true},   {"LEVGAP", true},
      {"LEVCHILD", true}, {"NORMAL", true},   {"SLOPE", false},  {"POSITION", false}, {"COLOR", false}};
  for (const auto& [name, must] : needed) {
    for (const int shorter : {0, 1}) {  // one element less, or none
      std::vector<RawSection> sections = good_;
      std::string& bytes = section(sections, name).bytes;
      bytes.resize(shorter ? bytes.size() - section(sections, name).element_size : 0);
      expect_bad(sections, "", name + (shorter ? " shorter" : " empty"));
    }
    std::vector<RawSection> sections = good_;
    section(sections, name).element_size = 1;
    if (name != "META") expect_bad(sections, "elements of section " + name, name + " of bytes");
    sections = good_;
    std::erase_if(sections, [&](const RawSection& s) { return s.name == name; });
    if (must) {
      expect_bad(sections, name == "NORMAL" ? "no normals" : "has no section " + name, name + " missing");
    } else {
      EXPECT_NO_THROW(read_fitted_function(folder_.put("fine.smf", packed(sections)))) << name;
    }
  }
}

TEST_F(WrongContents, Description) {
  const std::vector<Json> wrong{Json(),   "text",           -1, -1.5, 1e300, true, Json::array(), Json::object(),
                                1u << 31, ~std::uint64_t{0}};
  const Json good = Json::parse(section(good_, "META").bytes);
  // Every value, at any depth: missing, or of another type or size.
  const Json flat = good.flatten();
  for (const auto& [path, value] : flat.items()) {
    const Json::json_pointer at(path);
    for (const Json& bad : wrong) {
      std::vector<RawSection> sections = good_;
      Json json = good;
      json[at] = bad;
      section(sections, "META").bytes = json.dump();
      const std::string file = folder_.put("bad.smf", packed(sections));
      // Some are valid by chance: the result must then be a function.
      try {
        const FittedFunction function = read_fitted_function(file);
        std::vector<double> values(1);
        std::vector<Vec3> gradients(1);
        function.field.evaluate(std::vector<Vec3>{function.field.bounds().center()}, values, gradients);
        EXPECT_TRUE(std::isfinite(values[0])) << path << " = " << bad;
      } catch (const FileError& error) {
        const char* part = path == "/kind" && bad.is_string() ? "bad.smf: holds another kind" : "bad.smf: damaged: ";
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
      } catch (const std::exception& error) {
        ADD_FAILURE() << path << " = " << bad << ": " << error.what();
      }
    }
  }
  for (const auto& [key, value] : good.items())
    expect_bad_meta([k = key](Json& json) { json.erase(k); }, "without " + key);
  expect_bad_meta([](Json& j) { j["unit"] = 0; }, "unit");
  expect_bad_meta([](Json& j) { j["unit"] = -1; }, "unit");
  expect_bad_meta([](Json& j) { j["origin"] = {1, 2}; }, "origin");
  expect_bad_meta([](Json& j) { j["field_origin"][0] = 1e300; }, "field_origin");
  expect_bad_meta([](Json& j) { j["cube"]["edge"] = 1e-30; }, "edge");
  expect_bad_meta([](Json& j) { j["cube"]["edge"] = -1; }, "edge");
  expect_bad_meta([](Json& j) { j["cube"]["lower"][1] = 1e38; }, "lower");
  expect_bad_meta([](Json& j) { j["levels"][1] = ~std::uint64_t{0}; }, "levels");
  expect_bad_meta([](Json& j) { j["levels"][1] = -1; }, "levels");
  expect_bad_meta([](Json& j) { j["levels"] = Json::array(); }, "levels");
  expect_bad_meta([](Json& j) { j["levels"] = std::vector<int>(1000, 0); }, "levels");
  expect_bad_meta([](Json& j) { j["basis"]["sort_depth"] = 63; }, "sort_depth");
  expect_bad_meta([](Json& j) { j["basis"]["finest"] = -3; }, "finest");
  expect_bad_meta([](Json& j) { j["options"]["max_degree"] = 9; }, "max_degree");
  expect_bad_meta([](Json& j) { j["options"]["max_degree"] = 3.5; }, "max_degree");
  expect_bad_meta([](Json& j) { j["report"]["spacing"] = nullptr; }, "spacing");
  expect_bad_meta([](Json& j) { j["history"] = 5; }, "history");
  expect_bad_meta([](Json& j) { j["history"] = {1, 2}; }, "history");
}

TEST_F(WrongContents, TextThatIsNoDescription) {
  const std::string good = section(good_, "META").bytes;
  const std::string texts[] = {"",
                               "{",
                               "null",
                               "[]",
                               "\xff\xfe",
                               std::string(good.size(), '\0'),
                               good.substr(0, good.size() / 2),
                               good + "x",
                               std::string(1 << 20, '['),
                               "{\"kind\":" + std::string(1 << 20, '{'),
                               std::string(17 << 20, ' ') + good};
  for (const std::string& text : texts) {
    std::vector<RawSection> sections = good_;
    section(sections, "META").bytes = text;
    expect_bad(sections, "damaged: ", text.substr(0, 20));
  }
  // Very many fields must not take more than one pass.
  std::string many = "{";
  for (int i = 0; i < 200000; ++i) many.append("\"").append(std::to_string(i)).append("\":0,");
  std::vector<RawSection> sections = good_;
  section(sections, "META").bytes = many + good.substr(1);
  EXPECT_NO_THROW(read_fitted_function(folder_.put("many.smf", packed(sections))));
  section(sections, "META").bytes = R"({"kind":"radial\nbasis"})";
  expect_bad(sections, "another kind of function", "kind");
}

}  // namespace
}  // namespace sansmesh::inline v1
