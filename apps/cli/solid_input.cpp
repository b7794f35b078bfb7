#include "solid_input.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "sansmesh/core/error.h"
#include "sansmesh/csg/parse_csg.h"
#include "sansmesh/function/function_distance.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/function/function_solid.h"
#include "sansmesh/function/mesh_solid.h"
#include "sansmesh/io/io.h"
#include "volume_input.h"

namespace sansmesh::cli {
namespace {

/// Above this share of its area that bounds no solid a function is warned of.
constexpr double kOpenShare = 0.01;

TriangleMesh load_mesh(const std::string& file, Console& console) {
  ReadReport report;
  PointSet points = read_points(file, &report);
  if (points.triangles.empty())
    throw FileError(file, "neither a function (.smf) nor a mesh: sansmesh fit makes a function from a scan");
  console.warn(file, report.warnings);
  return to_mesh(std::move(points));
}

}  // namespace

ComponentChoice SolidInput::usual_components() const {
  return {functions.empty() ? ComponentChoice::Kind::all : ComponentChoice::Kind::automatic, 1};
}

bool is_open(const SurfaceFunction& function) {
  const PartitionReport& fitted = function.field.report();
  return fitted.open_area > kOpenShare * fitted.area;
}

void SolidInput::warn_of_open(Console& console) const {
  for (const auto& [name, function] : functions)
    if (is_open(*function))
      console.warn(name, {"its surface bounds no solid: taken as all that lies behind it, as far as the box reaches"});
}

SolidInput open_solid(const std::string& expression, Console& console) {
  console.progress().begin("read");
  std::vector<std::string> files;
  std::map<std::string, std::shared_ptr<const SurfaceFunction>> functions;
  std::map<std::string, TriangleMesh> meshes;
  const auto add_file = [&](const std::string& name) {
    if (std::find(files.begin(), files.end(), name) == files.end()) files.push_back(name);
  };
  const auto load = [&](const std::string& name) {
    std::shared_ptr<const SurfaceFunction>& function = functions[name];
    if (!function) function = std::make_shared<const SurfaceFunction>(read_function(name));
    add_file(name);
    return function;
  };
  // The exact distance to its faces; of offsets with their rounded edges.
  const auto solid_of_mesh = [&](const std::string& name, bool rounded) {
    auto known = meshes.find(name);
    const bool first = known == meshes.end();
    if (first) known = meshes.emplace(name, load_mesh(name, console)).first;
    add_file(name);
    std::vector<std::string> warnings;
    try {
      const Solid solid = mesh_solid(known->second, rounded, warnings);
      if (first) console.warn(name, warnings);
      return solid;
    } catch (const DataError& e) {
      throw FileError(name, e.what());
    }
  };
  const auto volume_solid = [&](const std::string& name) -> std::optional<Solid> {
    const auto isosurface = parse_isosurface_name(name);
    if (!isosurface) return std::nullopt;
    files.push_back(name);
    return isosurface_solid(open_isosurface(*isosurface, console).surface);
  };
  Solid solid = parse_csg(
      expression,
      [&](const std::string& name) {
        const auto of_volume = volume_solid(name);
        if (of_volume) return *of_volume;
        return is_function_file(name) ? function_solid(load(name)) : solid_of_mesh(name, false);
      },
      [&](const std::string& name) {
        if (parse_isosurface_name(name))
          throw ArgumentError(
              fmt::format("'{}': offsets and shells of isosurfaces need a fit: volume isosurface, then fit", name));
        if (!is_function_file(name)) return solid_of_mesh(name, true);
        return function_distance_solid(load(name), console.progress());
      });
  return {std::move(solid), std::move(files), std::move(functions)};
}

}  // namespace sansmesh::cli
