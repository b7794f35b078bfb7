// sansmesh render: a picture of a mesh or a cloud.
#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "commands.h"
#include "sansmesh/io/io.h"
#include "sansmesh/polygonize/mesh_distance.h"

namespace sansmesh::cli {

void run_render(const RenderArguments& arguments, Console& console) {
  if (arguments.surface || is_function_file(arguments.input)) return run_surface_picture(arguments, console);
  arguments.options.validate();
  check_writable(arguments.output, "image");

  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  const TriangleMesh mesh = to_mesh(read_points(arguments.input, &read));
  console.warn(arguments.input, read.warnings);
  Image image;
  try {
    image = render_mesh(mesh, arguments.options, progress);
  } catch (const DataError& error) {
    throw FileError(arguments.input, error.what());
  }
  progress.begin("write");
  write_image(arguments.output, image);
  progress.finish();
  console.say(fmt::format("{}: {} × {} pixels", arguments.output, image.width, image.height));
  const nlohmann::ordered_json json = {
      {"output", {{"file", arguments.output}, {"width", image.width}, {"height", image.height}}}};
  console.say_json(json.dump(2));
  console.print_timings();
}

}  // namespace sansmesh::cli
