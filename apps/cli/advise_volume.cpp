#include "advise_volume.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "sansmesh/io.h"
#include "sansmesh/volumes.h"

namespace sansmesh::cli {
namespace {

using VolumeAim = VolumeRecommendation::Aim;

/// What has to be said of a raw file again.
std::string raw_words(const VolumeReadOptions& read) {
  std::string words;
  if (read.raw.given()) {
    const RawLayout& r = read.raw;
    words = fmt::format(" --dims {}x{}x{} --type {}", r.dims[0], r.dims[1], r.dims[2], name_of(r.type));
    if (r.spacing != Vec3{1, 1, 1}) words += fmt::format(" --spacing {},{},{}", r.spacing.x, r.spacing.y, r.spacing.z);
    if (r.big_endian) words += " --big-endian";
  }
  if (read.time_step > 0) words += fmt::format(" --time-step {}", read.time_step);
  if (!read.fill.usual) words += " --fill-value none";
  for (const double v : read.fill.values) words += fmt::format(" --fill-value {}", v);
  return words;
}

std::string share_words(double share) { return fmt::format("{:.2g} %", 100 * share); }

std::string seeds_words(const std::array<Vec3, 2>& ends) {
  const Vec3 &a = ends[0], &b = ends[1];
  return fmt::format("--seeds 'line({:.4g},{:.4g},{:.4g}, {:.4g},{:.4g},{:.4g}, 256)'", a.x, a.y, a.z, b.x, b.y, b.z);
}

/// The command that makes what is recommended; `files` with all that has to be said of them again.
std::string volume_command(const VolumeRecommendation& r, const VolumeAdvice& advice, const std::string& files,
                           bool several) {
  const bool series = advice.offer.steps > 1;
  const std::string array = advice.array.empty() ? "" : " --array " + shell_word(advice.array);
  std::string flow;
  // Several files may be steps in time or blocks: nothing tells which.
  if (!advice.flow.empty() && !(series && several))
    flow = fmt::format(" --array {}{}", shell_word(advice.flow), series ? " --unsteady" : "");
  const std::string seeds = advice.seeds ? seeds_words(*advice.seeds) : "";
  const char* const both = series ? "" : " --direction both";
  switch (r.aim) {
    case VolumeAim::values:
      return fmt::format("sansmesh volume probe {}{} --points where.csv -o values.csv", files, array);
    case VolumeAim::grid:
      return fmt::format("sansmesh volume resample {}{} -o resampled.vti", files, array);
    case VolumeAim::surface:
      return fmt::format("sansmesh volume {} {}{} --value {:.4g} -o surface.ply",
                         r.by_samples ? "surface" : "isosurface", files, array, advice.value);
    case VolumeAim::border:
      return fmt::format("sansmesh volume surface {}{} --high-gradient -o border.ply", files, array);
    case VolumeAim::picture:
      return fmt::format("sansmesh volume render {}{} -o picture.png", files, array);
    case VolumeAim::lines:
      return fmt::format("sansmesh flow lines {}{} -o lines.vtp --preview lines.png", files, flow);
    case VolumeAim::flow_surface:
      return fmt::format("sansmesh flow surface {}{} {}{} -o flow.ply", files, flow, seeds, both);
    case VolumeAim::flow_picture:
      return fmt::format("sansmesh flow render {}{} {}{} -o flow.png", files, flow, seeds, both);
    case VolumeAim::deformation:
      return fmt::format("sansmesh deform {}{} --handles handles.json -o deformed.png", files, array);
    case VolumeAim::forces:
      return fmt::format("sansmesh simulate {} --animation moved.png", files);
  }
  return {};
}

void say_traits(const VolumeTraits& t, Console& console) {
  console.say(fmt::format(
      "  left out, a sample is missed by {} of the range by its neighbours' mean, {} by planes, {} by "
      "parabolas, {} by cubics",
      share_words(t.left_out[0]), share_words(t.left_out[1]), share_words(t.left_out[2]), share_words(t.left_out[3])));
  console.say(fmt::format("  noise at most {} of the range; steps at {} of the samples", share_words(t.noise),
                          share_words(t.steps)));
}

}  // namespace

const ReportSchema& ToldCommand::schema() {
  static constexpr ReportRow rows[] = {reported<&ToldCommand::aim>({.text = "What it is for"}),
                                       reported<&ToldCommand::why>({.text = "Reason for that"}),
                                       reported<&ToldCommand::command>({.text = "Command that does it"})};
  static constexpr ReportSchema schema{rows};
  return schema;
}

std::string shell_word(const std::string& name) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) || c >= 0x80 || std::string("_-./+,:@%=").find(static_cast<char>(c)) != std::string::npos;
  };
  if (!name.empty() && std::all_of(name.begin(), name.end(), plain)) return name;
  std::string text = "'";
  for (const char c : name) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

void run_volume_advise(const VolumeInput& input, Console& console) {
  VolumeInput any = input;
  any.bare = true;
  VolumeModel volume = any.open(console);
  const VolumeAdvice advice = advise(volume, console.progress());
  const VolumeOffer& offer = advice.offer;

  console.tell(input.told(volume, console.progress()), "input");
  console.tell(advice);
  std::string files;
  for (const std::string& file : input.files) files += (files.empty() ? "" : " ") + shell_word(file);
  files += raw_words(input.read);
  std::vector<ToldCommand> told;
  for (const VolumeRecommendation& r : advice.recommendations)
    told.push_back({aim_word(r.aim), r.why, volume_command(r, advice, files, input.files.size() > 1)});
  console.tell(told, "commands");

  const VolumeFacts& facts = volume.samples(console.progress())->facts;
  if (offer.values) {
    console.say(fmt::format("{}: {} of {} ({}{})", volume.name(), counted(offer.traits.samples, "sample"),
                            volume.array_name(), facts.grid,
                            offer.steps > 1 ? fmt::format(", {} steps", offer.steps) : ""));
    say_traits(offer.traits, console);
    console.say("reconstruction", fmt::format("{}, since it is {}", offer.suited.method, offer.suited.why));
  } else {
    console.say(fmt::format("{}: {}, {} ({}), no arrays", volume.name(), counted(facts.points, "point"),
                            counted(facts.cells, "cell"), facts.grid));
  }
  for (const ToldCommand& one : told) {
    console.say(one.aim, one.why);
    console.say("  $ " + one.command);
  }
}

}  // namespace sansmesh::cli
