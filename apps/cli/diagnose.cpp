// sansmesh diagnose: where a function should not be trusted without a look.
#include <fmt/core.h>

#include "commands.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/function/diagnose_function.h"
#include "sansmesh/function/edit_script.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/io/io.h"

namespace sansmesh::cli {
namespace {

/// Places of each kind that are printed; --json has all.
constexpr std::size_t kPrintedPlaces = 5;

struct DiagnoseArguments {
  std::string input, script, preview;
  PictureArguments picture;
  DiagnoseOptions options;
};

std::string worst_of(const SuspiciousPlace& p) {
  switch (p.kind) {
    case Suspicion::low_coverage:
      return fmt::format("coverage down to {:.2f}", p.worst);
    case Suspicion::high_error:
      return "error up to " + length(p.worst);
    case Suspicion::extra_sheet:
      return "area " + length(p.worst);
    case Suspicion::steep:
      return fmt::format("gradient up to {:.2f}", p.worst);
  }
  return {};
}

void run_diagnose(DiagnoseArguments& a, Console& console) {
  a.options.validate();
  const RenderOptions picture_options = a.picture.chosen();
  picture_options.validate();
  if (!a.script.empty()) {
    if (!a.script.ends_with(".json")) throw FileError(a.script, "scripts are written to files with the ending .json");
    check_writable(a.script, "text");
  }
  if (!a.preview.empty()) check_writable(a.preview, "image");
  Progress& progress = console.progress();
  progress.begin("read");
  const SurfaceFunction function = read_function(a.input);
  Diagnosis d;
  Image picture;
  try {
    d = diagnose_function(function, a.options, progress);
    if (!a.preview.empty()) picture = render_mesh(d.mesh, picture_options, progress);
  } catch (const DataError& error) {
    throw FileError(a.input, error.what());
  }
  progress.begin("write");
  const std::vector<Edit> edits = d.edits();
  if (!a.script.empty()) write_text(a.script, edit_script(edits));
  if (!a.preview.empty()) write_image(a.preview, picture);
  progress.finish();

  const PartitionReport& r = function.field.report();
  console.say(fmt::format("{}: {}; largest gradient around the surface {:.2f}", a.input,
                          counted(r.functions, "local fit"), d.largest_gradient));
  Json json = {{"input", {{"file", a.input}, {"fits", r.functions}}},
               {"error_above", d.error_above},
               {"largest_gradient", d.largest_gradient}};
  json["places"] = Json::array();
  for (std::size_t k = 0; k < kSuspicions; ++k) {
    const auto kind = static_cast<Suspicion>(k);
    const std::string extra = kind == Suspicion::high_error ? fmt::format(" (above {})", length(d.error_above)) : "";
    console.say(fmt::format("{:<16}{}{}", suspicion_name(kind),
                            d.found[k] == 0 ? std::string("nowhere") : counted(d.found[k], "place"), extra));
    std::size_t printed = 0;
    for (const SuspiciousPlace& p : d.places) {
      if (p.kind != kind || printed++ >= kPrintedPlaces) continue;
      console.say(fmt::format("  at ({:.6g}, {:.6g}, {:.6g}), radius {}: {}, {}", p.position.x, p.position.y,
                              p.position.z, length(p.radius), worst_of(p), counted(p.supports, "fit")));
    }
  }
  for (const SuspiciousPlace& p : d.places)
    json["places"].push_back({{"kind", suspicion_name(p.kind)},
                              {"at", {p.position.x, p.position.y, p.position.z}},
                              {"radius", p.radius},
                              {"fits", p.supports},
                              {"worst", p.worst},
                              {"edit", p.edit.has_value()}});
  if (!a.script.empty()) {
    console.say(fmt::format("{}: {} to try with `sansmesh edit`", a.script, counted(edits.size(), "edit")));
    json["script"] = {{"file", a.script}, {"edits", edits.size()}};
  }
  if (!a.preview.empty())
    console.say(fmt::format("{}: yellow low coverage, orange high error, red extra sheets, violet steep", a.preview));
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_diagnose(CommandLine& app) {
  CommandLine& c = app.add_subcommand("diagnose", "Function file → suspicious places, a picture, and edits to try");
  auto a = std::make_shared<DiagnoseArguments>();
  c.add_option("input", a->input, "Function, .smf").type_name("FILE").required();
  c.add_option("--script", a->script, "Write a script for `sansmesh edit`, one step for each place: .json")
      .type_name("FILE");
  c.add_option("--preview", a->preview, "Draw the surface, suspicious places in colour, into this PNG")
      .type_name("FILE");
  add_picture_options(c, a->picture);
  c.add_option("--coverage", a->options.coverage_below,
               "Fits are suspicious if samples cover less than this share of them, 0..1 [0.3]")
      .type_name("SHARE");
  c.add_option("--error", a->options.error_above,
               "Fits are suspicious if their samples lie farther off than this (rms) [from data]")
      .type_name("LENGTH");
  c.add_option("--gradient", a->options.gradient_above,
               "Fits are suspicious if the gradient is longer than this, > 1 [3]")
      .type_name("NORM");
  c.add_option("--places", a->options.places, "Report at most this many places of each kind [20]").type_name("COUNT");
  c.footer(
      "Examples:\n"
      "  sansmesh diagnose scan.smf --preview places.png --script edits.json\n"
      "  sansmesh edit scan.smf --script edits.json -o mended.smf");
  return {&c, [a](Console& console) { run_diagnose(*a, console); }};
}

}  // namespace sansmesh::cli
