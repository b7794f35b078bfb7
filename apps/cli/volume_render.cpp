// sansmesh volume render: a picture of a volume, seen through.
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "option_groups.h"
#include "picture_contents.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"
#include "sansmesh/jobs/color_bar.h"
#include "sansmesh/jobs/volume_subject.h"
#include "sansmesh/mesh/tubes.h"
#include "sansmesh/render/baked_volume.h"
#include "sansmesh/render/picture_surfaces.h"
#include "sansmesh/render/transfer_json.h"
#include "sansmesh/render/volume_picture.h"
#include "sansmesh/volume/volume_boundary.h"
#include "volume_colors.h"
#include "volume_input.h"

namespace sansmesh::cli {
namespace {

struct VolumeRenderArguments {
  VolumeInput input;
  std::string output, save_transfer, opacity_by, unit, background = "gradient";
  std::vector<std::string> cuts;
  VolumeColors colors;
  PictureContents contents;
  PictureArguments picture;
  VolumePictureOptions options;
  int frames = 0;
  bool interactive = false, no_shading = false, no_cut_faces = false, no_bar = false, grid = false;
  double bake_error = BakeOptions().tolerance;
};

VolumePictureOptions chosen_options(const VolumeRenderArguments& a) {
  VolumePictureOptions o = a.options;
  static_cast<RenderOptions&>(o) = a.picture.chosen();
  set_background(o, a.background);
  a.colors.put_into(o);
  for (const std::string& text : a.cuts) o.cuts.push_back(volume_cut_of(text));
  o.shading = !a.no_shading;
  o.cut_faces = !a.no_cut_faces;
  o.color_bar = !a.no_bar;
  o.steady = a.frames > 0;
  if (a.interactive) o.samples = 1, o.step = 1.5, o.least_light = 0.01;
  o.validate();
  return o;
}

/// The outer edges of the grid's cells, about a pixel and a half wide; thinner where cells are small.
PictureSurface grid_lines(const SampledVolume& samples, const RenderOptions& options) {
  RenderOptions own = options;
  own.surface_color = options.wire_color;
  TubeOptions tube;
  tube.sides = 5;
  const double seen = options.look_radius ? 2 * *options.look_radius : samples.bounds().diagonal() / options.zoom;
  tube.radius = 0.75 * seen / std::min(options.width, options.height);
  // Lines that leave nothing between them would hide the volume: they may cover a share of its sides, about those of
  // its box.
  constexpr double kCovered = 0.3;
  const PolylineSet lines = boundary_edges(samples);
  const Vec3 size = samples.bounds().size();
  const double sides = 2 * (size.x * size.y + size.y * size.z + size.z * size.x);
  double length = 0;
  for (std::size_t i = 0; i < lines.size(); ++i)
    length += norm(Vec3(lines.positions[lines.offsets[i] + 1] - lines.positions[lines.offsets[i]]));
  if (length > 0) tube.radius = std::min(tube.radius, kCovered * sides / (2 * length));
  return surface_in_picture(tubes(lines, tube), own);
}

/// A vector as a whole was chosen.
bool of_vector(OpenVolume& volume) {
  const ArrayChoice& choice = volume.choice();
  return volume.dataset().array(choice.array).components > 1 && !choice.component && !choice.magnitude;
}

void run_volume_render(VolumeRenderArguments& a, Console& console) {
  VolumePictureOptions options = chosen_options(a);
  check_writable(a.output, "image");
  if (!a.save_transfer.empty()) check_writable(a.save_transfer, "text");
  require(a.interactive || a.bake_error == BakeOptions().tolerance, "--bake-error needs --interactive");
  require((a.options.color_title.empty() && a.unit.empty()) || !a.no_bar,
          "--label and --unit stand at the colour bar: not with --no-bar");
  a.picture.check_frames(a.frames > 0);
  require(a.frames == 0 || a.frames >= 2, "--frames must be at least 2");
  OpenVolume volume(a.input, console);
  Progress& progress = console.progress();
  const auto samples = volume.samples();
  std::shared_ptr<const VolumeField> field, opacity;
  std::vector<std::string> files;
  int width = 0, height = 0;
  VolumePictureReport report;
  std::unique_ptr<BakedVolume> baked, baked_opacity;
  try {
    volume.dataset().default_array();  // there must be one
    field = volume.field(as_scalar(volume.choice(), volume));
    if (!a.opacity_by.empty()) opacity = volume.field(scalar_choice(a.opacity_by, volume, "opacity_by"));
    TriangleMesh boundary;
    VolumeSubject subject = volume_subject(*samples, boundary);
    subject.field = field.get(), subject.opacity = opacity.get();
    if (a.interactive) {
      BakeOptions bake;
      bake.tolerance = a.bake_error;
      bake.places = samples->positions;
      progress.begin("bake");
      baked = std::make_unique<BakedVolume>(*field, bake, progress);
      subject.field = baked.get();
      if (opacity) {
        baked_opacity = std::make_unique<BakedVolume>(*opacity, bake, progress);
        subject.opacity = baked_opacity.get();
      }
    }
    if (!a.picture.has_view())
      if (const auto view = view_of_layer(samples->bounds(), options.up)) options.view = *view;
    subject.surfaces = a.contents.read(options, console);
    if (a.grid) subject.surfaces.push_back(grid_lines(*samples, options));
    if (options.color_title.empty())
      options.color_title = volume.array_name() + (of_vector(volume) ? " (magnitude)" : "");
    options.color_title = with_unit(options.color_title, a.unit);
    const VolumePicture picture(std::move(subject), progress);
    const std::vector<ViewDirection> views = turntable(options.view, std::max(1, a.frames));
    for (std::size_t k = 0; k < views.size(); ++k) {
      VolumePictureOptions frame = options;
      frame.view = views[k];
      files.push_back(a.frames > 0 ? frame_name(a.output, k) : a.output);
      if (files.size() > 1) console.keep_frames();
      const Image image = a.picture.write(files.back(), picture.render(frame, progress, &report), frame);
      width = image.width, height = image.height;
    }
  } catch (const DataError& error) {
    throw FileError(a.input.name(), error.what());
  }
  progress.finish();
  console.warn(a.input.name(), report.notes);

  volume.say_method();
  console.say(fmt::format("{}: {} ({})", a.input.name(), counted(samples->size(), "sample"), samples->facts.grid));
  const auto [lower, upper] = report.transfer.range();
  console.say(fmt::format("{}: colours over {:.6g} to {:.6g}{}", files.size() == 1 ? files[0] : a.output, lower, upper,
                          report.why.empty() ? "" : "; " + report.why));
  if (baked)
    console.say(fmt::format(
        "baked into {}, off by {:.3g} % of the range on average, {:.3g} % at the worst of the places checked{}",
        counted(baked->report().bricks, "brick"), 100 * baked->report().error_mean, 100 * baked->report().error_most,
        baked->report().finished ? "" : "; there was no memory for more"));
  if (!a.save_transfer.empty()) write_text(a.save_transfer, transfer_function_json(report.transfer));
  Json json = {{"input", volume.json()},
               {"colors", {{"lower", lower}, {"upper", upper}}},
               {"why", report.why},
               {"rays", report.rays},
               {"evaluations", report.evaluations},
               {"notes", report.notes},
               {"output", {{"files", files}, {"width", width}, {"height", height}}}};
  if (baked)
    json["baked"] = {{"bricks", baked->report().bricks},         {"bytes", baked->report().bytes},
                     {"finished", baked->report().finished},     {"checked", baked->report().checked},
                     {"error_mean", baked->report().error_mean}, {"error_most", baked->report().error_most}};
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_volume_render(CommandLine& volume) {
  CommandLine& c = volume.add_subcommand("render", "Volume on any grid → picture: seen through, iso-surfaces, cuts");
  auto shared = std::make_shared<VolumeRenderArguments>();
  VolumeRenderArguments& a = *shared;
  add_volume_input(c, a.input);
  c.add_option("-o,--output", a.output, "Picture to write: .png").type_name("FILE").required();
  a.colors.add_options(c, "Options");
  c.add_option("--save-transfer", a.save_transfer, "Also writes what was used, to be changed and given to --transfer")
      .type_name("FILE");
  c.add_option("--opacity-by", a.opacity_by, "Array for the opacity, --array then gives the colours").type_name("NAME");
  c.add_option("--cut", a.cuts, "Takes away what is there: 'x>1.5', '-1<z<2', '1,1,0>3'; may be repeated")
      .type_name("PLACE")
      .repeated();
  a.contents.add_options(c);
  c.add_flag("--grid", a.grid,
             "Also the edges of the grid's cells where the volume ends; with --opacity 0 these alone");
  c.add_flag("--no-cut-faces", a.no_cut_faces, "Cut faces stay as clear as what is behind them");
  c.add_flag("--no-shading", a.no_shading, "Colours as the transfer function has them, without light");
  c.add_flag("--interactive", a.interactive, "Quick: from the field baked into bricks, whose error is reported");
  c.add_option("--bake-error", a.bake_error,
               "Of --interactive: error above which bricks are split, share of the range [0.004]")
      .type_name("SHARE");
  c.add_flag("--no-bar", a.no_bar, "Without the colour bar").group("Picture");
  c.add_option("--label", a.options.color_title, "Of the colour bar: what is shown [the array's name]")
      .type_name("TEXT")
      .group("Picture");
  c.add_option("--unit", a.unit, "Of the array, at the colour bar").type_name("UNIT").group("Picture");
  c.add_option_function(
       "--axes", [&o = a.options](const std::string& unit) { o.axes = true, o.unit = unit; },
       "With the outline of the box and ticks, and the unit of lengths, as --axes=mm")
      .type_name("UNIT")
      .without_value("")
      .group("Picture");
  c.add_option("--title", a.options.title, "Above the picture").type_name("TEXT").group("Picture");
  add_background_option(c, a.background);
  c.add_option("--frames", a.frames, "Turntable: so many pictures around the up axis, NAME_000.png, …")
      .type_name("COUNT")
      .group("Picture");
  add_picture_options(c, a.picture);
  c.footer(std::string(kReadableVolumes) +
           "\n\nExamples:\n"
           "  sansmesh volume render head.mhd -o head.png --preset ct-bone\n"
           "  sansmesh volume render bluntfinxyz.bin --array Density -o fin.png --iso 2.5 --cut 'y>4' --axes\n"
           "  sansmesh volume render fire.vtu --array t --opacity-by mfrac -o fire.png --frames 36");
  return {&c, [shared](Console& console) { run_volume_render(*shared, console); }};
}

}  // namespace sansmesh::cli
