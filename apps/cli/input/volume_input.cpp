#include "cli/input/volume_input.h"

#include <algorithm>

#include "cli/line/command_line.h"
#include "cli/line/schema_options.h"

namespace sansmesh::cli {

const ReportSchema& ReadVolume::schema() {
  static constexpr ReportRow rows[] = {reported_base<ReadFiles, ReadVolume>(), reported_inline<&ReadVolume::use>()};
  return report_schema<rows>();
}

VolumeModel VolumeInput::open(Console& console) const {
  VolumeModel volume = open_volume(files, *this, console.progress());
  console.note(volume.name(), volume.notes());
  return volume;
}

void add_raw_options(CommandLine& c, VolumeReadOptions& options) {
  add_schema(c, options.raw, {.group = "Raw files"});
  add_schema(c, options, {.only = {"time_step", "solution", "fill_value"}});
}

void add_volume_input(CommandLine& c, VolumeInput& input, const std::vector<std::string_view>& without) {
  c.add_option("data", input.files, "Volume; several files are its blocks").type_name("DATA").reads().required();
  add_raw_options(c, input.read);
  add_schema<VolumeModelOptions>(c, input, {.only = {"array"}});
  add_schema(c, input.reconstruction, {.group = "Reconstruction", .without = without});
}

void add_volume_array(CommandLine& c, VolumeInput& input) {
  add_schema<VolumeModelOptions>(c, input, {.only = {"array"}});
  add_schema(c, input.reconstruction, {.group = "Reconstruction", .only = {"method"}});
}

bool take_volume_word(std::vector<std::string>& files) {
  const bool found = files.size() > 1 && files[0] == "data";
  if (found) files.erase(files.begin());
  return found;
}

bool are_volumes(const std::vector<std::string>& files) {
  return std::all_of(files.begin(), files.end(), holds_volume);
}

bool is_volume_input(std::vector<std::string>& files) { return take_volume_word(files) || are_volumes(files); }

NamedIsosurface open_isosurface(const IsosurfaceName& name, Console& console) {
  VolumeInput input;
  input.files = {name.file};
  input.array = name.array;
  VolumeModel volume = input.open(console);
  std::vector<Note> notes;
  NamedIsosurface named{volume.isosurface(name.value, console.progress(), notes), {}};
  console.note(volume.name(), notes);
  named.use = volume_use(volume, console.progress());
  return named;
}

void VolumeColors::apply_to(VolumePictureOptions& options) const {
  options.preset = look.preset;
  options.opacity_factor = look.opacity_factor;
  options.isos = look.isos;
  if (!transfer.empty()) options.transfer = read_transfer_function(transfer);
}

void VolumeColors::add_options(CommandLine& c, const char* group) {
  add_schema(c, look, {.group = group, .only = {"preset", "opacity_factor", "iso"}});
  c.add_option("--transfer", transfer, "Read colours and opacities from a file: our JSON or a colour map of ParaView")
      .reads()
      .group(group);
}

}  // namespace sansmesh::cli
