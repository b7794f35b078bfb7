// sansmesh volume render: a picture of a volume, seen through.
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "cli/input/volume_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/jobs/picture_contents.h"
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
  colors.put_into(o.look);
  o.any_view = !picture.has_view();
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
  console.tell(a.input.told(volume, progress), "input");
  console.tell(r);
  console.tell(files.written(), "output");
  if (baked) console.tell(*baked, "baked");

  console.say(summary_of(volume, progress));
  const auto [lower, upper] = r.transfer.range();
  console.say(fmt::format("{}: colours over {:.6g} to {:.6g}{}", files.written().words(), lower, upper,
                          r.why.empty() ? "" : "; " + r.why));
  if (baked)
    console.say(fmt::format(
        "baked into {}, off by {:.3g} % of the range on average, {:.3g} % at the worst of the places checked{}",
        counted(baked->bricks, "brick"), 100 * baked->error_mean, 100 * baked->error_most,
        baked->finished ? "" : "; there was no memory for more"));
}

}  // namespace

Command add_volume_render(CommandLine& volume) {
  CommandLine& c = volume.add_subcommand("render", "Volume on any grid → picture: seen through, iso-surfaces, cuts");
  auto shared = std::make_shared<VolumeRenderArguments>();
  VolumeRenderArguments& a = *shared;
  add_volume_input(c, a.input);
  c.add_option("-o,--output", a.output, "Picture to write: .png").writes({".png"}).required();
  a.colors.add_options(c, "Options");
  c.add_option("--save-transfer", a.save_transfer, "Also writes what was used, to be changed and given to --transfer")
      .writes({".json"});
  add_schema(c, a.contents);
  add_schema(c, a.options, {.without = {"preset", "opacity_factor", "iso", "bar", "label", "unit", "title", "frames"}});
  add_schema(c, a.options, {.group = "Picture", .only = {"bar", "label", "unit", "title"}});
  c.add_option_function(
       "--axes", [&o = a.options.look](const std::string& unit) { o.axes = true, o.unit = unit; },
       "With the outline of the box and ticks, and the unit of lengths, as --axes=mm")
      .type_name("UNIT")
      .without_value("")
      .group("Picture");
  add_background_option(c, a.picture);
  add_schema(c, a.options, {.group = "Picture", .only = {"frames"}});
  add_picture_options(c, a.picture);
  c.footer(std::string(kReadableVolumes) +
           "\n\nExamples:\n"
           "  sansmesh volume render head.mhd -o head.png --preset ct-bone\n"
           "  sansmesh volume render bluntfinxyz.bin --array Density -o fin.png --iso 2.5 --clip 'y>4' --axes\n"
           "  sansmesh volume render fire.vtu --array t --opacity-by mfrac -o fire.png --frames 36");
  c.tells({told<ReadVolume>("input"), told<VolumePictureReport>(), told<WrittenPictures>("output"),
           told<BakeReport>("baked")});
  return {&c, [shared](Console& console) { run_volume_render(*shared, console); }};
}

}  // namespace sansmesh::cli
