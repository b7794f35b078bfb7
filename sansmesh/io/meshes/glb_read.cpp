// glTF 2.0, binary (.glb) or text (.gltf): the meshes of a scene, moved by its nodes, as one mesh. Equal corners become
// one vertex, because files repeat vertices where normals, textures or materials change.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/io/color_bytes.h"
#include "sansmesh/io/meshes/face_sink.h"
#include "sansmesh/io/meshes/gltf_document-inl.h"
#include "sansmesh/io/points/assemble_points.h"
#include "sansmesh/io/points/columns.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/reference_text.h"
#include "sansmesh/local_frame.h"

namespace sansmesh::inline v1::io {
namespace {

using nlohmann::json;

enum GltfMode : std::size_t { kGltfPoints = 0, kGltfTriangles = 4, kGltfStrip = 5, kGltfFan = 6 };
/// Vertices of meshes that several nodes use: at most this, or so many times the size of the file in bytes.
constexpr std::size_t kMostRepeated = 1000000, kMostRepeatedOfSize = 16;
/// Cosine of 2.5 degrees: normals of one vertex in different triangles agree.
constexpr float kSameNormal = 0.999f;

AffineMap map_of(const GltfDocument& document, const json& node) {
  if (const auto m = document.numbers(node, "matrix", 16)) {
    const auto column = [&](std::size_t k) { return Vec3{(*m)[4 * k], (*m)[4 * k + 1], (*m)[4 * k + 2]}; };
    return {column(0), column(1), column(2), column(3)};
  }
  AffineMap map;
  if (const auto q = document.numbers(node, "rotation", 4)) {
    const double x = (*q)[0], y = (*q)[1], z = (*q)[2], w = (*q)[3], length = x * x + y * y + z * z + w * w;
    const double s = length > 0 ? 2 / length : 0;
    map.x = {1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)};
    map.y = {s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)};
    map.z = {s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)};
  }
  if (const auto s = document.numbers(node, "scale", 3))
    map.x = map.x * (*s)[0], map.y = map.y * (*s)[1], map.z = map.z * (*s)[2];
  if (const auto t = document.numbers(node, "translation", 3)) map.shift = {(*t)[0], (*t)[1], (*t)[2]};
  return map;
}

/// A mesh at its place.
struct PlacedMesh {
  std::size_t mesh;
  AffineMap map;
};

/// Meshes of the scene that a viewer would show: the default one, else the first, else all nodes, else all meshes.
class GltfScene {
 public:
  GltfScene(const Input& in, const GltfDocument& document) : in_(in), document_(document) {
    const std::size_t nodes = document.count("nodes");
    seen_.assign(nodes, 0);
    const auto scene = document.whole(document.root(), "scene");
    if (scene || document.count("scenes") > 0)
      visit(children(document.object("scenes", scene.value_or(0), "the document"), "nodes"));
    else if (nodes > 0)
      visit(roots());
    else
      for (std::size_t m = 0; m < document.count("meshes"); ++m) placed.push_back({m, {}});
  }

  std::vector<PlacedMesh> placed;

 private:
  std::vector<std::size_t> children(const json& of, const char* key) const {
    std::vector<std::size_t> found;
    if (const json* const list = document_.member(of, key, JsonKind::list))
      for (const json& index : *list) {
        if (!index.is_number_unsigned())
          in_.fail(fmt::format("malformed glTF: '{}' has an entry that is no index", key));
        found.push_back(index.get<std::size_t>());
      }
    return found;
  }

  std::vector<std::size_t> roots() const {
    const std::size_t nodes = document_.count("nodes");
    std::vector<char> child(nodes, 0);
    for (std::size_t n = 0; n < nodes; ++n)
      for (const std::size_t c : children(document_.object("nodes", n, "the document"), "children"))
        if (c < nodes) child[c] = 1;
    std::vector<std::size_t> found;
    for (std::size_t n = 0; n < nodes; ++n)
      if (!child[n]) found.push_back(n);
    return found;
  }

  void visit(const std::vector<std::size_t>& first) {
    struct Next {
      std::size_t node;
      AffineMap map;
    };
    std::vector<Next> stack;
    const auto push = [&](const std::vector<std::size_t>& nodes, const AffineMap& map) {
      for (std::size_t k = nodes.size(); k-- > 0;) stack.push_back({nodes[k], map});
    };
    push(first, {});
    while (!stack.empty()) {
      const Next next = stack.back();
      stack.pop_back();
      const json& node = document_.object("nodes", next.node, "a node or scene");
      if (seen_[next.node]++)
        in_.fail(fmt::format("malformed glTF: node {} is in the scene twice", grouped(next.node)));
      const AffineMap map = next.map.after(map_of(document_, node));
      if (const auto mesh = document_.whole(node, "mesh")) placed.push_back({*mesh, map});
      if (document_.has_extension(node, "EXT_mesh_gpu_instancing")) in_.unread("instances (EXT_mesh_gpu_instancing)");
      skins |= node.contains("skin");
      push(children(node, "children"), map);
    }
  }

  const Input& in_;
  const GltfDocument& document_;
  std::vector<char> seen_;

 public:
  bool skins = false;
};

class GlbReader {
 public:
  explicit GlbReader(const Input& in) : in_(in), document_(in), faces_(in, points_.triangles) {}

  PointSet read() {
    const GltfScene scene(in_, document_);
    if (scene.placed.empty()) in_.fail("has no mesh in its scene");
    for (const PlacedMesh& placed : scene.placed)
      for (const json& primitive : primitives_of(placed))
        has_triangles_ |= is_triangles(document_.whole(primitive, "mode").value_or(kGltfTriangles));
    for (const PlacedMesh& placed : scene.placed) {
      starts_.push_back(static_cast<std::uint32_t>(positions_.size()));
      for (const json& primitive : primitives_of(placed)) add_primitive(primitive, placed.map);
    }
    if (positions_.empty())
      in_.fail(lines_left_ ? "has lines, but no triangles or points" : "has meshes without vertices");
    faces_.done();
    if (lines_left_) in_.unread("lines");
    if (points_left_) in_.unread("points beside the triangles");
    if (textures_) in_.unread("texture coordinates");
    if (targets_) in_.unread("shapes of morph targets");
    if (scene.skins) in_.unread("motion by skins");
    if (has_normals_) points_.normals = std::move(normals_);
    if (has_colors_) points_.colors = std::move(colors_);
    points_.attributes = join_tables(in_, std::move(tables_), "meshes");
    if (!points_.triangles.empty() && points_.attributes.empty()) join_corners();
    store_positions(in_, points_, positions_.size(), [&](std::size_t i) { return positions_[i]; });
    finish(in_, points_);
    points_.reference = system_of_extras();
    return std::move(points_);
  }

 private:
  /// Extras may be of any kind, and other programs write other ones.
  SharedSystem system_of_extras() const {
    const json* at = &document_.root();
    for (const char* const key : {"asset", "extras", kSystemExtra}) {
      if (!at->is_object()) return nullptr;
      const auto found = at->find(key);
      if (found == at->end()) return nullptr;
      at = &*found;
    }
    return at->is_string() ? system_of_line(at->get_ref<const std::string&>()) : nullptr;
  }

  static bool is_triangles(std::size_t mode) { return mode >= kGltfTriangles && mode <= kGltfFan; }

  const json& primitives_of(const PlacedMesh& placed) const {
    static const json kNone = json::array();
    const json* const all =
        document_.member(document_.object("meshes", placed.mesh, "a node"), "primitives", JsonKind::list);
    if (!all) return kNone;
    for (const json& primitive : *all)
      if (!primitive.is_object()) in_.fail("malformed glTF: a primitive is not an object");
    return *all;
  }

  void add_primitive(const json& primitive, const AffineMap& map) {
    const std::size_t mode = document_.whole(primitive, "mode").value_or(kGltfTriangles);
    targets_ |= primitive.contains("targets");
    if (!is_triangles(mode) && (has_triangles_ || mode != kGltfPoints)) {
      (mode == kGltfPoints ? points_left_ : lines_left_) = true;
      return;
    }
    const json* const attributes = document_.member(primitive, "attributes", JsonKind::object);
    const auto which = attributes ? document_.whole(*attributes, "POSITION") : std::nullopt;
    if (!which) return;
    check_compression(primitive, *which);
    const GltfNumbers at = document_.accessor(*which, "a primitive");
    if (at.components != 3) in_.fail("malformed glTF: positions have not three components");
    const std::size_t first = positions_.size();
    if (at.count > std::max(kMostRepeated, kMostRepeatedOfSize * document_.size()) ||
        first + at.count > std::max(kMostRepeated, kMostRepeatedOfSize * document_.size()))
      in_.fail(fmt::format("repeats its meshes too often: its nodes have more than {} vertices", grouped(first)));
    for (std::size_t i = 0; i < at.count; ++i) positions_.push_back(map({at(i, 0), at(i, 1), at(i, 2)}));
    add_normals(*attributes, at.count, map);
    add_colors(*attributes, primitive, at.count);
    add_attributes(*attributes, at.count);
    if (!is_triangles(mode)) return;
    add_triangles(primitive, mode, first, at.count, map.determinant() < 0);
  }

  /// Without compression, data of a compressed primitive may be there, too.
  void check_compression(const json& primitive, std::size_t position) const {
    if (document_.has_extension(primitive, "KHR_draco_mesh_compression") &&
        !document_.object("accessors", position, "a primitive").contains("bufferView"))
      in_.fail(
          "is compressed with Draco (KHR_draco_mesh_compression), which is not read: export it without compression");
  }

  GltfNumbers of_vertices(std::size_t accessor, std::size_t n, const char* what) {
    const GltfNumbers values = document_.accessor(accessor, "a primitive");
    if (values.count != n)
      in_.fail(fmt::format("malformed glTF: {} {} for {} vertices", grouped(values.count), what, grouped(n)));
    return values;
  }

  void add_normals(const json& attributes, std::size_t n, const AffineMap& map) {
    normals_.resize(positions_.size());
    const auto which = document_.whole(attributes, "NORMAL");
    if (!which) return;
    const GltfNumbers values = of_vertices(*which, n, "normals");
    if (values.components != 3) in_.fail("malformed glTF: normals have not three components");
    has_normals_ = true;
    // Normals stay perpendicular to a deformed surface if the cofactors of the map move them.
    const double side = map.determinant() < 0 ? -1 : 1;
    const Vec3 a = cross(map.y, map.z) * side, b = cross(map.z, map.x) * side, c = cross(map.x, map.y) * side;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 given{values(i, 0), values(i, 1), values(i, 2)};
      normals_[normals_.size() - n + i] =
          Vec3f(map.is_translation() ? given : normalized(a * given.x + b * given.y + c * given.z));
    }
  }

  /// Colours of the vertices times that of the material.
  void add_colors(const json& attributes, const json& primitive, std::size_t n) {
    std::array<double, 3> factor{1, 1, 1};
    if (const auto material = document_.whole(primitive, "material")) {
      const json& described = document_.object("materials", *material, "a primitive");
      if (const json* const look = document_.member(described, "pbrMetallicRoughness", JsonKind::object)) {
        if (const auto base = document_.numbers(*look, "baseColorFactor", 4))
          std::copy_n(base->begin(), 3, factor.begin());
      }
    }
    const auto which = document_.whole(attributes, "COLOR_0");
    has_colors_ |= which || factor != std::array<double, 3>{1, 1, 1};
    std::array<std::uint8_t, 3> color{};
    for (std::size_t k = 0; k < 3; ++k) color[k] = srgb(factor[k]);
    colors_.resize(positions_.size(), color);
    if (!which) return;
    const GltfNumbers values = of_vertices(*which, n, "colours");
    if (values.components < 3) in_.fail("malformed glTF: colours have fewer than three components");
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < 3; ++k) colors_[colors_.size() - n + i][k] = srgb(factor[k] * values(i, k));
  }

  static std::uint8_t srgb(double linear) {
    const double s = !(linear > 0)         ? 0
                     : linear <= 0.0031308 ? 12.92 * linear
                                           : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    return to_byte(s, 255);
  }

  /// Custom attributes begin with an underscore, by convention in capitals.
  void add_attributes(const json& attributes, std::size_t n) {
    std::vector<NamedColumns> columns;
    for (const auto& [name, index] : attributes.items()) {
      textures_ |= name.starts_with("TEXCOORD");
      if (name.size() < 2 || name.front() != '_') continue;
      const GltfNumbers values = of_vertices(document_.whole(attributes, name.c_str()).value_or(0), n, "values");
      NamedColumns column{lower_case(name.substr(1)), values.first.type, {}};
      for (std::size_t k = 0; k < values.components; ++k) column.components.push_back(values.component(k));
      columns.push_back(std::move(column));
    }
    tables_.push_back(decode_attributes(in_, columns, n, false));
  }

  void add_triangles(const json& primitive, std::size_t mode, std::size_t first, std::size_t n, bool mirrored) {
    std::vector<std::int64_t> corners;
    if (const auto which = document_.whole(primitive, "indices")) {
      const GltfNumbers indices = document_.accessor(*which, "a primitive");
      const NumberType type = indices.first.type;
      if (indices.components != 1 || (type != NumberType::u8 && type != NumberType::u16 && type != NumberType::u32))
        in_.fail("malformed glTF: indices are not whole numbers");
      corners_ += indices.count;
      if (corners_ > std::max(kMostRepeated, kMostRepeatedOfSize * document_.size()))
        in_.fail(fmt::format("repeats its meshes too often: they have {} triangles or more", grouped(corners_ / 3)));
      corners.resize(indices.count);
      with_loader(type, false, [&](auto at) {
        for (std::size_t i = 0; i < corners.size(); ++i)
          corners[i] = static_cast<std::int64_t>(at(indices.first.at + i * indices.first.stride));
      });
      const auto beyond = std::find_if(corners.begin(), corners.end(),
                                       [&](std::int64_t c) { return c >= static_cast<std::int64_t>(n); });
      if (beyond != corners.end())
        in_.fail(fmt::format("a triangle refers to vertex {}, but its mesh has {}",
                             grouped(static_cast<std::uint64_t>(*beyond)), grouped(n)));
    } else {
      corners.resize(n);
      for (std::size_t i = 0; i < n; ++i) corners[i] = static_cast<std::int64_t>(i);
    }
    for (std::int64_t& c : corners) c += static_cast<std::int64_t>(first);
    const std::size_t before = points_.triangles.size();
    if (mode == kGltfStrip) {
      faces_.add_strip(corners);
    } else if (mode == kGltfFan) {
      faces_.add_polygon(corners);
    } else {
      if (corners.size() % 3 != 0) in_.warn("a mesh ends with an incomplete triangle, which was left out");
      for (std::size_t i = 0; i + 3 <= corners.size(); i += 3) faces_.add_polygon(std::span(corners).subspan(i, 3));
    }
    for (std::size_t t = before; mirrored && t < points_.triangles.size(); ++t)
      std::swap(points_.triangles[t][1], points_.triangles[t][2]);
  }

  /// Joins equal vertices of the same colour in each mesh. A vertex whose triangles have different normals has none.
  void join_corners() {
    starts_.push_back(static_cast<std::uint32_t>(positions_.size()));
    std::vector<std::uint32_t> joined(positions_.size()), order;
    std::vector<char> conflict(positions_.size(), 0);
    const auto color = [&](std::uint32_t v) { return has_colors_ ? points_.colors[v] : std::array<std::uint8_t, 3>{}; };
    const auto key = [&](std::uint32_t v) {
      const Vec3 p = positions_[v] + Vec3{};  // -0 becomes 0
      return std::tuple(p.x, p.y, p.z, color(v));
    };
    for (std::size_t m = 0; m + 1 < starts_.size(); ++m) {
      order.clear();
      for (std::uint32_t v = starts_[m]; v < starts_[m + 1]; ++v) {
        joined[v] = v;
        if (is_finite(positions_[v])) order.push_back(v);
      }
      std::sort(order.begin(), order.end(),
                [&](std::uint32_t a, std::uint32_t b) { return std::tuple(key(a), a) < std::tuple(key(b), b); });
      for (std::size_t i = 1; i < order.size(); ++i) {
        if (key(order[i]) != key(order[i - 1])) continue;
        const std::uint32_t to = joined[order[i - 1]];
        joined[order[i]] = to;
        if (has_normals_ && dot(points_.normals[to], points_.normals[order[i]]) < kSameNormal) conflict[to] = 1;
      }
    }
    take_first(joined, conflict);
  }

  /// Keeps the vertices that are joined with none before them, in their order.
  void take_first(const std::vector<std::uint32_t>& joined, const std::vector<char>& conflict) {
    std::vector<std::uint32_t> number(joined.size());
    std::uint32_t kept = 0;
    for (std::uint32_t v = 0; v < joined.size(); ++v) {
      if (joined[v] != v) continue;
      positions_[kept] = positions_[v];
      if (has_normals_) points_.normals[kept] = conflict[v] ? Vec3f{} : points_.normals[v];
      if (has_colors_) points_.colors[kept] = points_.colors[v];
      number[v] = kept++;
    }
    if (std::find(conflict.begin(), conflict.end(), 1) != conflict.end())
      in_.unread("normals of vertices whose faces have different ones");
    positions_.resize(kept);
    if (has_normals_) points_.normals.resize(kept);
    if (std::all_of(points_.normals.begin(), points_.normals.end(), [](const Vec3f& n) { return n == Vec3f{}; }))
      points_.normals.clear();
    if (has_colors_) points_.colors.resize(kept);
    for (auto& t : points_.triangles)
      for (std::uint32_t& v : t) v = number[joined[v]];
    const std::size_t degenerate =
        std::erase_if(points_.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    if (degenerate > 0)
      in_.warn(fmt::format("{} triangles have coinciding corners and were left out", grouped(degenerate)));
  }

  const Input& in_;
  GltfDocument document_;
  PointSet points_;
  FaceSink faces_;
  std::vector<Vec3> positions_;
  std::size_t corners_ = 0;  // indices of all primitives
  std::vector<Vec3f> normals_;
  std::vector<std::array<std::uint8_t, 3>> colors_;
  std::vector<AttributeTable> tables_;
  std::vector<std::uint32_t> starts_;  ///< first vertex of each mesh
  bool has_normals_ = false, has_colors_ = false, has_triangles_ = false, lines_left_ = false, points_left_ = false,
       textures_ = false, targets_ = false;
};

}  // namespace

PointSet read_glb(const Input& in) { return GlbReader(in).read(); }

}  // namespace sansmesh::inline v1::io
