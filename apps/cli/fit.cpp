// sansmesh fit: points in, function file out.
#include "sansmesh/functions.h"

#include <fmt/core.h>

#include <utility>

#include "cloud_input.h"
#include "commands.h"
#include "option_groups.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "schema_options.h"

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
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  PointSet points = a.input.read(console, read);
  const std::size_t given = points.size();
  const CloudScale scale(points);
  const auto [function, report, notes] =
      naming(a.input.name(), console, [&] { return fit_function(std::move(points), a.options, progress); });
  console.note(a.input.name(), notes);
  progress.begin("write");
  write_function(a.output, function, !a.without_samples);
  progress.finish();

  const FunctionInfo r = info(function);
  console.say(fmt::format("{}: {} ({})", a.input.name(), counted(given, "point"), read.format));
  console.say(fmt::format("spacing {}, noise {}, expected error of the surface {}", length(scale.spacing),
                          scale.noise_words(), length(r.accuracy)));
  console.say("normals " + normals_made(report.estimated_normals, report.oriented_by));
  if (!report.alignment.empty()) console.say(report.alignment);
  console.say(fmt::format("{}: {} down to depth {}, {} with creases{}", a.output, counted(r.fits, "local fit"), r.depth,
                          grouped(r.creased), a.without_samples ? ", without samples" : ""));
  if (r.paper)
    for (const std::string& line : paper_words(*r.paper, r.fits_of_degree)) console.say(line);
  Json json = {{"input", a.input.json(read, given)}};
  scale.add_to(json);
  json["deviation"] = r.deviation;
  json["normals"] = normals_made_json(report.estimated_normals, report.oriented_by);
  json["accuracy"] = r.accuracy;
  json["depth"] = r.depth;
  json["fits"] = r.fits;
  json["fits_of_degree"] = r.fits_of_degree;
  json["creased"] = r.creased;
  json["output"] = {{"file", a.output}, {"samples", a.without_samples ? 0 : function.samples()}};
  if (r.paper) json["paper"] = paper_json(*r.paper);
  if (a.options.cloud.align) json["alignment"] = report.alignment;
  console.say_json(json);
  console.print_timings();
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
  c.add_option("-o,--output", a->output, "Function to write: .smf").type_name("FILE").required();
  c.add_flag("--without-samples", a->without_samples, "A smaller file, but parts of it cannot be fitted again");
  add_schema(c, a->options.cloud, {.without = {"class"}});
  add_fit_options(c, a->options.fit);
  c.footer(std::string(kReadable) +
           "\n\nExamples:\n"
           "  sansmesh fit scan.ply -o scan.smf\n"
           "  sansmesh mesh scan.smf -o scan-mesh.ply\n"
           "  sansmesh diagnose scan.smf");
  return {&c, [a](Console& console) { run_fit(*a, console); }};
}

}  // namespace sansmesh::cli
