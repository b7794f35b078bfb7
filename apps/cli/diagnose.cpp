// sansmesh diagnose: where a function should not be trusted without a look.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "commands.h"
#include "option_groups.h"
#include "place_pictures.h"
#include "sansmesh/core/error.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/function/diagnose_function.h"
#include "sansmesh/function/edit_script.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/io/io.h"

namespace sansmesh::cli {
namespace {

/// Pictures of a sheet, pixels, and how many it may have.
constexpr int kTileWidth = 360, kTileHeight = 270;
constexpr std::size_t kMostOnSheet = 1600;

struct DiagnoseArguments {
  std::string input, script, preview, pictures;
  bool separate = false;
  PictureArguments picture;
  DiagnoseOptions options;
};

/// To a hundredth of its radius, however far from the origin it is.
std::string where(const SuspiciousPlace& p) {
  const int digits = index_in<int>(std::ceil(2 - std::log10(std::max(1e-300, p.radius))), 0, 12);
  return fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", p.position.x, digits, p.position.y, digits, p.position.z, digits);
}

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

/// A place as the list has it: kinds in their order, numbers from 1 on.
struct ListedPlace {
  const SuspiciousPlace* place;
  std::size_t number;
  std::optional<std::size_t> step;  ///< of the script, from 1 on
};

std::vector<ListedPlace> listed_places(const Diagnosis& d) {
  std::vector<ListedPlace> listed;
  std::size_t steps = 0;
  for (const SuspiciousPlace& p : d.places) {
    listed.push_back({&p, 0, {}});
    if (p.edit) listed.back().step = ++steps;
  }
  std::stable_sort(listed.begin(), listed.end(),
                   [](const ListedPlace& x, const ListedPlace& y) { return x.place->kind < y.place->kind; });
  for (std::size_t i = 0; i < listed.size(); ++i) listed[i].number = i + 1;
  return listed;
}

/// One for each place, in the order of the list.
std::vector<Image> pictures_of(const Diagnosis& d, RenderOptions options, bool separate, Progress& progress) {
  if (!separate) {
    if (d.places.size() > kMostOnSheet)
      throw ArgumentError(fmt::format("{} are too many for one sheet: --separate, or fewer --places",
                                      counted(d.places.size(), "place")));
    options.width = kTileWidth, options.height = kTileHeight;
  }
  const PlacePictures views(d);
  std::vector<Image> pictures;
  for (const ListedPlace& listed : listed_places(d)) {
    const SuspiciousPlace& p = *listed.place;
    pictures.push_back(
        views.of(p, fmt::format("{}  {}\n{}", listed.number, suspicion_name(p.kind), worst_of(p)), options, progress));
  }
  return pictures;
}

Json to_json(const ListedPlace& listed) {
  const SuspiciousPlace& p = *listed.place;
  return {{"number", listed.number},
          {"kind", suspicion_name(p.kind)},
          {"at", {p.position.x, p.position.y, p.position.z}},
          {"normal", {p.normal.x, p.normal.y, p.normal.z}},
          {"radius", p.radius},
          {"fits", p.supports},
          {"worst", p.worst},
          {"edit", p.edit.has_value()},
          {"step", listed.step ? Json(*listed.step) : Json()}};
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
  if (!a.pictures.empty()) check_writable(a.pictures, "image");
  require(!a.separate || !a.pictures.empty(), "--separate is for --pictures FILE.png");
  Progress& progress = console.progress();
  progress.begin("read");
  const SurfaceFunction function = read_function(a.input);
  Diagnosis d;
  Image picture;
  std::vector<Image> pictures;
  try {
    d = diagnose_function(function, a.options, progress);
    if (!a.preview.empty()) picture = render_mesh(d.mesh, picture_options, progress);
    if (!a.pictures.empty()) pictures = pictures_of(d, picture_options, a.separate, progress);
  } catch (const DataError& error) {
    throw FileError(a.input, error.what());
  }
  progress.begin("write");
  const std::vector<Edit> edits = d.edits();
  if (!a.script.empty()) write_text(a.script, edit_script(edits));
  if (!a.preview.empty()) a.picture.write(a.preview, picture, picture_options);
  if (a.separate)
    for (std::size_t i = 0; i < pictures.size(); ++i) write_image(frame_name(a.pictures, i + 1), pictures[i]);
  else if (!pictures.empty())
    write_image(a.pictures, contact_sheet(pictures));
  progress.finish();

  const PartitionReport& r = function.field.report();
  console.say(fmt::format("{}: {}; largest gradient around the surface {:.2f}", a.input,
                          counted(r.functions, "local fit"), d.largest_gradient));
  Json json = {{"input", {{"file", a.input}, {"fits", r.functions}}},
               {"error_above", d.error_above},
               {"largest_gradient", d.largest_gradient}};
  json["places"] = Json::array();
  const std::vector<ListedPlace> listed = listed_places(d);
  auto next = listed.begin();
  for (std::size_t k = 0; k < kSuspicions; ++k) {
    const auto kind = static_cast<Suspicion>(k);
    json["found"][suspicion_name(kind)] = d.found[k];
    const std::string extra = kind == Suspicion::high_error ? fmt::format(" (above {})", length(d.error_above)) : "";
    console.say(fmt::format("{:<16}{}{}", suspicion_name(kind),
                            d.found[k] == 0 ? std::string("nowhere") : counted(d.found[k], "place"), extra));
    std::size_t shown = 0;
    for (; next != listed.end() && next->place->kind == kind; ++next, ++shown) {
      const SuspiciousPlace& p = *next->place;
      const std::string step = !a.script.empty() && next->step ? fmt::format("; step {}", *next->step) : "";
      console.say(fmt::format("{:>4} at {}, radius {}: {}, {}{}", next->number, where(p), length(p.radius), worst_of(p),
                              counted(p.supports, "fit"), step));
      json["places"].push_back(to_json(*next));
    }
    if (shown < d.found[k])
      console.say(fmt::format("     and {} more: --places {} lists all", grouped(d.found[k] - shown), d.found[k]));
  }
  if (!a.script.empty()) {
    console.say(fmt::format("{}: {} to try with `sansmesh edit`", a.script, counted(edits.size(), "edit")));
    json["script"] = {{"file", a.script}, {"edits", edits.size()}};
  }
  if (!a.preview.empty())
    console.say(fmt::format("{}: yellow low coverage, orange high error, red extra sheets, violet steep", a.preview));
  if (!a.pictures.empty()) {
    console.say(pictures.empty() ? a.pictures + ": not written, there is no place to look at"
                : a.separate     ? fmt::format("{} to {}: the places, by their numbers", frame_name(a.pictures, 1),
                                               frame_name(a.pictures, pictures.size()))
                                 : a.pictures + ": the places, by their numbers");
    json["pictures"] = Json::array();
    for (std::size_t i = 0; i < pictures.size() && a.separate; ++i)
      json["pictures"].push_back(frame_name(a.pictures, i + 1));
    if (!a.separate && !pictures.empty()) json["pictures"].push_back(a.pictures);
  }
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
  c.add_option("--pictures", a->pictures,
               "Look at each place from outside, ringed, with its number in the list: all on one sheet, a PNG")
      .type_name("FILE");
  c.add_flag("--separate", a->separate, "Instead of the sheet a file for each place: FILE_001.png, FILE_002.png, …");
  add_picture_options(c, a->picture);
  add_wireframe_options(c, a->picture.options);
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
      "  sansmesh diagnose scan.smf --preview scan.png --pictures places.png --script edits.json\n"
      "  sansmesh edit scan.smf --script edits.json -o mended.smf");
  return {&c, [a](Console& console) { run_diagnose(*a, console); }};
}

}  // namespace sansmesh::cli
