#include "advise_volume.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "sansmesh/advise/advise_volume.h"
#include "sansmesh/io/io.h"

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

/// The vectors of a flow: the array that is looked at, if they are that, else the first.
const DatasetArray* flow_array(const VolumeDataset& dataset, const std::string& looked_at) {
  const DatasetArray* found = nullptr;
  for (const DatasetArray& a : dataset.arrays()) {
    if (a.components != 2 && a.components != 3) continue;
    if (a.name == looked_at) return &a;
    if (!found) found = &a;
  }
  return found;
}

/// A line of seeds across the flow, through the middle of the box: along the longer of the two axes that the flow does
/// not follow. Where it follows none it is as good as any other line.
std::string seed_line(const SampledVolume& volume, const DatasetArray& flow) {
  const Box3 box = volume.bounds();
  const Vec3 size = box.size(), middle = box.center();
  std::size_t along = 0;
  for (std::size_t c = 1; c < flow.components; ++c)
    if (std::abs(flow.least[c] + flow.most[c]) > std::abs(flow.least[along] + flow.most[along])) along = c;
  const double extent[3] = {size.x, size.y, size.z};
  std::size_t across = along == 0 ? 1 : 0;
  for (std::size_t c = 0; c < 3; ++c)
    if (c != along && extent[c] > extent[across]) across = c;
  Vec3 from = middle, to = middle;
  // A twentieth inside: at the very border there is often no flow, or none that leads in.
  const auto ends = [&](double Vec3::*axis) {
    from.*axis = box.lower.*axis + 0.05 * size.*axis;
    to.*axis = box.upper.*axis - 0.05 * size.*axis;
  };
  ends(across == 0 ? &Vec3::x : across == 1 ? &Vec3::y : &Vec3::z);
  return fmt::format("--seeds 'line({:.4g},{:.4g},{:.4g}, {:.4g},{:.4g},{:.4g}, 256)'", from.x, from.y, from.z, to.x,
                     to.y, to.z);
}

}  // namespace

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
  OpenVolume volume(any, console);
  const VolumeDataset& dataset = volume.dataset();
  VolumeOffer offer;
  offer.values = !dataset.arrays().empty();
  offer.steps = std::max<std::size_t>(dataset.times().size(), 1);
  const auto samples = volume.samples();
  // Cells of lattices and of bodies of fluid are no bodies; unstructured ones may be.
  offer.body = samples->facts.grid == "unstructured";
  offer.lattice = samples->lattice.has_value();
  if (!offer.values && !offer.body)
    throw FileError(input.name(), "holds no arrays, and no cells that could move: there is nothing to advise");

  std::string files;
  for (const std::string& file : input.files) files += (files.empty() ? "" : " ") + shell_word(file);
  files += raw_words(input.read);
  Json json = {{"input", volume.json()}};
  std::string array, flow;
  double middle = 0;
  const DatasetArray* vectors = nullptr;
  if (offer.values) {
    // As it was given; of a vector its magnitude, which surfaces and pictures can be of.
    const ArrayChoice& choice = volume.choice();
    const DatasetArray& of = dataset.array(choice.array);
    const bool vector = of.components > 1 && !choice.component;
    array = " --array " + shell_word(vector ? of.name + ":magnitude" : input.array.empty() ? of.name : input.array);
    if (vector) {
      for (std::size_t i = 0; i < samples->size(); ++i) middle += volume.sample_value(i);
      middle /= static_cast<double>(samples->size());
    } else {
      middle = volume.model().middle_value();
    }
    vectors = flow_array(dataset, of.name);
    offer.vectors = vectors != nullptr;
    offer.traits = volume.model().traits(console.progress());
    offer.suited = volume.model().suited(console.progress());
  }
  if (vectors) {
    flow = fmt::format(" --array {}{}", shell_word(vectors->name), offer.steps > 1 ? " --unsteady" : "");
    if (offer.steps > 1 && input.files.size() > 1) flow.clear();  // of several files steps and blocks look the same
  }
  console.progress().finish();

  const VolumeTraits& t = offer.traits;
  const std::string name(info_of(offer.suited.method).name);
  if (offer.values) {
    console.say(fmt::format("{}: {} of {} ({}{})", input.name(), counted(t.samples, "sample"), volume.array_name(),
                            samples->facts.grid, offer.steps > 1 ? fmt::format(", {} steps", offer.steps) : ""));
    console.say(
        fmt::format("  left out, a sample is missed by {} of the range by its neighbours' mean, {} by planes, {} by "
                    "parabolas, {} by cubics",
                    share_words(t.left_out[0]), share_words(t.left_out[1]), share_words(t.left_out[2]),
                    share_words(t.left_out[3])));
    console.say(fmt::format("  noise at most {} of the range; steps at {} of the samples", share_words(t.noise),
                            share_words(t.steps)));
    console.say(fmt::format("{:<16}{}, since it is {}", "reconstruction", name, offer.suited.why));
    json["array"] = volume.choice().array;
    json["samples"] = t.samples;
    json["left_out"] = t.left_out;
    json["left_out_rms"] = t.left_out_rms;
    json["noise"] = t.noise;
    json["steps"] = t.steps;
    json["resolved"] = t.resolved();
    json["method"] = name;
    json["why"] = offer.suited.why;
  } else {
    console.say(fmt::format("{}: {}, {} ({}), no arrays", input.name(), counted(samples->facts.points, "point"),
                            counted(samples->facts.cells, "cell"), samples->facts.grid));
  }

  const auto command_of = [&](const VolumeRecommendation& r) -> std::string {
    const char* const both = offer.steps > 1 ? "" : " --direction both";
    switch (r.aim) {
      case VolumeAim::values:
        return fmt::format("sansmesh volume probe {}{} --points where.csv -o values.csv", files, array);
      case VolumeAim::grid:
        return fmt::format("sansmesh volume resample {}{} -o resampled.vti", files, array);
      case VolumeAim::surface:
        return fmt::format("sansmesh volume {} {}{} --value {:.4g} -o surface.ply",
                           r.by_samples ? "surface" : "isosurface", files, array, middle);
      case VolumeAim::border:
        return fmt::format("sansmesh volume surface {}{} --high-gradient -o border.ply", files, array);
      case VolumeAim::picture:
        return fmt::format("sansmesh volume render {}{} -o picture.png", files, array);
      case VolumeAim::lines:
        return fmt::format("sansmesh flow lines {}{} -o lines.vtp --preview lines.png", files, flow);
      case VolumeAim::flow_surface:
        return fmt::format("sansmesh flow surface {}{} {}{} -o flow.ply", files, flow, seed_line(*samples, *vectors),
                           both);
      case VolumeAim::flow_picture:
        return fmt::format("sansmesh flow render {}{} {}{} -o flow.png", files, flow, seed_line(*samples, *vectors),
                           both);
      case VolumeAim::deformation:
        return fmt::format("sansmesh deform {}{} --handles handles.json -o deformed.png", files, array);
      case VolumeAim::forces:
        return fmt::format("sansmesh simulate {} --animation moved.png", files);
    }
    return {};
  };
  json["commands"] = Json::array();
  for (const VolumeRecommendation& r : advise_volume(offer)) {
    console.say(fmt::format("{:<16}{}", aim_word(r.aim), r.why));
    console.say("  $ " + command_of(r));
    json["commands"].push_back({{"aim", aim_word(r.aim)}, {"why", r.why}, {"command", command_of(r)}});
  }
  console.say_json(json);
  console.print_timings();
}

}  // namespace sansmesh::cli
