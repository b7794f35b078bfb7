#include "simulate_scene.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "sansmesh/core/error.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/vertex_list.h"

namespace sansmesh::cli {
namespace {

constexpr double kFloorBelow = 0.3;  ///< of the body's height: how far it falls to the floor that nobody asked for

template <class T>
void override_by(std::optional<T>& value, const std::optional<T>& flag) {
  if (flag) value = flag;
}

/// Materials of the file (Vega's, or arrays of the same three names) where nobody says another: their means.
void take_material(const SimulateArguments& a, const TetDataset& body, SceneScript& s,
                   std::vector<std::string>& notes) {
  const AttributeTable& arrays = body.mesh.tet_attributes;
  const auto* const density = arrays.find<double>("density");
  const auto* const young = arrays.find<double>("young");
  const auto* const poisson = arrays.find<double>("poisson");
  if (!density || !young || !poisson) return;
  double sum[3] = {};
  std::size_t known = 0;
  bool differ = false;
  std::array<double, 3> first{};
  for (std::size_t t = 0; t < density->size(); ++t) {
    const std::array<double, 3> m{(*density)[t], (*young)[t], (*poisson)[t]};
    if (std::isnan(m[0]) || std::isnan(m[1]) || std::isnan(m[2])) continue;
    if (!(m[0] > 0 && m[1] > 0 && m[2] >= 0 && m[2] <= 0.49 && std::isfinite(m[0]) && std::isfinite(m[1])))
      throw FileError(a.tets,
                      fmt::format("the material of a cell cannot be simulated (density {:g}, Young's modulus {:g} Pa, "
                                  "Poisson's ratio {:g}): the first two must be above 0, the last in 0..0.49",
                                  m[0], m[1], m[2]));
    if (known++ == 0) first = m;
    differ = differ || m != first;
    for (std::size_t k = 0; k < 3; ++k) sum[k] += m[k];
  }
  if (known == 0) return;
  const bool springs = s.model == SoftBodyModel::springs || s.stiffness;
  const bool taken = !s.density || (!springs && (!s.young || !s.poisson));
  const auto mean = [&](std::size_t k, std::optional<double>& value) {
    if (!value) value = differ ? sum[k] / static_cast<double>(known) : first[k];
  };
  mean(0, s.density);
  if (!springs) mean(1, s.young), mean(2, s.poisson);
  if (taken && differ) notes.emplace_back("several materials: the whole body is of their mean");
  if (taken && known < density->size())
    notes.push_back(
        fmt::format("{} without a material: they are of that of the others", counted(density->size() - known, "cell")));
}

/// Whether nothing keeps the body from falling for ever.
bool falls(const SceneScript& s) {
  return s.scene.fixed.empty() && s.scene.handles.empty() && s.scene.floors.empty() && s.scene.spheres.empty() &&
         !s.no_floor;
}

}  // namespace

SceneScript read_scene(const SimulateArguments& a, const TetDataset& body, std::vector<std::string>& notes) {
  SceneVertices vertices;
  vertices.mesh = &body.mesh;
  vertices.find = [&](std::uint64_t n) { return body.vertex(n); };
  vertices.list = [&](const std::string& file) {
    return read_vertex_list((std::filesystem::path(a.forces).parent_path() / file).string());
  };
  SceneScript s;
  if (!a.forces.empty()) {
    const io::FileContent content(a.forces);
    try {
      s = parse_scene_script(std::string(content.bytes()), vertices, a.picture.z_up);
    } catch (const ArgumentError& error) {
      throw FileError(a.forces, error.what());
    }
  }
  if (!a.fixed.empty()) {
    for (const std::uint64_t n : read_vertex_list(a.fixed)) try {
        s.scene.fixed.push_back(body.vertex(n));
      } catch (const DataError& error) {
        throw FileError(a.fixed, error.what());
      }
    std::sort(s.scene.fixed.begin(), s.scene.fixed.end());
    s.scene.fixed.erase(std::unique(s.scene.fixed.begin(), s.scene.fixed.end()), s.scene.fixed.end());
  }
  const SceneScript& f = a.flags;
  override_by(s.model, f.model);
  override_by(s.integrator, f.integrator);
  override_by(s.step, f.step), override_by(s.duration, f.duration);
  override_by(s.frames_per_second, f.frames_per_second);
  override_by(s.stiffness, f.stiffness), override_by(s.young, f.young), override_by(s.poisson, f.poisson);
  override_by(s.density, f.density), override_by(s.unit, f.unit);
  take_material(a, body, s, notes);
  if (s.stiffness && !s.model) s.model = SoftBodyModel::springs;
  if (f.damping) {
    s.damping = f.damping;
    s.stiffness_damping = f.damping;
  }
  if (a.picture.z_up) s.z_up = true;
  return s;
}

void add_floor_below(SceneScript& s, const TetMesh& mesh, const SoftBodyOptions& options) {
  if (!s.floor_below && !falls(s)) return;
  if (!(norm(options.gravity) > 0)) return;
  const Vec3 up = -normalized(options.gravity);
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const Vec3& p : mesh.vertices) {
    lowest = std::min(lowest, dot(p, up));
    highest = std::max(highest, dot(p, up));
  }
  FloorObstacle floor;
  floor.normal = up;
  floor.point = up * (lowest - kFloorBelow * (highest - lowest));
  floor.friction = s.friction.value_or(0.3);
  s.scene.floors.push_back(floor);
}

}  // namespace sansmesh::cli
