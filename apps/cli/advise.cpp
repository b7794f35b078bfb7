// sansmesh advise: which method suits these samples?
#include "sansmesh/advise/advise.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "cloud_input.h"
#include "commands.h"
#include "flags.h"
#include "option_groups.h"
#include "sansmesh/advise/traits.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"
#include "sansmesh/points/noise.h"
#include "volume_input.h"

namespace sansmesh::cli {
namespace {

Json to_json(const CloudTraits& t) {
  return {{"samples", t.samples},
          {"diagonal", t.diagonal},
          {"spacing", t.spacing},
          {"noise", t.noise},
          {"noise_known", t.noise_known},
          {"most_noise", t.most_noise},
          {"step", t.step},
          {"density_ratio", t.density_ratio},
          {"evenness", t.evenness},
          {"outliers", t.outliers},
          {"creases", t.creases_known ? Json(t.creases) : Json()},
          {"crease_length", t.creases_known ? Json(t.crease_length) : Json()},
          {"borders", t.borders},
          {"border_length", t.border_length},
          {"open", t.open},
          {"faces", t.faces},
          {"open_edges", t.faces ? Json(t.open_edges) : Json()},
          {"open_loops", t.faces ? Json(t.open_loops) : Json()},
          {"normals", judge_normals(t.orientation).words},
          {"orientation", judge_normals(t.orientation).json}};
}

/// A file's name as a shell takes it for one word.
std::string quoted(const std::string& name) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) || c >= 0x80 || std::string("_-./+,:@%=").find(static_cast<char>(c)) != std::string::npos;
  };
  if (!name.empty() && std::all_of(name.begin(), name.end(), plain)) return name;
  std::string text = "'";
  for (const char c : name) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// The command that does what is recommended.
std::string command_of(const Recommendation& r, const CloudInput& of) {
  using Aim = Recommendation::Aim;
  const std::string name = surface_method_info(r.surface).name;
  std::string input;
  for (const std::string& file : of.files) input += (input.empty() ? "" : " ") + quoted(file);
  if (!of.with.empty()) input += " --class " + quoted(of.with);
  if (!of.without.empty()) input += " --without-class " + quoted(of.without);
  std::string command;
  switch (r.aim) {
    case Aim::mesh:
      command = "sansmesh reconstruct " + input + " -o surface.ply";
      if (r.surface != SurfaceMethod::partition) command += " --surface " + name;
      break;
    case Aim::picture:
      command = "sansmesh render " + input + " -o picture.png --surface " + name;
      break;
    case Aim::curvature:
      return "sansmesh curvature " + input + " -o curved.ply --preview curved.png";
    case Aim::points:
      command = "sansmesh project " + input + " -o smooth.ply --method " + name;
      break;
  }
  if (r.sharp) command += " --sharp";
  if (r.remove_outliers) command += " --remove-outliers";
  return command;
}

/// `recommended`: the command whose options reasons may name.
void run_advise(const CloudInput& input, const CommandLine& recommended, Console& console) {
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  const PointSet points = input.read(console, read);
  Advice advice;
  try {
    advice = advise(points, progress);
  } catch (const DataError& error) {
    throw FileError(input.name(), error.what());
  }
  progress.finish();
  console.warn(input.name(), advice.warnings);

  const CloudTraits& t = advice.traits;
  console.say(fmt::format("{}: {}, spacing {}, noise {} ({})", input.name(), counted(t.samples, "sample"),
                          length(t.spacing), noise_words({t.noise, t.most_noise, t.noise_known, t.step}, t.spacing),
                          read.format));
  for (const std::string& finding : advice.findings) console.say("  " + finding);
  for (const Recommendation& r : advice.recommendations) {
    console.say(fmt::format("{:<10}{}", aim_word(r.aim), in_flags(r.why, recommended)));
    console.say("  $ " + command_of(r, input));
  }

  Json json = {{"input", input.json(read, points.size())}, {"traits", to_json(t)}, {"findings", advice.findings}};
  json["recommendations"] = Json::array();
  for (const Recommendation& r : advice.recommendations)
    json["recommendations"].push_back({{"aim", aim_word(r.aim)},
                                       {"surface", surface_method_info(r.surface).name},
                                       {"commands", std::vector{command_of(r, input)}},
                                       {"why", in_flags(r.why, recommended)}});
  console.say_json(json);
  console.print_timings();
}

/// What has to be said of a raw file again.
std::string raw_words(const VolumeReadOptions& read) {
  std::string words;
  if (read.raw) {
    const RawLayout& r = *read.raw;
    words = fmt::format(" --dims {}x{}x{} --type {}", r.dims[0], r.dims[1], r.dims[2], name_of(r.type));
    if (r.spacing != Vec3{1, 1, 1}) words += fmt::format(" --spacing {},{},{}", r.spacing.x, r.spacing.y, r.spacing.z);
    if (r.big_endian) words += " --big-endian";
  }
  if (read.time_step > 0) words += fmt::format(" --step {}", read.time_step);
  return words;
}

/// What suits a volume, and the commands.
void run_volume_advise(const VolumeInput& input, Console& console) {
  OpenVolume volume(input, console);
  const VolumeTraits& t = volume.traits();
  const ReconstructionChoice& suited = volume.suited();
  const auto samples = volume.samples();
  console.progress().finish();
  const auto percent = [](double share) { return fmt::format("{:.2g} %", 100 * share); };
  std::string files;
  for (const std::string& file : input.files) files += (files.empty() ? "" : " ") + quoted(file);
  files += raw_words(input.read);
  // As it was given; of a vector its magnitude, which surfaces and pictures can be of.
  const DatasetArray& of = volume.dataset().array(volume.choice().array);
  const ArrayChoice& choice = volume.choice();
  const bool vector = of.components > 1 && !choice.component;
  const std::string array = " --array " + quoted(vector                ? of.name + ":magnitude"
                                                 : input.array.empty() ? of.name
                                                                       : input.array);
  double middle = 0;
  if (vector) {
    for (std::size_t i = 0; i < samples->size(); ++i) middle += volume.sample_value(i);
    middle /= static_cast<double>(samples->size());
  } else {
    const std::size_t c = choice.component.value_or(0);
    middle = 0.5 * (of.least[c] + of.most[c]);
  }

  console.say(fmt::format("{}: {} of {} ({})", input.name(), counted(t.samples, "sample"), volume.array_name(),
                          samples->facts.grid));
  console.say(
      fmt::format("  left out, a sample is missed by {} of the range by its neighbours' mean, {} by planes, {} by "
                  "parabolas, {} by cubics",
                  percent(t.left_out[0]), percent(t.left_out[1]), percent(t.left_out[2]), percent(t.left_out[3])));
  console.say(
      fmt::format("  noise at most {} of the range; steps at {} of the samples", percent(t.noise), percent(t.steps)));
  console.say(fmt::format("{:<16}{}, since it is {}", "reconstruction", info_of(suited.method).name, suited.why));
  const std::vector<std::pair<const char*, std::string>> commands{
      {"values", fmt::format("sansmesh volume probe {}{} --points where.csv -o values.csv", files, array)},
      {"grid", fmt::format("sansmesh volume resample {}{} -o resampled.vti", files, array)},
      {"surface", fmt::format("sansmesh volume isosurface {}{} --value {:.4g} -o surface.ply", files, array, middle)},
      {"picture", fmt::format("sansmesh volume render {}{} -o picture.png", files, array)}};
  Json json = {{"input", volume.json()}, {"array", volume.choice().array}, {"samples", t.samples}};
  json["left_out"] = t.left_out;
  json["left_out_rms"] = t.left_out_rms;
  json["noise"] = t.noise;
  json["steps"] = t.steps;
  json["resolved"] = t.resolved();
  json["method"] = info_of(suited.method).name;
  json["why"] = suited.why;
  json["commands"] = Json::array();
  for (const auto& [aim, command] : commands) {
    console.say(fmt::format("{:<16}$ {}", aim, command));
    json["commands"].push_back({{"aim", aim}, {"command", command}});
  }
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_advise(CommandLine& app) {
  CommandLine& c =
      app.add_subcommand("advise", "Points or a volume → which method suits them, why, and the commands to run");
  auto input = std::make_shared<CloudInput>();
  auto volume = std::make_shared<VolumeInput>();
  add_cloud_input(c, *input, "Points, a mesh or polygon soup, or a volume; `data FILE` takes points for its samples");
  c.add_option("--array", volume->array, "Of a volume: the array that is looked at [a scalar]").type_name("NAME");
  add_raw_options(c, volume->read);
  c.footer(
      std::string(kReadable) + "\n" + kReadableVolumes +
      "\n\nOf points: looks at noise, density, sharp edges, borders, whether the surface is open, stray samples and "
      "normals. Of volumes: at grid, resolution, noise and steps. Writes nothing."
      "\n\nExamples:\n"
      "  sansmesh advise scan.ply\n"
      "  sansmesh advise scan.ply --json\n"
      "  sansmesh advise fire.vtu --array t");
  return {&c, [input, volume, &app](Console& console) {
            const bool named = names_volume(input->files);
            if (!named && !volume->read.raw) {
              require(volume->array.empty(),
                      "--array is of volumes: `advise data FILE` takes points for samples of one");
              return run_advise(*input, app.subcommand("reconstruct"), console);
            }
            volume->files = input->files;
            run_volume_advise(*volume, console);
          }};
}

}  // namespace sansmesh::cli
