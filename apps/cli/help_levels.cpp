#include "help_levels.h"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::cli {
namespace {

/// Options of a command, without their dashes, blanks between them.
struct OptionsOfCommand {
  std::string_view command, options;
};

/// Options that people use first, of commands that have more than twenty besides those of views. The other commands
/// show all.
constexpr OptionsOfCommand kFirst[] = {
    {"reconstruct",
     "output preview class components open closed fill-holes trim faces normals orient-by align mesh-error triangles "
     "no-colors confidence surface sharp ascii remove-outliers"},
    {"render",
     "output as-one class color opacity name color-by color-range no-bar unit surface sharp splats quick frames "
     "wireframe lines accessibility background flat"},
    {"project",
     "output onto method point-count class without-class smoothing bandwidth weights sharp remove-outliers radius "
     "repulsion lop-steps most-steps tolerance ascii"},
    {"mesh",
     "output preview box components fill-holes trim confidence no-confidence quality mesh-error triangles no-enhance "
     "no-colors block-depth wireframe ascii"},
    {"compare",
     "output preview align from find-scale within color-range max-distance skip-border on refine histogram class "
     "without-class unit wireframe ascii"},
    {"deform",
     "output handles handles-from handle-count vertices map kind alpha frames cut refine resolution cell plane array "
     "size preset iso draw-handles draw-folds"},
    {"simulate",
     "output animation forces energies embedded-mesh fixed model stiffness young poisson damping density unit duration "
     "fps frames embedded-volume preset background ascii"},
    {"convert",
     "output class transform translate center rotate scale up unit to-unit box point-spacing point-count every keep "
     "drop weld flip split ascii"},
    {"volume fit", "output array all-arrays method degree radius time-step fill-value dims type spacing"},
    {"volume probe", "output at points array method degree radius time-step fill-value dims type spacing"},
    {"volume resample",
     "output size box gradients outside nan array method degree radius time-step fill-value dims type spacing"},
    {"volume isosurface",
     "output preview value array method closed carry components mesh-error triangles no-enhance cell unsteady frames "
     "times time-step fill-value dims type ascii"},
    {"volume render",
     "output array method preset opacity-factor iso transfer clip opacity-by baked mesh points axes label unit no-bar "
     "title background frames time-step"},
    {"volume surface",
     "output points-output point-spacing value high-gradient array method color-by color-range sharp quick smoothing "
     "least-gradient components mesh-error triangles background frames no-bar ascii"},
    {"flow lines",
     "output preview seeds kind direction duration length start interval unsteady times array carry color-by "
     "tube-radius background integrator step-length tolerance ascii"},
    {"flow surface",
     "output preview seeds kind particles direction duration length start sweep unsteady times array alpha integrator "
     "step-length tolerance wireframe ascii"},
    {"flow render",
     "output seeds kind particles duration length unsteady array color-by no-streaks streak-length opacity arrows "
     "frames turn volume-array preset iso mesh background"}};

/// Options that choose among variants of the sources, for those who compare with them.
constexpr std::string_view kOfProjections = "normal reference-plane polynomial flow diffusion diffusion-threshold tau";
constexpr std::string_view kOfReconstructions = "spherical no-spherical robust no-robust b c";
constexpr OptionsOfCommand kOfSources[] = {
    {"reconstruct", "fit threshold coverage mesher displacement"},
    {"fit", "fit threshold coverage"},
    {"mesh", "mesher displacement"},
    {"render", "rays"},
    {"curvature", "tau"},
    {"volume surface", "global-maximum all-sheets predictor-only corrector-only alternating line-search"},
    {"flow surface", "interpolated"},
    {"flow render", "interpolated splats"}};

std::vector<std::string> flags_in(std::string_view words) {
  std::vector<std::string> flags;
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    flags.push_back("--" + std::string(words.substr(0, end)));
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return flags;
}

std::string_view words_of(std::span<const OptionsOfCommand> table, std::string_view command) {
  for (const OptionsOfCommand& entry : table)
    if (entry.command == command) return entry.options;
  return {};
}

/// Under their heading, those that the command has.
void set_apart(const CommandLine& command, std::string_view options) {
  for (const std::string& flag : flags_in(options))
    for (const auto& option : command.options())
      if (option->name() == flag) option->group = kSourcesGroup, option->advanced = true;
}

}  // namespace

void arrange_help(std::span<const Command> commands) {
  for (const Command& entry : commands) {
    const CommandLine& command = *entry.line;
    const std::string name = command.full_name().substr(command.root().name().size() + 1);
    const std::vector<std::string> first = flags_in(words_of(kFirst, name));
    for (const std::string& flag : first)
      if (!command.find(flag)) throw std::logic_error(fmt::format("{} has no option {}", name, flag));
    for (const auto& option : command.options()) {
      const bool listed = std::find(first.begin(), first.end(), option->name()) != first.end();
      option->advanced = !option->positional() && (option->group == kViewGroup || (!first.empty() && !listed));
    }
    set_apart(command, words_of(kOfSources, name));
    if (command.has("--surface") || name == "project") set_apart(command, kOfProjections);
    if (name.starts_with("volume ") || name.starts_with("flow ")) set_apart(command, kOfReconstructions);
  }
}

}  // namespace sansmesh::cli
