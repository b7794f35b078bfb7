// Command `volume`: group of commands on volumes.
#include "cli/input/volume_input.h"
#include "cli/line/commands.h"

namespace sansmesh::cli {

std::vector<Command> add_volume(CommandLine& app) {
  CommandLine& c =
      app.add_subcommand("volume", "Volumes on any grid: fit, probe, resample, smooth, isosurface, surface, render");
  c.footer(
      std::string(kReadableVolumes) +
      "\n\nWithout --method the reconstruction is chosen from the data: sansmesh advise DATA shows which and why.\n\n"
      "Examples:\n"
      "  sansmesh info fire.vtu\n"
      "  sansmesh volume probe fire.vtu --array t --points where.csv -o t.csv\n"
      "  sansmesh volume resample fire.vtu --array t --size 128 -o t.vti\n"
      "  sansmesh volume isosurface fire.vtu --array t --value 1000 -o hot.ply\n"
      "  sansmesh volume fit fire.vtu --array t -o fire.smv");
  return {add_volume_fit(c),        add_volume_probe(c),  add_volume_resample(c), add_volume_smooth(c),
          add_volume_isosurface(c), add_volume_render(c), add_volume_surface(c)};
}

}  // namespace sansmesh::cli
