// Command `fit`: fits a function to points.
#include "sansmesh/functions.h"
#include "sansmesh/jobs/surfaces/fit_words.h"

#include <fmt/core.h>

#include <utility>

#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"

namespace sansmesh::cli {
namespace {

struct FitArguments {
  CloudInput input;
  std::string output;
  bool without_samples = false;
  FitFunctionOptions options;
};

void run_fit(const FitArguments& a, Console& console) {
  a.options.validate();
  check_function_writable(a.output);
  ReadReport read;
  PointSet points = a.input.read(console, read);
  FitFunctionOptions options = a.options;
  options.cloud.classes = a.input.classes;  // none of them is left out by default
  const std::size_t given = points.size();
  const CloudScale scale(points);
  const auto [function, report, notes] = naming(a.input.name(), console, [&, &all = points] {
    return fit_function(std::move(all), options, console.progress());
  });
  console.note(a.input.name(), notes);
  console.progress().begin("write");
  write_function(a.output, function, !a.without_samples);
  console.report(a.input.report(read, given), "input");
  const FunctionInfo f = info(function);
  console.report(f);
  console.report(scale);
  console.report(report);
  console.report(FileReport{a.output}, "output");
  console.report_value("output.samples", a.without_samples ? 0 : function.samples());

  console.print(fmt::format("{}: {} ({})", a.input.name(), counted(given, "point"), read.format));
  console.print(fmt::format("spacing {}, noise {}, expected error of the surface {}", length(scale.spacing),
                            scale.noise_words(), length(f.accuracy)));
  console.print(normals_made(report.estimated_normals, report.oriented_by));
  if (!report.alignment.empty()) console.print(report.alignment);
  console.print(fmt::format("{}: {} down to depth {}, {} with creases{}", a.output, counted(f.fits, "local fit"),
                            f.depth, grouped(f.creased), a.without_samples ? ", without samples" : ""));
  if (f.paper)
    for (const std::string& line : paper_words(*f.paper, f.fits_of_degree)) console.print(line);
}

}  // namespace

void check_function_writable(const std::string& file) {
  if (!is_function_file(file))
    throw FileError(file, "functions are written to files with the ending .smf (or .smf.gz)");
  check_writable(file, "text");
}

Command add_fit(CommandLine& app) {
  CommandLine& c = app.add_subcommand("fit", "Points → function file, the input of mesh, probe, edit, …");
  auto a = std::make_shared<FitArguments>();
  add_cloud_input(c, a->input, "Points, or a mesh or polygon soup");
  c.add_option("-o,--output", a->output, "Function to write: .smf").writes({".smf"}).required();
  c.add_flag("--without-samples", a->without_samples, "Write a smaller file, which cannot be refitted");
  add_schema(c, a->options.cloud, {.without = {"class"}});
  add_fit_options(c, a->options.fit);
  c.footer(std::string(kReadable) +
           "\n\nExamples:\n"
           "  sansmesh fit scan.ply -o scan.smf\n"
           "  sansmesh mesh scan.smf -o scan-mesh.ply\n"
           "  sansmesh diagnose scan.smf");
  c.announce({report_of<ReadCloud>("input"), report_of<FunctionInfo>(), report_of<CloudScale>(),
              report_of<FitFunctionReport>(), report_of<FileReport>("output"),
              value_of<std::size_t>("output.samples", "Samples in the file")});
  return {&c, [a](Console& console) { run_fit(*a, console); }};
}

}  // namespace sansmesh::cli
