#include "solid_input.h"

#include <fmt/core.h>

#include <optional>
#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/csg/parse_csg.h"
#include "sansmesh/function/function_distance.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/function/function_solid.h"
#include "volume_input.h"

namespace sansmesh::cli {
namespace {

/// Above this share of its area that bounds no solid a function is warned of.
constexpr double kOpenShare = 0.01;

std::shared_ptr<const SurfaceFunction> load_function(const std::string& file) {
  if (!is_function_file(file)) throw FileError(file, "no function file (.smf): sansmesh fit makes one from a scan");
  return std::make_shared<const SurfaceFunction>(read_function(file));
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
  const auto load = [&](const std::string& name) {
    std::shared_ptr<const SurfaceFunction>& function = functions[name];
    if (!function) {
      function = load_function(name);
      files.push_back(name);
    }
    return function;
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
        return of_volume ? *of_volume : function_solid(load(name));
      },
      [&](const std::string& name) {
        if (parse_isosurface_name(name))
          throw ArgumentError(
              fmt::format("'{}': offsets and shells of isosurfaces need a fit: volume isosurface, then fit", name));
        return csg::leaf(std::make_shared<FunctionDistance>(load(name), console.progress()));
      });
  return {std::move(solid), std::move(files), std::move(functions)};
}

}  // namespace sansmesh::cli
