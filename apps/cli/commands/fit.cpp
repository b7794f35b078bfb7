// sansmesh fit: points in, function file out.
#include "sansmesh/functions.h"
#include "sansmesh/jobs/fit_words.h"

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
  const std::size_t given = points.size();
  const CloudScale scale(points);
  const auto [function, report, notes] = naming(a.input.name(), console, [&, &all = points] {
    return fit_function(std::move(all), a.options, console.progress());
  });
  console.note(a.input.name(), notes);
  console.progress().begin("write");
  write_function(a.output, function, !a.without_samples);
  console.tell(a.input.told(read, given), "input");
  const FunctionInfo f = info(function);
  console.tell(f);
  console.tell(scale);
  console.tell(report);
  console.tell(ToldFile{a.output}, "output");
  console.tell_value("output.samples", a.without_samples ? 0 : function.samples());

  console.say(fmt::format("{}: {} ({})", a.input.name(), counted(given, "point"), read.format));
  console.say(fmt::format("spacing {}, noise {}, expected error of the surface {}", length(scale.spacing),
                          scale.noise_words(), length(f.accuracy)));
  console.say(normals_made(report.estimated_normals, report.oriented_by));
  if (!report.alignment.empty()) console.say(report.alignment);
  console.say(fmt::format("{}: {} down to depth {}, {} with creases{}", a.output, counted(f.fits, "local fit"), f.depth,
                          grouped(f.creased), a.without_samples ? ", without samples" : ""));
  if (f.paper)
    for (const std::string& line : paper_words(*f.paper, f.fits_of_degree)) console.say(line);
}

}  // namespace

void check_function_writable(const std::string& file) {
  if (!is_function_file(file))
    throw FileError(file, "functions are written to files with the ending .smf (or .smf.gz)");
  check_writable(file, "text");
}

Command add_fit(CommandLine& app) {
  CommandLine& c = app.add_subcommand("fit", "Points → function file, from which all else can be made");
  auto a = std::make_shared<FitArguments>();
  add_cloud_input(c, a->input, "Points, or a mesh or polygon soup");
  c.add_option("-o,--output", a->output, "Function to write: .smf").writes({".smf"}).required();
  c.add_flag("--without-samples", a->without_samples, "A smaller file, but parts of it cannot be fitted again");
  add_schema(c, a->options.cloud, {.without = {"class"}});
  add_fit_options(c, a->options.fit);
  c.footer(std::string(kReadable) +
           "\n\nExamples:\n"
           "  sansmesh fit scan.ply -o scan.smf\n"
           "  sansmesh mesh scan.smf -o scan-mesh.ply\n"
           "  sansmesh diagnose scan.smf");
  c.tells({told<ReadCloud>("input"), told<FunctionInfo>(), told<CloudScale>(), told<FitFunctionReport>(),
           told<ToldFile>("output"), told_value<std::size_t>("output.samples", "Samples that were written with it")});
  return {&c, [a](Console& console) { run_fit(*a, console); }};
}

}  // namespace sansmesh::cli
