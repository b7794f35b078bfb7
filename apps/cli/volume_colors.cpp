#include "volume_colors.h"

#include <string_view>

#include "option_values.h"
#include "sansmesh/render/transfer_json.h"
#include "sansmesh/render/transfer_presets.h"

namespace sansmesh::cli {

void VolumeColors::put_into(VolumePictureOptions& options) const {
  options.preset = preset;
  options.opacity_scale = opacity;
  for (const std::string& text : isos) options.isos.push_back(iso_surface_of(text));
  if (!transfer.empty()) options.transfer = read_transfer_function(transfer);
}

void VolumeColors::add_options(CommandLine& c, const char* group) {
  std::string presets;
  for (const std::string_view name : transfer_function_presets())
    presets += (presets.empty() ? "" : ", ") + std::string(name);
  c.add_option("--preset", preset, "Colours and opacities: " + presets + " [from the values' histogram]")
      .one_of(listed_words(presets))
      .type_name("NAME")
      .group(group);
  c.add_option("--transfer", transfer, "The same from a file: JSON of ours or a colour map of ParaView")
      .type_name("FILE")
      .group(group);
  c.add_option("--opacity", opacity, "Multiplies the opacity; 0: iso-surfaces and cuts only [1]")
      .type_name("FACTOR")
      .group(group);
  c.add_option("--iso", isos, "Surface of a value: V, V:#rrggbb, V:#rrggbb:OPACITY; may be repeated")
      .type_name("VALUE")
      .repeated()
      .group(group);
}

}  // namespace sansmesh::cli
