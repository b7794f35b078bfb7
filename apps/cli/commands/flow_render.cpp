// Command `flow render`: pictures of stream, path, streak and time surfaces.
#include <memory>
#include <string>

#include "cli/input/flow_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "sansmesh/flow_pictures.h"
#include "sansmesh/io.h"
#include "sansmesh/jobs/pictures/picture_contents.h"

namespace sansmesh::cli {
namespace {

struct FlowRenderArguments {
  FlowInput input;
  FlowPictureOptions options;
  PictureContentsOptions contents;
  PictureArguments picture;
  std::string output;
};

void run_flow_render(FlowRenderArguments& a, Console& console) {
  check_writable(a.output, "image");
  a.options.picture = a.picture.chosen();
  a.options.default_view = !a.picture.has_view();
  a.options.validate();
  a.picture.check_frames(a.options.frames.has_value());
  require(!a.options.in_volume() || !a.input.flow.unsteady,
          "--volume-array and --iso need a steady flow");  // before reading
  const FlowModel flow = a.input.open(console);
  check_colors(flow, a.options);
  PictureFiles files(a.picture, a.output, a.options.frames.has_value(), console);
  const PictureContents contents(a.contents, a.options.picture, console.progress());
  console.note({}, contents.notes());
  const FlowPicturesResult made =
      flow_pictures(flow, a.options, contents.surfaces(), files.writer(), console.progress());
  console.note(flow.source(), made.notes);
  console.report(a.input.report(flow, console.progress()), "input");
  console.report(files.written(), "output");
  console.report(made);
  console.print_named(flow.name(), summary_of(made.surface));
  console.print(files.written().size_line());
}

}  // namespace

Command add_flow_render(CommandLine& flow) {
  CommandLine& c = flow.add_subcommand("render", "Flow and a seed curve → picture of the surface, with streaks");
  auto shared = std::make_shared<FlowRenderArguments>();
  FlowRenderArguments& a = *shared;
  add_flow_surface_input(c, a.input, a.options.trace);
  add_picture_output(c, a.output);
  add_schema(c, a.options,
             {.group = "Look",
              .only = {"streaks", "streak_length", "streak_width", "streak_contrast", "splats", "opacity", "arrows",
                       "color_by", "frames", "turn"}});
  add_schema(c, a.options,
             {.group = "Beside the surface", .only = {"volume_array", "preset", "opacity_factor", "iso"}});
  add_schema(c, a.contents);
  add_schema(c, a.options, {.group = "Picture", .only = {"bar", "label", "unit", "title"}});
  add_background_option(c, a.picture);
  add_picture_options(c, a.picture);
  add_wireframe_options(c, a.picture.options);
  c.footer(std::string(kFlowsByFormula) +
           "Examples:\n"
           "  sansmesh flow render office.vtk --seeds 'line(0.5,0.5,1, 4,4,1, 200)' -o stream.png --mesh walls.ply\n"
           "  sansmesh flow render tornado --seeds 'circle(0.5,0.5,0.02, 0,0,1, 0.2, 100)' --duration 5 -o t.png "
           "--opacity 0.5\n"
           "  sansmesh flow render eddies.nek5000 --unsteady --seeds 'line(1,1,0, 5,5,0, 200)' -o path.png "
           "--frames 24");
  c.announce({report_of<ReadFlow>("input"), report_of<WrittenPictures>("output"), report_of<FlowPicturesResult>()});
  return {&c, [shared](Console& console) { run_flow_render(*shared, console); }};
}

}  // namespace sansmesh::cli
