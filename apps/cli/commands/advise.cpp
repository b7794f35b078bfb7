// sansmesh advise: which method suits these samples?
#include "sansmesh/advice.h"
#include "sansmesh/model/surface_method.h"

#include <fmt/core.h>

#include <string>
#include <utility>
#include <vector>

#include "cli/commands/advise_volume.h"
#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/flags.h"
#include "cli/line/option_groups.h"
#include "sansmesh/io.h"

namespace sansmesh::cli {
namespace {

/// Advice with the command that follows it.
struct ToldAdvice {
  Recommendation advice;
  std::vector<std::string> commands;
  std::string why;  ///< in words of the command line

  static const ReportSchema& schema();
};

constexpr ReportRow kToldAdvice[] = {
    reported<[](const ToldAdvice& r) { return aim_word(r.advice.aim); }>({.name = "aim", .text = "What it is for"}),
    reported<[](const ToldAdvice& r) { return r.advice.surface; }>({.name = "surface", .text = "Surface, by name"}),
    reported<&ToldAdvice::commands>({.text = "Commands that do it"}),
    reported<&ToldAdvice::why>({.text = "Reason for that"})};
constexpr ReportSchema kToldAdviceSchema{kToldAdvice};
const ReportSchema& ToldAdvice::schema() { return kToldAdviceSchema; }

/// For each aim, in the order of the enumerators.
constexpr const char* kCloudCommands[] = {
    "reconstruct {} -o surface.ply", "render {} -o picture.png", "curvature {} -o curved.ply --preview curved.png",
    "project {} -o smooth.ply",      "fit {} -o function.smf",   "deform {} --handles handles.json -o deformed.ply"};

/// The command that does what is recommended.
std::string command_of(const Recommendation& r, const CloudInput& of) {
  using Aim = Recommendation::Aim;
  std::string input = shell_words(of.files);
  if (!of.with.empty()) input += " --class " + shell_words({of.with});
  if (!of.without.empty()) input += " --without-class " + shell_words({of.without});
  std::string command = "sansmesh " + fmt::format(fmt::runtime(kCloudCommands[static_cast<std::size_t>(r.aim)]), input);
  if (r.aim == Aim::picture || (r.aim == Aim::mesh && r.surface != kPartitionSurface))
    command += " --surface " + r.surface;
  if (r.aim == Aim::points) command += " --method " + r.surface;
  if (r.sharp) command += " --sharp";
  if (r.remove_outliers) command += " --remove-outliers";
  return command;
}

/// `recommended`: the command whose options reasons may name.
void run_advise(const CloudInput& input, const CommandLine& recommended, Console& console) {
  ReadReport read;
  const PointSet points = input.read(console, read);
  const Advice advice = naming(input.name(), console, [&] { return advise(points, console.progress()); });
  console.note(input.name(), advice.notes);
  console.tell(input.told(read, points.size()), "input");
  console.tell(advice);
  std::vector<ToldAdvice> told;
  told.reserve(advice.recommendations.size());
  for (const Recommendation& r : advice.recommendations)
    told.push_back({r, {command_of(r, input)}, in_flags(r.why, recommended)});
  console.tell(told, "recommendations");

  console.say(fmt::format("{}: {}", input.name(), read.format));
  console.say(summary_of(advice));
  for (const ToldAdvice& one : told) {
    console.say(aim_word(one.advice.aim), one.why, 10);
    console.say("  $ " + one.commands[0]);
  }
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
  c.tells({told<ReadCloud>("input"), told<Advice>(), told_list<ToldAdvice>("recommendations"),
           told<ReadVolume>("input"), told<VolumeAdvice>(), told_list<ToldCommand>("commands")});
  return {&c, [input, volume, &app](Console& console) {
            const bool named = names_volume(input->files);
            if (!named && !volume->read.raw.given()) {
              require(volume->array.empty(),
                      "--array is of volumes: `advise data FILE` takes points for samples of one");
              return run_advise(*input, app.subcommand("reconstruct"), console);
            }
            volume->files = input->files;
            run_volume_advise(*volume, console);
          }};
}

}  // namespace sansmesh::cli
