// Command `advise`: recommends methods for samples or volumes.
#include "sansmesh/advice.h"

#include <fmt/core.h>

#include <string>
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
struct AdviceReport {
  Recommendation advice;
  std::vector<std::string> commands;
  std::string why;  ///< with flags of the command line

  static const ReportSchema& schema();
};

constexpr ReportRow kAdviceReport[] = {
    reported<[](const AdviceReport& r) { return aim_word(r.advice.aim); }>({.name = "aim", .text = "Purpose"}),
    reported<[](const AdviceReport& r) { return r.advice.surface; }>(
        {.name = "surface", .text = "Name of the surface"}),
    reported<&AdviceReport::commands>({.text = "Commands"}), reported<&AdviceReport::why>({.text = "Reason"})};
constexpr ReportSchema kAdviceReportSchema{kAdviceReport};
const ReportSchema& AdviceReport::schema() { return kAdviceReportSchema; }

/// Commands in the order of the enumerators of the aim.
constexpr const char* kCloudCommands[] = {
    "reconstruct {} -o surface.ply", "render {} -o picture.png", "curvature {} -o curved.ply --preview curved.png",
    "project {} -o smooth.ply",      "fit {} -o function.smf",   "deform {} --handles handles.json -o deformed.ply"};

/// The recommended command.
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

/// `recommended`: the command whose options appear in reasons.
void run_advise(const CloudInput& input, const CommandLine& recommended, Console& console) {
  ReadReport read;
  const PointSet points = input.read(console, read);
  const Advice advice = naming(input.name(), console, [&] { return advise(points, console.progress()); });
  console.note(input.name(), advice.notes);
  console.report(input.report(read, points.size()), "input");
  console.report(advice);
  std::vector<AdviceReport> reports;
  reports.reserve(advice.recommendations.size());
  for (const Recommendation& r : advice.recommendations)
    reports.push_back({r, {command_of(r, input)}, in_flags(r.why, recommended)});
  console.report(reports, "recommendations");

  console.print(fmt::format("{}: {}", input.name(), read.format));
  console.print(summary_of(advice));
  for (const AdviceReport& one : reports) {
    console.print(aim_word(one.advice.aim), one.why, 10);
    console.print("  $ " + one.commands[0]);
  }
}

}  // namespace

Command add_advise(CommandLine& app) {
  CommandLine& c =
      app.add_subcommand("advise", "Points or a volume → which method suits them, why, and the commands to run");
  auto input = std::make_shared<CloudInput>();
  auto volume = std::make_shared<VolumeInput>();
  add_cloud_input(c, *input, "Points, a mesh or polygon soup, or a volume; `data FILE` takes points for its samples");
  c.add_option("--array", volume->array, "For a volume: the array to examine [a scalar]").type_name("NAME");
  add_raw_options(c, volume->read);
  c.footer(std::string(kReadable) + "\n" + kReadableVolumes +
           "\n\nFor points, it examines noise, density, sharp edges, borders, openness, stray samples and normals; for "
           "volumes grid, resolution, noise and steps. It writes nothing."
           "\n\nExamples:\n"
           "  sansmesh advise scan.ply\n"
           "  sansmesh advise scan.ply --json\n"
           "  sansmesh advise fire.vtu --array t");
  c.announce({report_of<ReadCloud>("input"), report_of<Advice>(), reports_of<AdviceReport>("recommendations"),
              report_of<ReadVolume>("input"), report_of<VolumeAdvice>(), reports_of<RecommendedCommand>("commands")});
  return {&c, [input, volume, &app](Console& console) {
            const bool named = is_volume_input(input->files);
            if (!named && !volume->read.raw.given()) {
              require(volume->array.empty(),
                      "--array is for volumes: `advise data FILE` treats points as samples of one");
              return run_advise(*input, *app.subcommand("reconstruct"), console);
            }
            volume->files = input->files;
            run_volume_advise(*volume, console);
          }};
}

}  // namespace sansmesh::cli
