// Scenes as JSON: selections, values and error messages.
#include "sansmesh/dynamics/scene_script.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/dynamics/recommended_options.h"
#include "sansmesh/dynamics/soft_body.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/error.h"
#include "support/tet_shapes.h"

namespace sansmesh::inline v1 {
namespace {

/// A box of 3 × 2 × 2 vertices, from 0 to (2, 1, 1), whose file counts from 10.
struct Stage {
  TetMesh mesh = test::box_of_tets({0, 0, 0}, {2, 1, 1}, 2, 1, 1);

  SceneScript parse(const std::string& text, bool z_up = false) const {
    SceneVertices v;
    v.mesh = &mesh;
    v.find = [&](std::uint64_t n) {
      if (n < 10 || n >= 10 + mesh.vertices.size()) throw DataError("there is no vertex " + std::to_string(n));
      return static_cast<std::uint32_t>(n - 10);
    };
    v.list = [](const std::string& file) {
      if (file != "ends.bou") throw FileError(file, "no such file");
      return std::vector<std::uint64_t>{10, 12};
    };
    return parse_scene_script(text, v, z_up);
  }
  std::string wrong(const std::string& text) const {
    try {
      parse(text);
    } catch (const ArgumentError& e) {
      return e.what();
    }
    return "no error";
  }
};

using Numbers = std::vector<std::uint32_t>;

TEST(SceneScript, SelectsVerticesInEveryWay) {
  const Stage s;
  const auto fixed = [&](const std::string& selection) {
    return s.parse("{\"fixed\": " + selection + "}").scene.fixed;
  };
  EXPECT_EQ(fixed("[12, 10, 12]"), (Numbers{0, 2}));
  EXPECT_EQ(fixed("\"ends.bou\""), (Numbers{0, 2}));
  EXPECT_EQ(fixed("{\"file\": \"ends.bou\"}"), (Numbers{0, 2}));
  EXPECT_EQ(fixed("{\"side\": \"-x\"}"), (Numbers{0, 3, 6, 9}));
  EXPECT_EQ(fixed("{\"side\": \"+x\", \"share\": 0.5}"), (Numbers{1, 2, 4, 5, 7, 8, 10, 11}));
  EXPECT_EQ(fixed("{\"box\": {\"lower\": [1, 0, 0], \"upper\": [2, 0.5, 0.5]}}"), (Numbers{1, 2}));
  EXPECT_EQ(fixed("{\"half_space\": {\"point\": [0.5, 0, 0], \"normal\": [2, 0, 0]}}"), (Numbers{0, 3, 6, 9}));
  EXPECT_EQ(fixed("{\"ball\": {\"center\": [2, 1, 1], \"radius\": 0.1}}"), (Numbers{11}));
  // Conditions in one entry intersect, entries of a list unite.
  EXPECT_EQ(fixed("{\"side\": \"-x\", \"ball\": {\"center\": [0, 0, 0], \"radius\": 1.1}}"), (Numbers{0, 3, 6}));
  EXPECT_EQ(fixed("[{\"vertices\": [11]}, \"ends.bou\", 21]"), (Numbers{0, 1, 2, 11}));
}

TEST(SceneScript, ForcesHandlesAndObstacles) {
  const Stage s;
  const SceneScript script = s.parse(R"({
    // Comments are no error.
    "model": "corotational", "integrator": "verlet", "step": 0.001, "duration": 3, "fps": 50, "unit": "cm", "up": "z",
    "young": 2e5, "poisson": 0.4, "damping": 0.1, "density": 900, "gravity": 1.62, "friction": 0.5,
    "forces": [{"on": {"side": "+x"}, "total": [0, 8, 0], "until": 1}, {"on": [10], "force": [1, 2, 3], "from": 0.5}],
    "handles": [{"on": {"side": "-x"}, "move": [0, 0, 4], "turn": {"axis": [0, 2, 0], "degrees": 90}, "until": 2},
                {"on": [21], "keys": [{"time": 1, "move": [1, 0, 0]}, {"time": 2}], "stiffness": 50}],
    "floor": {"height": -2}, "spheres": {"center": [1, 1, 1], "radius": 3, "friction": 0}})");
  EXPECT_EQ(script.model, SoftBodyModel::corotational);
  EXPECT_EQ(script.integrator, "verlet");
  EXPECT_EQ(script.unit, 0.01);
  ASSERT_EQ(script.scene.forces.size(), 2u);
  EXPECT_EQ(script.scene.forces[0].force, (Vec3{0, 2, 0}));
  EXPECT_EQ(script.scene.forces[0].until, 1);
  EXPECT_EQ(script.scene.forces[1].from, 0.5);
  ASSERT_EQ(script.scene.handles.size(), 2u);
  const PulledHandle& h = script.scene.handles[0];
  ASSERT_EQ(h.keys.size(), 2u);
  EXPECT_EQ(h.keys[1].time, 2);
  EXPECT_EQ(h.keys[1].displacement, (Vec3{0, 0, 4}));
  EXPECT_NEAR(h.keys[1].turn.y, std::numbers::pi / 2, 1e-15);
  // Starts from rest.
  ASSERT_EQ(script.scene.handles[1].keys.size(), 3u);
  EXPECT_EQ(script.scene.handles[1].keys[0].displacement, (Vec3{}));
  EXPECT_EQ(script.scene.handles[1].stiffness, 50);
  ASSERT_EQ(script.scene.floors.size(), 1u);
  EXPECT_EQ(script.scene.floors[0].point, (Vec3{0, 0, -2}));
  EXPECT_EQ(script.scene.floors[0].friction, 0.5);
  EXPECT_EQ(script.scene.spheres.at(0).friction, 0);

  const SoftBodyOptions o = recommended_options(script, s.mesh);
  EXPECT_EQ(o.gravity, (Vec3{0, 0, -1.62}));
  EXPECT_EQ(o.young, 2e5);
  EXPECT_EQ(o.density, 900);
  EXPECT_EQ(o.step, 0.001);
  const DynamicsScene metres = scaled(script.scene, 0.01);
  EXPECT_EQ(metres.floors[0].point.z, -0.02);
  EXPECT_EQ(metres.spheres[0].radius, 0.03);
  EXPECT_EQ(metres.handles[0].keys[1].displacement.z, 0.04);
  EXPECT_TRUE(s.parse("{\"floor\": false}").no_floor);
  EXPECT_TRUE(s.parse("{\"floor\": true}").floor_below);
}

TEST(SceneScript, WrongOnesAreToldByTheirPlace) {
  const Stage s;
  const std::pair<const char*, const char*> cases[] = {
      {"{", "is not JSON"},
      {"[1]", "must be an object"},
      {"{\"fixd\": 1}", "unknown key 'fixd'; known: model"},
      {"{\"step\": 1, \"step\": 2}", "'step' is given twice"},
      {"{\"step\": 0}", "'step' must be above 0"},
      {"{\"young\": \"soft\"}", "'young' must be a number"},
      {"{\"model\": \"jelly\"}", "'model' must be springs or corotational"},
      {"{\"integrator\": \"leapfrog\"}",
       "'integrator' must be one of implicit-euler, explicit-euler, verlet, velocity-verlet"},
      {"{\"unit\": \"parsec\"}", "'unit' must be mm"},
      {"{\"fixed\": [3]}", "fixed: there is no vertex 3"},
      {"{\"fixed\": [-3]}", "fixed: numbers of vertices must be whole and not negative"},
      {"{\"fixed\": {\"side\": \"left\"}}", "fixed: 'side' must be -x"},
      {"{\"fixed\": {}}", "fixed: selects nothing"},
      {"{\"fixed\": [{\"ball\": {\"center\": [9, 9, 9], \"radius\": 1}}]}", "fixed 1: no vertex is there"},
      {"{\"forces\": [{\"on\": [10]}]}", "forces 1: give either 'force'"},
      {"{\"forces\": [{\"on\": [10], \"force\": [1, 2]}]}", "forces 1: 'force' must be three numbers"},
      {"{\"forces\": {\"on\": [99], \"force\": [1, 2, 0]}}", "forces.on: there is no vertex 99"},
      {"{\"handles\": {\"on\": [10]}}", "handles: 'keys', 'move' or 'turn' is missing"},
      {"{\"handles\": {\"on\": [10], \"keys\": [{\"time\": 2}, {\"time\": 1}]}}",
       "handles.keys 2: times must increase"},
      {"{\"handles\": {\"on\": [10], \"turn\": {\"axis\": [0, 0, 0], \"degrees\": 3}}}", "'axis' has no direction"},
      {"{\"fixed\": []}", "fixed: the list is empty"},
      {"{\"floor\": []}", "floor: the list is empty"},
      {"{\"unit\": 1e300}", "'unit' must lie in"},
      {"{\"gravity\": 1e300}", "'gravity' must be at most"},
      {"{\"iterations\": 0}", "'iterations' must be at least 1"},
      {"{\"tolerance\": 1}", "'tolerance' must lie in 1e-14..0.1"},
      {"{\"poisson\": 0.6}", "'poisson' must lie in 0..0.49"},
      {"{\"halvings\": 99}", "'halvings' must lie in 0..20"},
      {"{\"fixed\": [10, 11], \"handles\": [{\"on\": [12], \"move\": [1, 0, 0]}, {\"on\": [11], \"move\": [1, 0, 0]}]}",
       "handles 2.on: the vertex at (1, 0, 0) is fixed or pulled already"},
      {"{\"floor\": {}}", "floor: give either 'point' or 'height'"},
      {"{\"spheres\": [{\"center\": [0, 0, 0], \"radius\": -1}]}", "spheres 1: 'radius' must be above 0"},
  };
  for (const auto& [text, part] : cases)
    EXPECT_NE(s.wrong(text).find(part), std::string::npos) << text << ": " << s.wrong(text);
  EXPECT_THROW(s.parse("{\"fixed\": \"none.bou\"}"), FileError);
}

TEST(SceneScript, WhatIsNotSaidSuitsTheBody) {
  // The same body at a hundred times the size sags as much: stiffness follows from weight and size.
  const auto sag = [](double size, const char* text) {
    Stage s;
    s.mesh = test::box_of_tets({0, 0, 0}, Vec3{2, 1, 1} * size, 4, 2, 2);
    SceneScript script = s.parse(text);
    const SoftBodyOptions o = recommended_options(script, s.mesh);
    SoftBody body(s.mesh, o, script.scene);
    body.advance(2 * std::sqrt(size));
    double most = 0;
    const std::vector<Vec3> x = body.positions();
    for (std::size_t v = 0; v < x.size(); ++v) most = std::max(most, norm(x[v] - s.mesh.vertices[v]));
    return most / size;
  };
  for (const char* text :
       {"{\"fixed\": {\"side\": \"-x\"}}", "{\"fixed\": {\"side\": \"-x\"}, \"model\": \"corotational\"}"}) {
    const double small = sag(0.1, text), large = sag(10, text);
    EXPECT_GT(small, 0.02) << text;
    EXPECT_LT(small, 0.8) << text;
    EXPECT_NEAR(large, small, 0.4 * small) << text;
  }
}

TEST(SceneScript, FloorsStandAcrossUpWhoeverSaysIt) {
  const Stage s;
  const auto floor = [&](const std::string& text, bool z_up) { return s.parse(text, z_up).scene.floors.at(0); };
  EXPECT_EQ(floor("{\"floor\": {\"height\": -2}}", false).point, (Vec3{0, -2, 0}));
  EXPECT_EQ(floor("{\"up\": \"z\", \"floor\": {\"height\": -2}}", false).point, (Vec3{0, 0, -2}));
  EXPECT_EQ(floor("{\"floor\": {\"height\": -2}}", true).point, (Vec3{0, 0, -2}));
  EXPECT_EQ(floor("{\"up\": \"y\", \"floor\": {\"point\": [1, 2, 3]}}", true).normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(s.parse("{\"up\": \"y\"}", true).z_up, true);
}

TEST(SceneScript, UnitsThatNobodySaysFollowTheSize) {
  Stage s;
  const auto unit = [&](double size, const char* text) {
    s.mesh = test::box_of_tets({0, 0, 0}, Vec3{2, 1, 1} * size, 2, 1, 1);
    return recommended_unit(s.parse(text), s.mesh);
  };
  EXPECT_EQ(unit(0.01, "{}"), 1);
  EXPECT_EQ(unit(5, "{}"), 1);
  EXPECT_EQ(unit(50, "{}"), 0.01);
  EXPECT_EQ(unit(2000, "{}"), 0.001);
  EXPECT_EQ(unit(50, "{\"unit\": \"m\"}"), 1);
  EXPECT_EQ(unit(50, "{\"young\": 2e11}"), 1) << "who knows its material means metres";
}

TEST(SceneScript, AutomaticStepsOfExplicitMethodsGainNoEnergy) {
  // A body that falls freely or is suspended never gains energy: with or without damping, for any weight, and with
  // handles on stiff springs.
  struct Case {
    const char *integrator, *rest;
    int cells;
  };
  const Case cases[] = {
      {"explicit-euler", "", 1},
      {"explicit-euler", "", 3},
      {"explicit-euler", "\"model\": \"corotational\",", 3},
      {"verlet", "\"model\": \"corotational\",", 3},
      {"velocity-verlet", "\"young\": 1e5, \"mass\": 1,", 2},
      {"velocity-verlet", "\"young\": 1e5, \"mass\": 1, \"stiffness_damping\": 0,", 2},
      {"verlet", "\"damping\": 0,", 2},
      {"velocity-verlet", "\"handles\": {\"on\": {\"side\": \"+x\"}, \"move\": [0, 0, 0], \"stiffness\": 1e7},", 1}};
  for (const Case& c : cases) {
    Stage s;
    s.mesh = test::box_of_tets({0, 0, 0}, {2, 1, 1}, 2 * static_cast<std::size_t>(c.cells),
                               static_cast<std::size_t>(c.cells), static_cast<std::size_t>(c.cells));
    const std::string what =
        std::string("{") + c.rest + "\"fixed\": {\"side\": \"-x\"}, \"integrator\": \"" + c.integrator + "\"}";
    const SceneScript script = s.parse(what);
    const SoftBodyOptions o = recommended_options(script, s.mesh);
    SoftBody body(s.mesh, o, script.scene);
    const double first = body.energies().total();
    // Energy scale: the weight times the body's height.
    double mass = 0;
    for (const double m : body.masses()) mass += m;
    for (int k = 0; k < 20; ++k) {
      ASSERT_NO_THROW(body.advance(0.02)) << what << ", step " << o.step;
      EXPECT_LT(body.energies().total(), first + 0.01 * mass * 9.81) << what << ", step " << o.step;
    }
  }
  // Without damping no step is stable.
  const Stage s;
  for (const char* text : {R"({"integrator": "explicit-euler", "damping": 0})",
                           R"({"integrator": "explicit-euler", "young": 1e5, "stiffness_damping": 0})"}) {
    try {
      recommended_options(s.parse(text), s.mesh);
      ADD_FAILURE() << text;
    } catch (const ArgumentError& e) {
      EXPECT_NE(std::string(e.what()).find("explicit-euler is unstable"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
