#include "cli/commands/advise_volume.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "cli/line/flags.h"
#include "sansmesh/volumes.h"

namespace sansmesh::cli {
namespace {

std::string shell_word(const std::string& name) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) || c >= 0x80 || std::string("_-./+,:@%=").find(static_cast<char>(c)) != std::string::npos;
  };
  if (!name.empty() && std::all_of(name.begin(), name.end(), plain)) return name;
  std::string text = "'";
  for (const char c : name) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// The given options of reading, as text of a command line.
std::string read_words(const VolumeReadOptions& read) {
  std::string words;
  const std::vector<std::string_view> set = options_set(read);
  for_each_option(VolumeReadOptions::schema(), &read, [&](const OptionRow& row, const void* owner) {
    if (std::find(set.begin(), set.end(), row.name) == set.end()) return;
    const OptionValue value = option_value(row, owner);
    const auto* const texts = std::get_if<std::vector<std::string>>(&value);
    for (std::string word : texts ? *texts : std::vector<std::string>{option_words(value)}) {
      if (row.kind == OptionKind::numbers) std::erase(word, ' ');
      words += " " + flag_of_name(row.name) + (row.kind == OptionKind::flag ? "" : " " + shell_word(word));
    }
  });
  return words;
}

/// Commands in the order of the enumerators of the aim.
constexpr const char* kVolumeCommands[] = {"volume probe {files}{array} --points where.csv -o values.csv",
                                           "volume resample {files}{array} -o resampled.vti",
                                           "volume {surface} {files}{array} --value {value:.4g} -o surface.ply",
                                           "volume surface {files}{array} --high-gradient -o border.ply",
                                           "volume render {files}{array} -o picture.png",
                                           "flow lines {files}{flow} -o lines.vtp --preview lines.png",
                                           "flow surface {files}{flow}{seeds} -o flow.ply",
                                           "flow render {files}{flow}{seeds} -o flow.png",
                                           "deform {files}{array} --handles handles.json -o deformed.png",
                                           "simulate {files} --animation moved.png"};

/// The recommended command; `files` includes the options of reading.
std::string volume_command(const VolumeRecommendation& r, const VolumeAdvice& advice, const std::string& files,
                           bool several) {
  const bool series = advice.offer.steps > 1;
  std::string flow, seeds;
  // Several files may be steps in time or blocks, which cannot be distinguished.
  if (!advice.flow.empty() && !(series && several))
    flow = " --array " + shell_words({advice.flow}) + (series ? " --unsteady" : "");
  if (advice.seeds) {
    const auto& [a, b] = *advice.seeds;
    seeds =
        fmt::format(" --seeds 'line({:.4g},{:.4g},{:.4g}, {:.4g},{:.4g},{:.4g}, 256)'", a.x, a.y, a.z, b.x, b.y, b.z);
  }
  if (!series) seeds += " --direction both";
  return "sansmesh " +
         fmt::format(fmt::runtime(kVolumeCommands[static_cast<std::size_t>(r.aim)]), fmt::arg("files", files),
                     fmt::arg("array", advice.array.empty() ? "" : " --array " + shell_words({advice.array})),
                     fmt::arg("surface", r.by_samples ? "surface" : "isosurface"), fmt::arg("value", advice.value),
                     fmt::arg("flow", flow), fmt::arg("seeds", seeds));
}

}  // namespace

const ReportSchema& RecommendedCommand::schema() {
  static constexpr ReportRow rows[] = {reported<&RecommendedCommand::aim>({.text = "Purpose"}),
                                       reported<&RecommendedCommand::why>({.text = "Reason"}),
                                       reported<&RecommendedCommand::command>({.text = "Command"})};
  return report_schema<rows>();
}

std::string shell_words(const std::vector<std::string>& names) {
  std::string words;
  for (const std::string& name : names) words += (words.empty() ? "" : " ") + shell_word(name);
  return words;
}

void run_volume_advise(const VolumeInput& input, Console& console) {
  VolumeInput any = input;
  any.bare = true;
  VolumeModel volume = any.open(console);
  const VolumeAdvice advice = advise(volume, console.progress());
  console.report(input.report(volume, console.progress()), "input");
  console.report(advice);
  const std::string files = shell_words(input.files) + read_words(input.read);
  std::vector<RecommendedCommand> reports;
  reports.reserve(advice.recommendations.size());
  for (const VolumeRecommendation& r : advice.recommendations)
    reports.push_back({aim_word(r.aim), r.why, volume_command(r, advice, files, input.files.size() > 1)});
  console.report(reports, "commands");

  console.print(fmt::format("{}: {}", volume.name(), volume.format()));
  console.print(summary_of(advice));
  for (const RecommendedCommand& one : reports) {
    console.print(one.aim, one.why);
    console.print("  $ " + one.command);
  }
}

}  // namespace sansmesh::cli
