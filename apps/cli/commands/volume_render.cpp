// Command `volume render`: pictures of volumes.
#include <fmt/core.h>

#include <memory>
#include <string>

#include "cli/input/volume_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "sansmesh/io.h"
#include "sansmesh/jobs/pictures/picture_contents.h"
#include "sansmesh/volume_look.h"
#include "sansmesh/volume_pictures.h"
#include "sansmesh/volumes.h"

namespace sansmesh::cli {
namespace {

struct VolumeRenderArguments {
  VolumeInput input;
  std::string output, save_transfer;
  VolumeColors colors;
  PictureContentsOptions contents;
  PictureArguments picture;
  VolumePicturesOptions options;

  VolumePicturesOptions chosen() const;
};

VolumePicturesOptions VolumeRenderArguments::chosen() const {
  VolumePicturesOptions o = options;
  o.look.picture = picture.chosen();
  colors.apply_to(o.look);
  o.default_view = !picture.has_view();
  o.validate();
  return o;
}

void run_volume_render(VolumeRenderArguments& a, Console& console) {
  const VolumePicturesOptions options = a.chosen();
  check_writable(a.output, "image");
  if (!a.save_transfer.empty()) check_writable(a.save_transfer, "text");
  a.picture.check_frames(options.frames.has_value());
  VolumeModel volume = a.input.open(console);
  Progress& progress = console.progress();
  const PictureContents contents(a.contents, options.look.picture, console.progress());
  console.note({}, contents.notes());
  VolumePictures pictures(volume, options, contents.surfaces(), progress);
  PictureFiles files(a.picture, a.output, options.frames.has_value(), console);
  pictures.render(files.writer(), progress);
  console.note(volume.name(), pictures.notes());
  const VolumePictureReport& r = pictures.report();
  const BakeReport* const baked = pictures.baked();
  if (!a.save_transfer.empty()) write_text(a.save_transfer, transfer_function_json(r.transfer));
  console.report(a.input.report(volume, progress), "input");
  console.report(r);
  console.report(files.written(), "output");
  if (baked) console.report(*baked, "baked");

  console.print(summary_of(volume, progress));
  const auto [lower, upper] = r.transfer.range();
  console.print(fmt::format("{}: colours over {:.6g} to {:.6g}{}", files.written().words(), lower, upper,
                            r.why.empty() ? "" : "; " + r.why));
  if (baked)
    console.print(
        fmt::format("baked into {}, error {:.3g} % of the range on average, at most {:.3g} % at the tested points{}",
                    counted(baked->bricks, "brick"), 100 * baked->error_mean, 100 * baked->error_most,
                    baked->finished ? "" : "; limited by memory"));
}

}  // namespace

Command add_volume_render(CommandLine& volume) {
  CommandLine& c =
      volume.add_subcommand("render", "Volume on any grid → picture: volume rendering, iso-surfaces, cuts");
  auto shared = std::make_shared<VolumeRenderArguments>();
  VolumeRenderArguments& a = *shared;
  add_volume_input(c, a.input);
  add_picture_output(c, a.output);
  a.colors.add_options(c, "Options");
  c.add_option("--save-transfer", a.save_transfer, "Also write the transfer function that was used, for --transfer")
      .writes({".json"});
  add_schema(c, a.contents);
  add_schema(c, a.options, {.without = {"preset", "opacity_factor", "iso", "bar", "label", "unit", "title", "frames"}});
  add_schema(c, a.options, {.group = "Picture", .only = {"bar", "label", "unit", "title"}});
  c.add_option_function(
       "--axes", [&o = a.options.look](const std::string& unit) { o.axes = true, o.unit = unit; },
       "Draw the outline of the box with ticks, optionally with a unit of lengths: --axes=mm")
      .type_name("UNIT")
      .without_value("")
      .group("Picture");
  add_background_option(c, a.picture);
  add_schema(c, a.options, {.group = "Picture", .only = {"frames"}});
  add_schema(c, a.picture.options, {.group = "Picture", .only = {"antialiasing"}});
  add_picture_options(c, a.picture);
  c.footer(std::string(kReadableVolumes) +
           "\n\nExamples:\n"
           "  sansmesh volume render head.mhd -o head.png --preset ct-bone\n"
           "  sansmesh volume render bluntfinxyz.bin --array Density -o fin.png --iso 2.5 --clip 'y>4' --axes\n"
           "  sansmesh volume render fire.vtu --array t --opacity-by mfrac -o fire.png --frames 36");
  c.announce({report_of<ReadVolume>("input"), report_of<VolumePictureReport>(), report_of<WrittenPictures>("output"),
              report_of<BakeReport>("baked")});
  return {&c, [shared](Console& console) { run_volume_render(*shared, console); }};
}

}  // namespace sansmesh::cli
