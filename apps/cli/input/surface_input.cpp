#include "cli/input/surface_input.h"

#include <utility>

#include "cli/input/volume_input.h"
#include "sansmesh/io.h"

namespace sansmesh::cli {

const ReportSchema& ReadSurface::schema() {
  static constexpr ReportRow rows[] = {
      reported_base<ReadFiles, ReadSurface>(),
      reported<&ReadSurface::kind>({.text = "Kind of the surface: mesh, points, function or isosurface"}),
      reported_beside<&ReadSurface::volume>(),
      reported<&ReadSurface::value>({.text = "Value of an isosurface", .unit = "unit of the array"})};
  static constexpr ReportSchema schema{rows};
  return schema;
}

SurfaceInput open_surface(const CloudInput& input, Console& console) {
  const std::string file = input.name();
  ReadSurface told{input.told()};
  ReadReport read;
  const auto opened = [&]() -> AnySurface {
    if (const auto name = input.files.size() == 1 ? parse_isosurface_name(file) : std::nullopt) {
      NamedIsosurface named = open_isosurface(*name, console);
      told.files = {name->file};
      told.volume = std::move(named.use);
      told.value = name->value;
      return {std::move(named.surface), file};
    }
    if (input.is_function()) {
      console.progress().begin("read");
      return {read_function(file), file};
    }
    return {to_mesh(input.read(console, read)), file};
  };
  AnySurface surface = opened();
  told.kind = surface.kind_word();
  return {std::move(surface), std::move(told), std::move(read)};
}

SolidModel open_solid(const std::string& expression, Console& console) {
  SolidModel solid = read_solid(expression, console.progress());
  console.note(expression, solid.notes());
  return solid;
}

}  // namespace sansmesh::cli
