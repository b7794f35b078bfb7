#include "volume_colors.h"

#include "sansmesh/volume_look.h"
#include "schema_options.h"

namespace sansmesh::cli {

void VolumeColors::put_into(VolumePictureOptions& options) const {
  options.preset = look.preset;
  options.opacity_factor = look.opacity_factor;
  options.isos = look.isos;
  if (!transfer.empty()) options.transfer = read_transfer_function(transfer);
}

void VolumeColors::add_options(CommandLine& c, const char* group) {
  add_schema(c, look, {.group = group, .only = {"preset", "opacity_factor", "iso"}});
  c.add_option("--transfer", transfer, "Colours and opacities from a file: JSON of ours or a colour map of ParaView")
      .reads()
      .group(group);
}

}  // namespace sansmesh::cli
