// Reads bodies and scenes from files.
#include <filesystem>
#include <memory>

#include "sansmesh/dataset/tet_dataset.h"
#include "sansmesh/error.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/tets/vertex_list.h"
#include "sansmesh/simulate.h"

namespace sansmesh::inline v1 {

const TetMesh& SimulationBody::mesh() const { return tets->mesh; }
const std::vector<std::string>& SimulationBody::notes() const { return tets->notes; }
std::uint32_t SimulationBody::vertex(std::uint64_t number) const { return tets->vertex(number); }

SimulationBody read_body(const std::string& file) {
  return {std::make_shared<const TetDataset>(read_tets(file)), file};
}

SceneScript read_scene(const std::string& file, const std::string& fixed, const SimulationBody& body, bool z_up) {
  SceneScript s;
  if (!file.empty()) {
    SceneVertices vertices;
    vertices.mesh = &body.mesh();
    vertices.find = [&](std::uint64_t n) { return body.vertex(n); };
    vertices.list = [&](const std::string& list) {
      return read_vertex_list((std::filesystem::path(file).parent_path() / list).string());
    };
    const io::FileContent content(file);
    try {
      s = parse_scene_script(std::string(content.bytes()), vertices, z_up);
    } catch (const ArgumentError& error) {
      throw FileError(file, error.what());
    }
    s.file = file;
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
