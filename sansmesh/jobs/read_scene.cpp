#include "sansmesh/jobs/read_scene.h"

#include <filesystem>

#include "sansmesh/error.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/vertex_list.h"

namespace sansmesh::inline v1 {

SceneScript read_scene(const std::string& scene, const std::string& fixed, const TetDataset& body, bool z_up) {
  SceneScript s;
  if (!scene.empty()) {
    SceneVertices vertices;
    vertices.mesh = &body.mesh;
    vertices.find = [&](std::uint64_t n) { return body.vertex(n); };
    vertices.list = [&](const std::string& file) {
      return read_vertex_list((std::filesystem::path(scene).parent_path() / file).string());
    };
    const io::FileContent content(scene);
    try {
      s = parse_scene_script(std::string(content.bytes()), vertices, z_up);
    } catch (const ArgumentError& error) {
      throw FileError(scene, error.what());
    }
  }
  if (fixed.empty()) return s;
  for (const std::uint64_t n : read_vertex_list(fixed)) try {
      s.scene.fixed.push_back(body.vertex(n));
    } catch (const DataError& error) {
      throw FileError(fixed, error.what());
    }
  return s;
}

}  // namespace sansmesh::inline v1
