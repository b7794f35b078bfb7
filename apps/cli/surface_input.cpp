#include "surface_input.h"

#include <utility>

#include "sansmesh/io.h"
#include "volume_input.h"

namespace sansmesh::cli {

SurfaceInput open_surface(const CloudInput& input, Console& console) {
  console.progress().begin("read");
  const std::string file = input.name();
  Json json = input.json();
  ReadReport read;
  const auto opened = [&]() -> AnySurface {
    if (const auto name = input.files.size() == 1 ? parse_isosurface_name(file) : std::nullopt) {
      NamedIsosurface named = open_isosurface(*name, console);
      json = std::move(named.json);
      return {std::move(named.surface), file};
    }
    if (input.is_function()) return {read_function(file), file};
    return {to_mesh(input.read(console, read)), file};
  };
  AnySurface surface = opened();
  json["kind"] = surface.kind_word();
  return {std::move(surface), std::move(json), std::move(read)};
}

}  // namespace sansmesh::cli
