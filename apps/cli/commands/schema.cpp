// Command `schema`: prints all commands and options as data for programs.
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "cli/line/commands.h"
#include "cli/report/json.h"
#include "cli/report/standard_output.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/dynamics/body_integrator.h"
#include "sansmesh/flow/flow_integrator.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/model/surface_method.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::cli {
namespace {

/// Increases when a key is removed or changes its meaning, not when one is added.
constexpr int kSchemaVersion = 1;

/// Infinite ends are null.
Json json_of_range(const OptionRange& range) {
  const auto end = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  return {{"least", end(range.least)}, {"most", end(range.most)}, {"above", range.above}, {"below", range.below}};
}

const char* kind_word(const OptionEntry& option) {
  if (option.is_file()) return "file";
  if (!option.words.empty()) return "choice";
  switch (option.kind) {
    case OptionEntry::Kind::flag:
      return "flag";
    case OptionEntry::Kind::whole:
      return "whole";
    case OptionEntry::Kind::real:
      return option.numbers > 0 ? "numbers" : "real";
    case OptionEntry::Kind::text:
      break;
  }
  return "text";
}

Json json_of_option(const OptionEntry& option) {
  Json names = Json::array();
  for (const std::string& name : option.names) names.push_back(name);
  Json json = {{"names", names},
               {"kind", kind_word(option)},
               {"text", option.what},
               {"group", option.group},
               {"level", option.advanced ? "advanced" : "basic"}};
  if (!option.field.empty()) json["field"] = option.field;
  if (option.kind != OptionEntry::Kind::flag) json["value"] = option.value_name;
  if (option.row && !option.row->unit.empty()) json["unit"] = option.row->unit;
  if (!option.usual.empty()) json["usual"] = option.usual;
  if (option.row && !option.row->from_data.empty()) json["from_data"] = option.row->from_data;
  if (option.range) json["range"] = json_of_range(*option.range);
  if (!option.words.empty()) json["choices"] = option.words;
  if (option.numbers > 0) json["numbers"] = option.numbers;
  if (option.is_file() && !option.endings.empty()) json["endings"] = option.endings;
  if (option.implied) json["implied"] = *option.implied;
  if (!option.excludes.empty()) json["excludes"] = option.excludes;
  if (!option.old_names.empty()) json["old_names"] = option.old_names;
  if (option.is_file()) json["written"] = (option.file == OptionEntry::File::written);
  if (option.in_order) json["step"] = true;
  if (option.required) json["required"] = true;
  if (option.repeated || option.several) json["repeated"] = true;
  return json;
}

Json json_of_options(const CommandLine& line) {
  Json options = Json::array();
  for (const auto& option : line.options()) options.push_back(json_of_option(*option));
  return options;
}

Json json_of_commands(const CommandLine& tool) {
  Json list = Json::array();
  for (const CommandLine* const command : tool.with_subcommands())
    if (command->commands().empty())
      list.push_back({{"name", command->path()},
                      {"text", command->what()},
                      {"common", command->takes_common_options()},
                      {"options", json_of_options(*command)},
                      {"report", json_of_keys(command->announced())}});
  return list;
}

/// A registered method: name, summary, and the options that it uses.
template <class Method>
Json json_of_method(const Method& method) {
  return {{"name", method.name},
          {"text", method.summary},
          {"uses", std::vector<std::string_view>(method.uses.begin(), method.uses.end())}};
}

Json json_of_surfaces() {
  Json list = Json::array();
  for (const SurfaceMethod* const method : SurfaceMethod::registry().all()) {
    Json one = json_of_method(*method);
    for (const OptionRow& own : method->own) one["uses"].push_back(own.name);
    one["page"] = method->page;
    list.push_back(std::move(one));
  }
  return list;
}

Json json_of_volume_methods() {
  Json list = Json::array();
  for (const VolumeMethod* const method : VolumeMethod::registry().all()) {
    Json one = json_of_method(*method);
    one["grids"] = method->grids;
    list.push_back(std::move(one));
  }
  return list;
}

Json json_of_flow_integrators() {
  Json list = Json::array();
  for (const FlowIntegrator* const one : FlowIntegrator::registry().all())
    list.push_back({{"name", one->name},
                    {"text", one->summary},
                    {"order", one->order},
                    {"adaptive", one->adaptive},
                    {"reach", one->reach}});
  return list;
}

Json json_of_body_integrators() {
  Json list = Json::array();
  for (const BodyIntegrator* const one : BodyIntegrator::registry().all())
    list.push_back({{"name", one->name}, {"text", one->summary}, {"implicit", one->is_implicit}});
  return list;
}

Json json_of_formats() {
  constexpr std::pair<unsigned, const char*> kWords[] = {
      {kPoints, "points"},         {kMesh, "mesh"},       {kLines, "lines"},      {kVolume, "volume"},
      {kTetrahedra, "tetrahedra"}, {kPicture, "picture"}, {kFunction, "function"}};
  const auto words = [&](unsigned content) {
    Json list = Json::array();
    for (const auto& [bit, word] : kWords)
      if ((content & bit) != 0) list.push_back(word);
    return list;
  };
  Json list = Json::array();
  for (const FormatInfo* const format : formats()) {
    Json written = Json::array();
    for (const WrittenAs& as : format->written)
      if (as.content != 0) written.push_back({{"ending", as.ending}, {"holds", words(as.content)}});
    Json one = {{"name", format->name},
                {"endings", format->endings.empty() ? Json::array() : Json(parts_between(format->endings, ' '))},
                {"reads", words(format->reads)},
                {"writes", written}};
    if (!format->module.empty()) one["module"] = format->module;
    list.push_back(std::move(one));
  }
  return list;
}

}  // namespace

Command add_schema_command(CommandLine& app) {
  CommandLine& c = app.add_subcommand("schema", "Every command, option, surface and format as JSON, for programs");
  c.without_common_options();
  c.footer(
      "Each option has `names`, `kind`, `text`, `group` and `level` (basic or advanced); if applicable also `field` "
      "(in\n"
      "errors and bindings), `value`, `unit`, `usual` (its default value), `from_data`, `range`,\n"
      "`choices`, `numbers`, `endings`, `written` (of files), `implied`, `excludes`, `step` (applied in the order "
      "given),\n"
      "`old_names` (accepted with a warning), `required` and `repeated`. Ends of a range that are null are "
      "infinite;\n"
      "`above` and `below` exclude the ends. `report` has the keys of --json: `key` (\"places[].radius\" in a\n"
      "list), `kind`, `text`, `unit`, `choices`, and `optional` if it may be null. `surfaces` and `volume_methods`\n"
      "are the methods of --surface and, for volumes, of --method, with the fields that they use; `flow_integrators`\n"
      "those of --integrator for flows: their `order`, whether their steps follow the tolerance (`adaptive`), and "
      "the\n"
      "default step length (`reach`, share of the diagonal); `body_integrators` those of --integrator for bodies, and "
      "whether\n"
      "their steps solve systems (`implicit`); `formats` the files that are read and written, by ending.\n\n"
      "Examples:\n"
      "  sansmesh schema > schema.json");
  return {&c, [&app](Console&) {
            const Json json = {{"schema", kSchemaVersion},
                               {"version", SANSMESH_VERSION},
                               {"common", json_of_options(app)},
                               {"commands", json_of_commands(app)},
                               {"surfaces", json_of_surfaces()},
                               {"volume_methods", json_of_volume_methods()},
                               {"flow_integrators", json_of_flow_integrators()},
                               {"body_integrators", json_of_body_integrators()},
                               {"formats", json_of_formats()}};
            print_out(text_of(json));
          }};
}

}  // namespace sansmesh::cli
