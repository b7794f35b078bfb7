#include "cli/input/surface_input.h"

#include <utility>

#include "cli/input/volume_input.h"
#include "sansmesh/data/reference_system.h"
#include "sansmesh/io.h"

namespace sansmesh::cli {

const ReportSchema& ReadSurface::schema() {
  static constexpr ReportRow rows[] = {
      reported_base<ReadFiles, ReadSurface>(),
      reported<&ReadSurface::kind>({.text = "Kind of the surface: mesh, points, function or isosurface"}),
      reported_inline<&ReadSurface::volume>(),
      reported<&ReadSurface::value>({.text = "Isovalue", .unit = "unit of the array"}),
      reported<&ReadSurface::reference_system>({.text = "Coordinate reference system of the file"}),
      reported<&ReadSurface::unit>({.text = "Unit of all lengths, if the file states it"})};
  return report_schema<rows>();
}

SurfaceInput open_surface(const CloudInput& input, Console& console) {
  const std::string file = input.name();
  ReadSurface report{input.report()};
  ReadReport read;
  const auto opened = [&]() -> AnySurface {
    if (const auto name = input.files.size() == 1 ? parse_isosurface_name(file) : std::nullopt) {
      NamedIsosurface named = open_isosurface(*name, console);
      report.files = {name->file};
      report.volume = std::move(named.use);
      report.value = name->value;
      return {std::move(named.surface), file};
    }
    if (input.is_function()) {
      console.progress().begin("read");
      return {read_function(file), file};
    }
    return {to_mesh(input.read(console, read)), file};
  };
  AnySurface surface = opened();
  report.kind = surface.kind_word();
  if (const ReferenceSystem* const system = surface.reference()) {
    report.reference_system = system_words(*system);
    if (!system->unit.empty()) report.unit = system->unit;
  }
  return {std::move(surface), std::move(report), std::move(read)};
}

SolidModel open_solid(const std::string& expression, Console& console) {
  SolidModel solid = read_solid(expression, console.progress());
  console.note(expression, solid.notes());
  return solid;
}

}  // namespace sansmesh::cli
