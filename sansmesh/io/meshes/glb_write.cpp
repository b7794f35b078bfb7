// Binary glTF 2.0: one mesh of one primitive. Positions stay relative to the mesh's origin, which becomes the
// translation of the node, because glTF has only floats.
#include <nlohmann/json.hpp>

#include "sansmesh/io/output.h"
#include "sansmesh/io/reference_text.h"

namespace sansmesh::inline v1::io {
namespace {

using nlohmann::json;

constexpr int array_buffer = 34962, element_array_buffer = 34963;
constexpr int component_u16 = 5123, component_u32 = 5125, component_float = 5126;

/// The binary chunk with its views and accessors.
class GlbBody {
 public:
  /// Adds `count` elements of `stride` bytes as a new view with an accessor; returns the accessor's index.
  std::size_t add(const void* data, std::size_t count, std::size_t stride, int target, json accessor) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    views_.push_back(
        {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", count * stride}, {"target", target}});
    bytes_.append(static_cast<const char*>(data), count * stride);
    accessor["bufferView"] = views_.size() - 1;
    accessor["count"] = count;
    accessors_.push_back(std::move(accessor));
    return accessors_.size() - 1;
  }
  std::string& bytes() { return bytes_; }
  json& views() { return views_; }
  json& accessors() { return accessors_; }

 private:
  std::string bytes_;
  json views_ = json::array(), accessors_ = json::array();
};

/// The standard requires unit normals: unknown ones become the mean of the adjacent triangles.
std::vector<Vec3f> complete_normals(const TriangleMesh& m) {
  std::vector<Vec3f> normals = m.normals;
  if (std::find(normals.begin(), normals.end(), Vec3f{}) == normals.end()) return normals;
  std::vector<Vec3> sums(m.vertices.size());
  for (const Triangle& t : m.triangles) {
    const Vec3 a(m.vertices[t[0]]), b(m.vertices[t[1]]), c(m.vertices[t[2]]);
    const Vec3 area = cross(b - a, c - a);
    for (const std::uint32_t v : t) sums[v] += area;
  }
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (normals[i] != Vec3f{}) continue;
    const Vec3 n = normalized(sums[i]);
    normals[i] = n == Vec3{} ? Vec3f{0, 0, 1} : Vec3f(n);
  }
  return normals;
}

/// Colours of glTF are linear; 16 bits keep dark ones distinct.
std::vector<std::array<std::uint16_t, 4>> linear_colors(const TriangleMesh& m) {
  std::array<std::uint16_t, 256> table;
  for (std::size_t k = 0; k < 256; ++k) {
    const double s = static_cast<double>(k) / 255;
    const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
    table[k] = static_cast<std::uint16_t>(std::lround(65535 * linear));
  }
  std::vector<std::array<std::uint16_t, 4>> colors(m.colors.size());
  for (std::size_t i = 0; i < colors.size(); ++i) {
    colors[i] = {table[m.colors[i][0]], table[m.colors[i][1]], table[m.colors[i][2]], 65535};
  }
  return colors;
}

/// Custom attributes of glTF begin with an underscore; by convention the rest is in capitals.
std::string attribute_name(const std::string& name) {
  std::string result = "_";
  for (const char c : name) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    result += !letter ? '_' : c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  }
  return result;
}

template <class T>
void append(std::string& s, T value) {
  s.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

}  // namespace

std::vector<std::string> mesh_to_glb(const TriangleMesh& m, const WriteOptions&) {
  json document = {{"asset", {{"version", "2.0"}, {"generator", "sansmesh"}}}, {"scene", 0}};
  if (const std::string system = system_line(m.reference.get()); !system.empty())
    document["asset"]["extras"][kSystemExtra] = system;
  json node = json::object();
  GlbBody body;
  if (!m.vertices.empty() && !m.triangles.empty()) {
    const Box3f box = bounds(m);
    json primitive = {{"mode", 4}, {"material", 0}};
    json& attributes = primitive["attributes"] = json::object();
    attributes["POSITION"] = body.add(m.vertices.data(), m.vertices.size(), 12, array_buffer,
                                      {{"componentType", component_float},
                                       {"type", "VEC3"},
                                       {"min", {box.lower.x, box.lower.y, box.lower.z}},
                                       {"max", {box.upper.x, box.upper.y, box.upper.z}}});
    if (!m.normals.empty()) {
      const std::vector<Vec3f> normals = complete_normals(m);
      attributes["NORMAL"] = body.add(normals.data(), normals.size(), 12, array_buffer,
                                      {{"componentType", component_float}, {"type", "VEC3"}});
    }
    if (!m.colors.empty()) {
      const auto colors = linear_colors(m);
      attributes["COLOR_0"] = body.add(colors.data(), colors.size(), 8, array_buffer,
                                       {{"componentType", component_u16}, {"type", "VEC4"}, {"normalized", true}});
    }
    for (const Attribute& a : m.attributes) {
      const std::vector<float>* const values = a.as<float>();
      const std::string name = attribute_name(a.name);
      if (!values || a.components > 4 || attributes.contains(name)) continue;
      constexpr const char* types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
      attributes[name] = body.add(values->data(), a.rows(), 4 * a.components, array_buffer,
                                  {{"componentType", component_float}, {"type", types[a.components - 1]}});
    }
    const std::size_t corners = 3 * m.triangles.size();
    if (m.vertices.size() < 65535) {
      std::vector<std::uint16_t> narrow(corners);
      for (std::size_t i = 0; i < corners; ++i) narrow[i] = static_cast<std::uint16_t>(m.triangles[i / 3][i % 3]);
      primitive["indices"] = body.add(narrow.data(), corners, 2, element_array_buffer,
                                      {{"componentType", component_u16}, {"type", "SCALAR"}});
    } else {
      primitive["indices"] = body.add(m.triangles.data(), corners, 4, element_array_buffer,
                                      {{"componentType", component_u32}, {"type", "SCALAR"}});
    }
    document["materials"] = {
        {{"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 0.7}}}, {"doubleSided", true}}};
    document["meshes"] = {{{"primitives", {primitive}}}};
    document["accessors"] = body.accessors();
    document["bufferViews"] = body.views();
    body.bytes().resize((body.bytes().size() + 3) / 4 * 4);
    document["buffers"] = {{{"byteLength", body.bytes().size()}}};
    node["mesh"] = 0;
  }
  if (m.origin != Vec3{}) node["translation"] = {m.origin.x, m.origin.y, m.origin.z};
  document["nodes"] = json::array({node});
  document["scenes"] = json::array({{{"nodes", json::array({0})}}});

  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::uint64_t total = 12 + 8 + text.size() + (body.bytes().empty() ? 0 : 8 + body.bytes().size());
  if (total > 0xffffffffu) throw ArgumentError("a GLB file cannot exceed 4 GiB; write a PLY file instead");
  std::string head;
  append<std::uint32_t>(head, 0x46546c67);  // "glTF"
  append<std::uint32_t>(head, 2);
  append<std::uint32_t>(head, static_cast<std::uint32_t>(total));
  append<std::uint32_t>(head, static_cast<std::uint32_t>(text.size()));
  append<std::uint32_t>(head, 0x4e4f534a);  // "JSON"
  head += text;
  if (body.bytes().empty()) return {std::move(head)};
  append<std::uint32_t>(head, static_cast<std::uint32_t>(body.bytes().size()));
  append<std::uint32_t>(head, 0x004e4942);  // "BIN"
  return {std::move(head), std::move(body.bytes())};
}

}  // namespace sansmesh::inline v1::io
