#include "sansmesh/dynamics/scene_script.h"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "sansmesh/core/json_fields-inl.h"
#include "sansmesh/dynamics/body_integrator.h"
#include "sansmesh/dynamics/length_unit.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

using detail::JsonFields;
using detail::JsonValue;

class SceneReader {
 public:
  SceneReader(const SceneVertices& vertices, bool z_up)
      : vertices_(vertices), z_up_(z_up), box_(bounds(*vertices.mesh)) {}

  SceneScript read(const JsonValue& json) {
    const JsonFields f(json, "",
                       {"model",
                        "integrator",
                        "step",
                        "duration",
                        "fps",
                        "unit",
                        "up",
                        "stiffness",
                        "damping",
                        "young",
                        "poisson",
                        "mass_damping",
                        "stiffness_damping",
                        "density",
                        "mass",
                        "tolerance",
                        "iterations",
                        "halvings",
                        "gravity",
                        "friction",
                        "fixed",
                        "forces",
                        "handles",
                        "floor",
                        "spheres"});
    SceneScript s;
    read_material(f, s);
    if (f.has("fixed")) s.scene.fixed = unique(selections(f.at("fixed"), "fixed"));
    if (f.has("forces"))
      for (const auto& [where, entry] : detail::json_entries(f.at("forces"), "forces"))
        s.scene.forces.push_back(force(*entry, where));
    if (f.has("handles")) {
      std::vector<std::uint8_t> held(vertices_.mesh->vertices.size(), 0);
      for (const std::uint32_t v : s.scene.fixed) held[v] = 1;
      for (const auto& [where, entry] : detail::json_entries(f.at("handles"), "handles")) {
        s.scene.handles.push_back(handle(*entry, where));
        for (const std::uint32_t v : s.scene.handles.back().vertices) {
          const Vec3& x = vertices_.mesh->vertices[v];
          if (std::exchange(held[v], std::uint8_t{1}))
            throw ArgumentError(fmt::format("{}.on: the vertex at ({:.6g}, {:.6g}, {:.6g}) is fixed or pulled already",
                                            where, x.x, x.y, x.z));
        }
      }
    }
    read_obstacles(f, s);
    return s;
  }

 private:
  static std::vector<std::uint32_t> unique(std::vector<std::uint32_t> v) {
    std::sort(v.begin(), v.end());
    v.erase(std::unique(v.begin(), v.end()), v.end());
    return v;
  }

  void read_material(const JsonFields& f, SceneScript& s) const {
    if (f.has("model")) {
      s.model = soft_body_model(f.text("model"));
      if (!s.model) f.fail("'model' must be springs or corotational");
    }
    if (f.has("integrator")) {
      s.integrator = f.text("integrator");
      const Registry<BodyIntegrator>& known = BodyIntegrator::registry();
      if (!known.find(*s.integrator)) f.fail("'integrator' must be one of " + known.names());
    }
    for (const auto& [key, value] : {std::pair{"step", &s.step},
                                     {"duration", &s.duration},
                                     {"fps", &s.frames_per_second},
                                     {"stiffness", &s.stiffness},
                                     {"young", &s.young},
                                     {"density", &s.density},
                                     {"mass", &s.mass}}) {
      f.get(key, *value, &JsonFields::number);
      if (*value && !(**value > 0)) f.fail(fmt::format("'{}' must be above 0", key));
    }
    for (const auto& [key, value] : {std::pair{"damping", &s.damping},
                                     {"poisson", &s.poisson},
                                     {"mass_damping", &s.mass_damping},
                                     {"stiffness_damping", &s.stiffness_damping},
                                     {"tolerance", &s.tolerance},
                                     {"friction", &s.friction}}) {
      f.get(key, *value, &JsonFields::number);
      if (*value && !(**value >= 0)) f.fail(fmt::format("'{}' must not be negative", key));
    }
    f.get("iterations", s.iterations, &JsonFields::whole);
    f.get("halvings", s.halvings, &JsonFields::whole);
    // Ranges of SoftBodyOptions, reported with the scene's keys.
    if (s.poisson && *s.poisson > 0.49) f.fail("'poisson' must lie in 0..0.49");
    if (s.tolerance && !(*s.tolerance >= 1e-14 && *s.tolerance <= 0.1)) f.fail("'tolerance' must lie in 1e-14..0.1");
    if (s.iterations && *s.iterations < 1) f.fail("'iterations' must be at least 1");
    if (s.halvings && (*s.halvings < 0 || *s.halvings > 20)) f.fail("'halvings' must lie in 0..20");
    if (f.has("unit")) s.unit = unit(f);
    if (f.has("up")) {
      const std::string up = f.text("up");
      if (up != "y" && up != "z") f.fail("'up' must be y or z");
      s.z_up = up == "z";
    }
    if (z_up_) s.z_up = true;
    if (f.has("gravity")) {
      if (f.at("gravity").is_number())
        s.downwards = f.number("gravity");
      else
        s.gravity = f.vector("gravity");
      if (!(norm(s.gravity.value_or(Vec3{s.downwards.value_or(0), 0, 0})) <= kMostGravity))
        f.fail(fmt::format("'gravity' must be at most {:g} m/s²", kMostGravity));
    }
  }

  static double unit(const JsonFields& f) {
    if (f.at("unit").is_number()) {
      const double metres = f.number("unit");
      if (!(metres >= kLeastUnit && metres <= kMostUnit))
        f.fail(fmt::format("'unit' must lie in {:g}..{:g} m", kLeastUnit, kMostUnit));
      return metres;
    }
    if (const auto metres = metres_of(f.text("unit"))) return *metres;
    f.fail("'unit' must be mm, cm, dm, m, km, inch, foot, or its length in metres");
  }

  std::uint32_t vertex(const JsonValue& v, const std::string& where) const {
    if (!v.is_number_unsigned() && !(v.is_number_integer() && v.get<std::int64_t>() >= 0))
      throw ArgumentError(where + ": numbers of vertices must be whole and not negative");
    return named(v.get<std::uint64_t>(), where);
  }
  std::uint32_t named(std::uint64_t number, const std::string& where) const {
    try {
      return vertices_.find(number);
    } catch (const DataError& error) {
      throw ArgumentError(where + ": " + error.what());
    }
  }
  std::vector<std::uint32_t> in_file(const std::string& file, const std::string& where) const {
    std::vector<std::uint32_t> all;
    for (const std::uint64_t n : vertices_.list(file))
      all.push_back(named(n, where + " (" + printable(file, 60) + ")"));
    return all;
  }

  /// A file, a list of numbers, an object, or several of them: the union of all.
  std::vector<std::uint32_t> selections(const JsonValue& json, const std::string& where) const {
    std::vector<std::uint32_t> all;
    if (json.is_array() && !json.empty() &&
        std::all_of(json.begin(), json.end(), [](const JsonValue& v) { return v.is_number(); })) {
      for (const JsonValue& v : json) all.push_back(vertex(v, where));
      return all;
    }
    for (const auto& [location, entry] : detail::json_entries(json, where)) {
      if (entry->is_number())
        all.push_back(vertex(*entry, location));
      else if (const std::vector<std::uint32_t> some = selection(*entry, location); true)
        all.insert(all.end(), some.begin(), some.end());
    }
    return all;
  }

  /// The vertices that satisfy all conditions of an object; none is an error.
  std::vector<std::uint32_t> selection(const JsonValue& json, const std::string& where) const {
    if (json.is_string()) return in_file(json.get<std::string>(), where);
    const JsonFields f(json, where, {"vertices", "file", "box", "half_space", "ball", "side", "share"});
    const std::vector<Vec3>& x = vertices_.mesh->vertices;
    std::vector<std::uint8_t> in(x.size(), 1);
    const auto keep = [&](auto&& inside) {
      for (std::size_t v = 0; v < x.size(); ++v) in[v] = in[v] && inside(x[v]);
    };
    const auto keep_listed = [&](const std::vector<std::uint32_t>& listed) {
      std::vector<std::uint8_t> there(x.size(), 0);
      for (const std::uint32_t v : listed) there[v] = 1;
      for (std::size_t v = 0; v < x.size(); ++v) in[v] = in[v] && there[v];
    };
    bool any = false;
    if (f.has("vertices")) {
      if (!f.at("vertices").is_array()) f.fail("'vertices' must be a list of numbers");
      std::vector<std::uint32_t> listed;
      for (const JsonValue& v : f.at("vertices")) listed.push_back(vertex(v, where));
      keep_listed(listed), any = true;
    }
    if (f.has("file")) keep_listed(in_file(f.text("file"), where)), any = true;
    if (f.has("box")) {
      const JsonFields b(f.at("box"), f.where("box"), {"lower", "upper"});
      const Vec3 lower = b.vector("lower"), upper = b.vector("upper");
      keep([&](const Vec3& p) {
        return p.x >= lower.x && p.y >= lower.y && p.z >= lower.z && p.x <= upper.x && p.y <= upper.y && p.z <= upper.z;
      });
      any = true;
    }
    if (f.has("half_space")) {
      const JsonFields h(f.at("half_space"), f.where("half_space"), {"point", "normal"});
      const Vec3 point = h.vector("point"), normal = h.direction("normal");
      keep([&](const Vec3& p) { return dot(p - point, normal) <= 0; });
      any = true;
    }
    if (f.has("ball")) {
      const JsonFields b(f.at("ball"), f.where("ball"), {"center", "radius"});
      const Vec3 center = b.vector("center");
      const double radius = b.number("radius");
      keep([&](const Vec3& p) { return norm(p - center) <= radius; });
      any = true;
    }
    if (f.has("share") && !f.has("side")) f.fail("'share' belongs to 'side'");
    if (f.has("side")) {
      const std::string side = f.text("side");
      const std::size_t axis =
          side.size() == 2 && side[1] >= 'x' && side[1] <= 'z' ? static_cast<std::size_t>(side[1] - 'x') : 3;
      if (axis > 2 || (side[0] != '-' && side[0] != '+')) f.fail("'side' must be -x, +x, -y, +y, -z or +z");
      const double share = f.has("share") ? f.number("share") : 0.01;
      if (!(share >= 0 && share <= 1)) f.fail("'share' must lie in 0..1");
      const double width = box_.upper[axis] - box_.lower[axis];
      keep([&](const Vec3& p) {
        return side[0] == '-' ? p[axis] <= box_.lower[axis] + share * width
                              : p[axis] >= box_.upper[axis] - share * width;
      });
      any = true;
    }
    if (!any) f.fail("selects nothing: give vertices, file, box, half_space, ball or side");
    std::vector<std::uint32_t> found;
    for (std::size_t v = 0; v < x.size(); ++v)
      if (in[v]) found.push_back(static_cast<std::uint32_t>(v));
    if (found.empty()) f.fail("no vertex is there");
    return found;
  }

  VertexForce force(const JsonValue& json, const std::string& where) const {
    const JsonFields f(json, where, {"on", "force", "total", "from", "until"});
    VertexForce force;
    force.vertices = unique(selections(f.at("on"), f.where("on")));
    if (f.has("force") == f.has("total")) f.fail("give either 'force' (on each vertex) or 'total' (on all together)");
    force.force = f.has("force") ? f.vector("force") : f.vector("total") / static_cast<double>(force.vertices.size());
    if (f.has("from")) force.from = f.number("from");
    if (f.has("until")) force.until = f.number("until");
    if (!(force.until > force.from)) f.fail("'until' must be after 'from'");
    return force;
  }

  static Vec3 turn(const JsonFields& f) {
    const JsonFields t(f.at("turn"), f.where("turn"), {"axis", "degrees"});
    return t.direction("axis") * (t.number("degrees") * std::numbers::pi / 180);
  }

  PulledHandle handle(const JsonValue& json, const std::string& where) const {
    const JsonFields f(json, where, {"on", "keys", "move", "turn", "from", "until", "center", "stiffness"});
    PulledHandle handle;
    handle.vertices = unique(selections(f.at("on"), f.where("on")));
    if (f.has("center")) handle.center = f.vector("center");
    if (f.has("stiffness")) {
      handle.stiffness = f.number("stiffness");
      if (!(*handle.stiffness > 0)) f.fail("'stiffness' must be above 0");
    }
    if (f.has("keys")) {
      if (f.has("move") || f.has("turn") || f.has("from") || f.has("until"))
        f.fail("give either 'keys', or 'move', 'turn', 'from' and 'until'");
      for (const auto& [location, entry] : detail::json_entries(f.at("keys"), f.where("keys"))) {
        const JsonFields k(*entry, location, {"time", "move", "turn"});
        HandleKey key;
        key.time = k.number("time");
        if (k.has("move")) key.displacement = k.vector("move");
        if (k.has("turn")) key.turn = turn(k);
        if (!handle.keys.empty() && !(key.time > handle.keys.back().time)) k.fail("times must increase");
        handle.keys.push_back(key);
      }
      if (handle.keys.empty()) f.fail("'keys' is empty");
      // Motion starts from rest towards the first key.
      if (handle.keys.front().time > 0) handle.keys.insert(handle.keys.begin(), HandleKey{});
      return handle;
    }
    HandleKey first, last;
    if (!f.has("move") && !f.has("turn")) f.fail("'keys', 'move' or 'turn' is missing");
    if (f.has("move")) last.displacement = f.vector("move");
    if (f.has("turn")) last.turn = turn(f);
    if (f.has("from")) first.time = f.number("from");
    last.time = first.time + 1;
    if (f.has("until")) last.time = f.number("until");
    if (!(last.time > first.time)) f.fail("'until' must be after 'from'");
    handle.keys = {first, last};
    return handle;
  }

  void read_obstacles(const JsonFields& f, SceneScript& s) const {
    const double usual = s.friction.value_or(kUsualFriction);
    const auto friction = [&](const JsonFields& o) {
      const double mu = o.has("friction") ? o.number("friction") : usual;
      if (!(mu >= 0)) o.fail("'friction' must not be negative");
      return mu;
    };
    if (f.has("floor") && f.at("floor").is_boolean()) {
      s.floor_below = f.at("floor").get<bool>();
      s.no_floor = !s.floor_below;
    } else if (f.has("floor")) {
      for (const auto& [where, entry] : detail::json_entries(f.at("floor"), "floor")) {
        const JsonFields o(*entry, where, {"point", "normal", "height", "friction"});
        FloorObstacle floor;
        const bool z = s.z_up.value_or(false);
        floor.normal = o.has("normal") ? o.direction("normal") : z ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
        if (o.has("point") == o.has("height")) o.fail("give either 'point' or 'height'");
        floor.point = o.has("point") ? o.vector("point") : floor.normal * o.number("height");
        floor.friction = friction(o);
        s.scene.floors.push_back(floor);
      }
    }
    if (f.has("spheres"))
      for (const auto& [where, entry] : detail::json_entries(f.at("spheres"), "spheres")) {
        const JsonFields o(*entry, where, {"center", "radius", "friction"});
        SphereObstacle sphere{o.vector("center"), o.number("radius"), friction(o)};
        if (!(sphere.radius > 0)) o.fail("'radius' must be above 0");
        s.scene.spheres.push_back(sphere);
      }
  }

  const SceneVertices& vertices_;
  bool z_up_;
  Box3 box_;
};

}  // namespace

SceneScript parse_scene_script(const std::string& text, const SceneVertices& vertices, bool z_up) {
  return SceneReader(vertices, z_up).read(detail::parse_json_once(text, true));
}

std::string_view word_of(SoftBodyModel model) { return kModelWords[static_cast<std::size_t>(model)]; }

std::optional<SoftBodyModel> soft_body_model(std::string_view word) {
  for (const auto m : {SoftBodyModel::springs, SoftBodyModel::corotational})
    if (word == word_of(m)) return m;
  return std::nullopt;
}

DynamicsScene scaled(DynamicsScene scene, double factor) {
  for (PulledHandle& h : scene.handles) {
    if (h.center) *h.center *= factor;
    for (HandleKey& k : h.keys) k.displacement *= factor;
  }
  for (FloorObstacle& f : scene.floors) f.point *= factor;
  for (SphereObstacle& s : scene.spheres) s.center *= factor, s.radius *= factor;
  return scene;
}

}  // namespace sansmesh::inline v1
