// Function files: what is read is what was written, to the bit; and whatever else such a file holds, reading it ends
// with one FileError.
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "io/io_test_tools.h"
#include "sansmesh/io/section_file.h"
#include "sansmesh/mesh_function.h"
#include "sansmesh/reconstruct.h"
#include "sansmesh/surface_function.h"
#include "support/clouds.h"
#include "support/section_bytes.h"

namespace sansmesh {
namespace {

using namespace test;
using Json = nlohmann::json;

SurfaceFunction fitted(const PointSet& cloud, const FitOptions& options = {}) {
  Progress progress;
  return fit_surface_function(cloud, options, progress);
}

PointSet colored(PointSet cloud) {
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.colors.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i / 7), 200});
  return cloud;
}

/// Survey coordinates: far from zero, and in a small unit.
PointSet surveyed(PointSet cloud) {
  cloud.origin = {431234.5, 5812345.25, 812};
  for (Vec3f& p : cloud.positions) p *= 0.01f;
  return cloud;
}

std::vector<Vec3> places(const SurfaceFunction& function, std::size_t n = 4000) {
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

template <class T>
bool same_bytes(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}
template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return same_bytes(std::span<const T>(a), std::span<const T>(b));
}

void expect_same_function(const SurfaceFunction& a, const SurfaceFunction& b) {
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.unit, b.unit);
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

TriangleMesh meshed(const SurfaceFunction& function, const MeshOptions& options = {}) {
  Progress progress;
  return mesh_function(function, options, progress);
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
  smooth.sharp = false, smooth.max_degree = 2, smooth.support = 1.4, smooth.max_depth = 6, smooth.error = 1e-3;
  const std::pair<PointSet, FitOptions> cases[] = {{sphere(1500), {}},
                                                   {colored(cube(6000)), {}},
                                                   {surveyed(colored(torus(2000))), {}},
                                                   {sphere(2000, 0.01), smooth}};
  for (const auto& [cloud, options] : cases) {
    const SurfaceFunction before = fitted(cloud, options);
    for (const char* name : {"f.smf", "f.smf.gz"}) {
      write_function(folder / name, before);
      const SurfaceFunction after = read_function(folder / name);
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
      // Written again it is the same file.
      write_function(folder / (std::string("again") + name), after);
      EXPECT_EQ(slurp(folder / name), slurp(folder / (std::string("again") + name)));
    }
    expect_same_mesh(meshed(before), meshed(read_function(folder / "f.smf")));
  }
}

TEST(FunctionFile, ReconstructIsFitAndMesh) {
  const Folder folder;
  const PointSet cloud = surveyed(colored(torus(2500)));
  Progress progress;
  const TriangleMesh whole = reconstruct(cloud, {}, progress);
  write_function(folder / "f.smf", fitted(cloud));
  expect_same_mesh(whole, meshed(read_function(folder / "f.smf")));
}

TEST(FunctionFile, WithoutSamples) {
  const Folder folder;
  const SurfaceFunction before = fitted(colored(sphere(1500)));
  write_function(folder / "all.smf", before);
  write_function(folder / "f.smf", before, false);
  EXPECT_LT(std::filesystem::file_size(folder / "f.smf") + 1500 * 27, std::filesystem::file_size(folder / "all.smf"));
  const SurfaceFunction after = read_function(folder / "f.smf");
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
  SurfaceFunction function = fitted(sphere(500));
  function.history = {"fit of 'scan \"2\".ply'", "Größe: 3 µm", "not UTF-8: \xff", "two\nlines\x1b[31m"};
  write_function(folder / "f.smf", function);
  const std::vector<std::string> history = read_function(folder / "f.smf").history;
  ASSERT_EQ(history.size(), 4u);
  EXPECT_EQ(history[0], function.history[0]);
  EXPECT_EQ(history[1], function.history[1]);
  EXPECT_EQ(history[2], "not UTF-8: \xef\xbf\xbd");
  EXPECT_EQ(history[3], "two lines [31m");
}

TEST(FunctionFile, SameBytesWhateverTheThreads) {
  const Folder folder;
  const PointSet cloud = colored(torus(3000));
  std::string one;
  for (const int threads : {1, 2, 8}) {
    set_thread_count(threads);
    write_function(folder / "f.smf", fitted(cloud));
    const std::string bytes = slurp(folder / "f.smf");
    if (threads == 1) one = bytes;
    EXPECT_TRUE(bytes == one) << threads << " threads";
  }
  set_thread_count(0);
}

TEST(FunctionFile, EveryValueIsFinite) {
  const Folder folder;
  write_function(folder / "f.smf", fitted(cube(3000)));
  const SurfaceFunction function = read_function(folder / "f.smf");
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
  const SurfaceFunction good = fitted(sphere(500));
  PartitionData data = good.field.data();
  std::vector<LocalFunction> functions = data.functions.copy();
  functions[3].coefficient[0] = std::nanf("");
  data.functions = std::move(functions);
  const SurfaceFunction bad{PartitionOfUnity(std::move(data)), good.origin, good.unit, good.samples, {}, {}};
  expect_file_error(folder / "f.smf", "a support makes no sense", [&] { write_function(folder / "f.smf", bad); });
  expect_file_error(folder / "absent/f.smf", "", [&] { write_function(folder / "absent/f.smf", good); });
  EXPECT_EQ(folder.entries(), 0u);
}

// ------------------------------------------------------------------------- wrong contents, right checksums

class WrongContents : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const Folder folder;
    write_function(folder / "f.smf", fitted(colored(cube(4000))));
    good_ = unpacked(slurp(folder / "f.smf"));
  }

  void expect_bad(const std::vector<RawSection>& sections, const std::string& part, const std::string& what) {
    const std::string file = folder_.put("bad.smf", packed(sections));
    SCOPED_TRACE(what);
    expect_file_error(file, part, [&] { read_function(file); });
  }
  static RawSection& section(std::vector<RawSection>& sections, const std::string& name) {
    for (RawSection& s : sections)
      if (s.name == name) return s;
    throw std::runtime_error("no section " + name);
  }
  /// One element of a section changed by `edit(element)`.
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
  const SurfaceFunction function = read_function(folder_.put("good.smf", packed(good_)));
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
  // Twice the same block.
  std::vector<RawSection> sections = good_;
  std::string& bytes = section(sections, "SUPPORT").bytes;
  bytes.replace(sizeof(Support), sizeof(Support), bytes.substr(0, sizeof(Support)));
  expect_bad(sections, "a support makes no sense", "twice");
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

TEST_F(WrongContents, Samples) {
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity(), 1e20f}) {
    expect_bad_element<Vec3f>(
        "POSITION", 3, [&](Vec3f& p) { p.x = bad; }, "position");
    expect_bad_element<Vec3f>(
        "NORMAL", 3, [&](Vec3f& n) { n.z = bad; }, "normal");
  }
}

TEST_F(WrongContents, SectionsThatDoNotFit) {
  const std::map<std::string, bool> needed{{"META", true},    {"FUNCTION", true},  {"SUPPORT", true},
                                           {"LEVCODE", true}, {"LEVGAP", true},    {"LEVCHILD", true},
                                           {"NORMAL", true},  {"POSITION", false}, {"COLOR", false}};
  for (const auto& [name, must] : needed) {
    for (const int shorter : {0, 1}) {  // one element less, or none at all
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
      EXPECT_NO_THROW(read_function(folder_.put("fine.smf", packed(sections)))) << name;
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
      // Some are right by chance: there nothing but a function may come out.
      try {
        const SurfaceFunction function = read_function(file);
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
  // Very many fields: no more than a pass over them.
  std::string many = "{";
  for (int i = 0; i < 200000; ++i) many.append("\"").append(std::to_string(i)).append("\":0,");
  std::vector<RawSection> sections = good_;
  section(sections, "META").bytes = many + good.substr(1);
  EXPECT_NO_THROW(read_function(folder_.put("many.smf", packed(sections))));
  section(sections, "META").bytes = R"({"kind":"radial\nbasis"})";
  expect_bad(sections, "another kind of function", "kind");
}

}  // namespace
}  // namespace sansmesh
