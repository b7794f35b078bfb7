// sansmesh advise: which method suits these samples?
#include "sansmesh/advise/advise.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "commands.h"
#include "option_groups.h"
#include "sansmesh/advise/traits.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"

namespace sansmesh::cli {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const CloudTraits& t) {
  return {{"samples", t.samples},
          {"diagonal", t.diagonal},
          {"spacing", t.spacing},
          {"noise", t.noise},
          {"density_ratio", t.density_ratio},
          {"evenness", t.evenness},
          {"outliers", t.outliers},
          {"creases", t.creases_known ? Json(t.creases) : Json()},
          {"crease_length", t.creases_known ? Json(t.crease_length) : Json()},
          {"borders", t.borders},
          {"border_length", t.border_length},
          {"faces", t.faces},
          {"normals", normals_word(t.normals)}};
}

void run_advise(const std::string& file, Console& console) {
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  const PointSet points = read_points(file, &read);
  console.warn(file, read.warnings);
  Advice advice;
  try {
    advice = advise(points, progress, file);
  } catch (const DataError& error) {
    throw FileError(file, error.what());
  }
  progress.finish();
  console.warn(file, advice.warnings);

  const CloudTraits& t = advice.traits;
  console.say(fmt::format("{}: {}, spacing {}, noise {} ({})", file, counted(t.samples, "sample"), length(t.spacing),
                          length(t.noise), read.format));
  for (const std::string& finding : advice.findings) console.say("  " + finding);
  for (const Recommendation& r : advice.recommendations) {
    console.say(fmt::format("{:<10}{}", aim_word(r.aim), r.why));
    for (const std::string& command : r.commands) console.say("  $ " + command);
  }

  Json json = {{"input", {{"file", file}, {"format", read.format}, {"points", points.size()}}},
               {"traits", to_json(t)},
               {"findings", advice.findings}};
  json["recommendations"] = Json::array();
  for (const Recommendation& r : advice.recommendations)
    json["recommendations"].push_back({{"aim", aim_word(r.aim)},
                                       {"surface", r.surface.empty() ? Json() : Json(r.surface)},
                                       {"commands", r.commands},
                                       {"why", r.why}});
  std::vector<std::string> warnings = read.warnings;
  warnings.insert(warnings.end(), advice.warnings.begin(), advice.warnings.end());
  json["warnings"] = warnings;
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_advise(CLI::App& app) {
  CLI::App& c = *app.add_subcommand("advise", "Points → which method suits them, why, and the commands to run");
  auto file = std::make_shared<std::string>();
  c.add_option("input", *file, "Points, or a mesh or polygon soup")->type_name("FILE")->required();
  c.footer(std::string(kReadable) +
           "\n\nLooks at noise, density, sharp edges, borders, stray samples and normals. Writes nothing."
           "\n\nExamples:\n"
           "  sansmesh advise scan.ply\n"
           "  sansmesh advise scan.ply --json");
  return {&c, [file](Console& console) { run_advise(*file, console); }};
}

}  // namespace sansmesh::cli
