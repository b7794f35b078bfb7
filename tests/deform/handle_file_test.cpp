#include "sansmesh/deform/handles/handle_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "sansmesh/deform/handles/handle_shapes.h"
#include "sansmesh/error.h"
#include "sansmesh/progress.h"
#include "support/mesh_checks.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

TEST(HandleFile, JsonHoldsAllThatAHandleCanBe) {
  const std::vector<Handle> h = parse_handles(R"({"handles": [
    {"p": [1, 2, 3], "q": [4, 5, 6.5]},
    {"p": [0, 0, 0]},
    {"p": [0, 0, 0], "p_end": [1, 0, 0], "q": [0, 0, 1], "q_end": [0, 1, 1], "weight": 2.5, "group": "arm"},
    {"p": [7, 0, 0], "p_end": [8, 0, 0]},
    {"p": [0, 0, 0], "q": [0, 0, 0], "normal": {"before": [0, 0, 2], "after": [0, 3, 0]}, "reach": 0.25},
    {"p": [0, 0, 0], "frame": {"before": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "after": [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]}}
  ]})",
                                              "h.json");
  ASSERT_EQ(h.size(), 6u);
  EXPECT_EQ(h[0].p, (Vec3{1, 2, 3}));
  EXPECT_EQ(h[0].q, (Vec3{4, 5, 6.5}));
  EXPECT_EQ(h[0].weight, 1);
  EXPECT_EQ(h[1].q, h[1].p);
  EXPECT_EQ(*h[2].p_end, (Vec3{1, 0, 0}));
  EXPECT_EQ(*h[2].q_end, (Vec3{0, 1, 1}));
  EXPECT_EQ(h[2].weight, 2.5);
  EXPECT_EQ(h[2].group, "arm");
  EXPECT_EQ(*h[3].q_end, (Vec3{8, 0, 0}));
  ASSERT_EQ(h[4].directions.size(), 1u);
  EXPECT_EQ(h[4].directions[0].before, (Vec3{0, 0, 1}));
  EXPECT_EQ(h[4].directions[0].after, (Vec3{0, 1, 0}));
  EXPECT_EQ(*h[4].reach, 0.25);
  ASSERT_EQ(h[5].directions.size(), 3u);
  EXPECT_EQ(h[5].directions[1].after, (Vec3{-1, 0, 0}));
  // Written handles are read back unchanged.
  EXPECT_EQ(handles_json(parse_handles(handles_json(h), "again")), handles_json(h));
}

TEST(HandleFile, TablesHoldPointsAndWeights) {
  for (const std::string text : {"px,py,pz,qx,qy,qz,weight\n1,2,3,4,5,6,7\n# no row\n\n-1,0,0,+1e-1,0,0,1\n",
                                 "1 2 3 4 5 6 7\r\n-1 0 0 0.1 0 0\r\n", "1;2;3;4;5;6;7\n-1;0;0;.1;0;0",
                                 "\xef\xbb\xbf# from a tracker\npx py pz qx qy qz w\n1 2 3 4 5 6 7\n-1 0 0 .1 0 0"}) {
    const std::vector<Handle> h = parse_handles(text, "h.csv");
    ASSERT_EQ(h.size(), 2u) << text;
    EXPECT_EQ(h[0].p, (Vec3{1, 2, 3}));
    EXPECT_EQ(h[0].q, (Vec3{4, 5, 6}));
    EXPECT_EQ(h[0].weight, 7);
    EXPECT_EQ(h[1].q, (Vec3{0.1, 0, 0}));
  }
}

TEST(HandleFile, SaysWhichHandleAndWhichKeyIsWrong) {
  struct Bad {
    std::string text;
    std::vector<std::string> parts;
  };
  const std::vector<Bad> all = {
      {"", {"is empty"}},
      {"{", {"is not JSON"}},
      {"[]", {"must be an object"}},
      {R"({"handles": []})", {"no handles"}},
      {R"({"handels": []})", {"'handels'", "known: handles"}},
      {R"({"handles": [{"p": [0,0,0], "Q": [1,1,1]}]})", {"handle 1", "'Q'", "weight"}},
      {R"({"handles": [{"p": [0,0,0]}, {"q": [1,1,1]}]})", {"handle 2", "'p'"}},
      {R"({"handles": [{"p": [0,0]}]})", {"handle 1", "'p' must be three numbers"}},
      {R"({"handles": [{"p": [0,0,"a"]}]})", {"'p' must be three numbers"}},
      {R"({"handles": [{"p": [0,0,0], "q": [0,0,0], "p_end": [1,0,0]}]})", {"'q_end'"}},
      {R"({"handles": [{"p": [0,0,0], "p_end": [1,0,0], "q_end": [1,0,0]}]})", {"'q'"}},
      {R"({"handles": [{"p": [0,0,0], "q_end": [1,0,0]}]})", {"'p_end'"}},
      {R"({"handles": [{"p": [0,0,0], "p_end": [0,0,0]}]})", {"no length"}},
      {R"({"handles": [{"p": [0,0,0], "weight": 0}]})", {"'weight'"}},
      {R"({"handles": [{"p": [0,0,0], "reach": 1}]})", {"'reach'"}},
      {R"({"handles": [{"p": [0,0,0], "normal": [0,0,1]}]})", {"handle 1.normal: must be an object"}},
      {R"({"handles": [{"p": [0,0,0], "normal": {"before": [0,0,1]}}]})", {"'after'"}},
      {R"({"handles": [{"p": [0,0,0], "normal": {"before": [0,0,0], "after": [1,0,0]}}]})",
       {"'before' has no direction"}},
      {R"({"handles": [{"p": [0,0,0], "frame": {"before": [[1,0,0],[0,1,0],[0,0,1]],
         "after": [[1,0,0],[1,1,0],[0,0,1]]}}]})",
       {"right angles"}},
      {R"({"handles": [{"p": [0,0,0], "frame": {"before": [[1,0,0],[0,1,0],[0,0,1]],
         "after": [[1,0,0],[0,1,0],[0,0,-1]]}}]})",
       {"right-handed"}},
      {R"({"handles": [{"p": [1e999,0,0]}]})", {"too large"}},
      {R"({"handles": [{"p": [0,0,0], "p": [1,0,0]}]})", {"'p' is given twice"}},
      {"1,2,3,4,5,six\n", {"line 1"}},
      {"x,y\nu,v\n", {"line 2"}},
      {"1,2,3,4,5,6\n1,2,3\n", {"line 2", "3 numbers"}},
      {"1,2,3,4,5,6\n1,2,3,4,5,x\n", {"line 2"}},
      {"px,py,pz,qx,qy,qz\n", {"no handles"}},
      {"1,2,3,4,5,6,-1\n", {"line 1", "weight"}},
  };
  for (const Bad& bad : all) {
    try {
      parse_handles(bad.text, "pull.json");
      ADD_FAILURE() << bad.text;
    } catch (const FileError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("pull.json"), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      for (const std::string& part : bad.parts) EXPECT_NE(message.find(part), std::string::npos) << message;
    }
  }
  EXPECT_THROW(read_handles("/none/such.json"), FileError);
}

TEST(HandleFile, AMarkBeforeJsonIsNoMatter) {
  EXPECT_EQ(parse_handles("\xef\xbb\xbf{\"handles\": [{\"p\": [1, 2, 3]}]}", "h.json").size(), 1u);
}

TEST(HandleFile, PairsOfMeshesGiveHandles) {
  PointSet before, after;
  before.origin = {100, 0, 0}, after.origin = {0, 50, 0};
  for (int i = 0; i < 20; ++i) {
    const float t = static_cast<float>(i);
    before.positions.push_back({t, 0, 0});
    after.positions.push_back({t, t, 0});
  }
  before.positions[7] = {NAN, 0, 0};
  const std::vector<std::uint32_t> some{3, 12};
  const std::vector<Handle> h = handles_of_pair(before, after, some);
  ASSERT_EQ(h.size(), 2u);
  EXPECT_EQ(h[1].p, (Vec3{112, 0, 0}));
  EXPECT_EQ(h[1].q, (Vec3{12, 62, 0}));
  EXPECT_THROW(handles_of_pair(before, after, std::vector<std::uint32_t>{20}), ArgumentError);
  EXPECT_THROW(handles_of_pair(before, after, std::vector<std::uint32_t>{7}), ArgumentError);
  PointSet fewer = after;
  fewer.positions.pop_back();
  EXPECT_THROW(handles_of_pair(before, fewer, some), ArgumentError);
  // Both ends, then the middle of the rest.
  EXPECT_EQ(spread_vertices_of(before, 3), (std::vector<std::uint32_t>{0, 19, 9}));
  const std::vector<std::uint32_t> all = spread_vertices_of(before, 100);
  EXPECT_EQ(all.size(), 19u);
}

TEST(HandleShapes, AreClosedAndColoured) {
  std::vector<Handle> h(2);
  h[0].q = {0, 0, 2};
  h[1].p = {5, 0, 0}, h[1].p_end = {6, 0, 0}, h[1].q = {5, 1, 0}, h[1].q_end = {5, 2, 0};
  h[1].directions = {{{0, 0, 1}, {0, 1, 0}}};
  HandleShapeOptions options;
  options.radius = 0.1;
  const TriangleMesh mesh = handle_shapes(h, options);
  EXPECT_TRUE(topology_of(mesh).closed_manifold());
  EXPECT_EQ(mesh.colors.size(), mesh.vertices.size());
  EXPECT_EQ(mesh.normals.size(), mesh.vertices.size());
  const Box3f box = bounds(mesh);
  EXPECT_NEAR(box.lower.z, -0.1, 1e-5);
  EXPECT_NEAR(box.upper.z, 2.1, 1e-5);
  EXPECT_NEAR(box.upper.x, 6.1, 1e-5);
  EXPECT_THROW(handle_shapes(h, {}), ArgumentError);
}

TEST(FoldShapes, LieAroundWhatIsFolded) {
  // x ↦ (x² − x) is folded for x < 1/2.
  class Bent final : public SpaceMap {
   public:
    void map(std::span<const Vec3> x, const MappedPoints& wanted) const override {
      for (std::size_t i = 0; i < x.size(); ++i) {
        if (!wanted.positions.empty()) wanted.positions[i] = {x[i].x * x[i].x - x[i].x, x[i].y, x[i].z};
        if (!wanted.jacobians.empty()) wanted.jacobians[i] = {Vec3{2 * x[i].x - 1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
      }
    }
  };
  Progress progress;
  const Box3 box{{0, 0, 0}, {1, 1, 1}};
  const TriangleMesh mesh = fold_shapes(find_folds(Bent(), box, {11, 6, 6}, progress));
  const Box3f found = bounds(mesh);
  EXPECT_NEAR(found.upper.x, 0.55, 1e-6);  // points up to 0.5, and half a step
  EXPECT_NEAR(found.lower.x, -0.05, 1e-6);
  // The outside of the block of cells: normals agree with the orientation of the triangles.
  double volume = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
    volume += dot(a, cross(b, c)) / 6;
    EXPECT_GT(dot(cross(b - a, c - a), Vec3(mesh.normals[t[0]])), 0);
  }
  EXPECT_NEAR(volume, 0.6 * 1.2 * 1.2, 1e-6);
  EXPECT_TRUE(fold_shapes(FoldReport{}).vertices.empty());
}

TEST(HandleFile, DirectionsReadBackAsTheyWereWritten) {
  std::string text = R"({"handles": [)";
  for (int i = 1; i <= 40; ++i)
    text += fmt::format(R"({}{{"p": [{}, 0, 0], "normal": {{"before": [{}, 2, 1], "after": [0.3, {}, 1]}}}})",
                        i > 1 ? ", " : "", i, i, i);
  const std::string written = handles_json(parse_handles(text + "]}", "a.json"));
  EXPECT_EQ(handles_json(parse_handles(written, "a.json")), written);
}

}  // namespace
}  // namespace sansmesh::inline v1
