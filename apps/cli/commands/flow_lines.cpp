// Command `flow lines`: stream, path, streak and time lines.
#include "sansmesh/flow.h"

#include <fmt/core.h>

#include <memory>
#include <optional>
#include <string>

#include "cli/input/flow_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "sansmesh/io.h"
#include "sansmesh/pictures.h"

namespace sansmesh::cli {
namespace {

struct FlowLinesArguments {
  FlowInput input;
  TraceLinesOptions options;
  LinePictureOptions drawn;
  PictureArguments picture;
  std::string output, preview;
  bool ascii = false;
};

/// Checks everything that can be checked before reading.
void check_flow_lines(FlowLinesArguments& a) {
  check_writable(a.output, "lines");
  a.options.validate();
  if (a.preview.empty()) {
    require(options_set(a.drawn).empty() && !a.picture.any(),
            "--color-by, --unit, --tube-radius, --background and the options of the picture need --preview");
    return;
  }
  a.drawn.picture = a.picture.chosen();
  a.drawn.default_view = !a.picture.has_view();
  a.drawn.validate(default_color(a.options.lines));
  check_writable(a.preview, "image");
}

void run_flow_lines(FlowLinesArguments& a, Console& console) {
  check_flow_lines(a);
  Progress& progress = console.progress();
  const FlowModel flow = a.input.open(console);
  a.drawn.check_color(arrays_along_lines(flow, a.options));
  const TraceLinesResult made = trace_lines_of(flow, a.options, progress);
  std::optional<LinePicture> picture;
  if (!a.preview.empty()) picture = line_picture(made.lines, a.drawn, default_color(a.options.lines), progress);
  progress.begin("write");
  write_lines(a.output, made.lines, {a.ascii});
  if (picture) a.picture.write(a.preview, picture->image, picture->made_with);
  console.note(flow.source(), made.notes);
  console.report(a.input.report(flow, progress), "input");
  console.report(FileReport{a.output}, "output");
  console.report_value("output.lines", made.lines.size());
  console.report_value("output.points", made.lines.positions.size());
  console.report(made.report);
  if (picture) console.report(FileReport{a.preview}, "preview"), console.report(*picture, "preview");

  console.print_named(flow.name(), summary_of(made));
  if (picture)
    console.print(fmt::format("{}: colours by {} over {:.6g} to {:.6g}, tubes of radius {}", a.preview,
                              picture->color_by, picture->lower, picture->upper, length(picture->radius)));
}

}  // namespace

Command add_flow_lines(CommandLine& flow) {
  CommandLine& c = flow.add_subcommand("lines", "Flow → stream, path, streak and time lines");
  auto shared = std::make_shared<FlowLinesArguments>();
  FlowLinesArguments& a = *shared;
  add_flow_input(c, a.input);
  c.add_option("-o,--output", a.output, "Lines to write: .vtp, .ply or .csv (line,time,x,y,z, …)")
      .writes({".vtp", ".ply", ".csv"})
      .required();
  const std::vector<std::string_view> steps = {"integrator", "tolerance", "step_length", "least_speed", "most_steps"};
  add_schema(c, a.options, {.without = steps});
  add_schema(c, a.options, {.group = "Steps", .only = steps});
  add_ascii_flag(c, a.ascii);
  add_preview_option(c, a.preview, "the lines as tubes");
  add_schema(c, a.drawn, {.group = "Picture"});
  add_background_option(c, a.picture);
  add_picture_options(c, a.picture);
  c.footer(std::string(kFlowsByFormula) +
           "Examples:\n"
           "  sansmesh flow lines office.vtk --seeds 'line(0,0,1, 4,4,1, 50)' -o lines.vtp\n"
           "  sansmesh flow lines eddies.nek5000 --unsteady --kind streak --seeds 'point(3,3,0)' -o dye.vtp\n"
           "  sansmesh flow lines tornado --seeds 'circle(0.5,0.5,0.02, 0,0,1, 0.3, 40)' --duration 10 -o column.csv");
  c.announce({report_of<ReadFlow>("input"), report_of<FileReport>("output"),
              value_of<std::size_t>("output.lines", "Lines"),
              value_of<std::size_t>("output.points", "Points of all lines"), report_of<FlowLineReport>(),
              report_of<FileReport>("preview"), report_of<LinePicture>("preview")});
  return {&c, [shared](Console& console) { run_flow_lines(*shared, console); }};
}

}  // namespace sansmesh::cli
