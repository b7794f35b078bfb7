// Fuzz target: reading any image header, PLOT3D, Nek5000, NetCDF or ADF file, or mesh of Gmsh, Medit, TetGen or Vega,
// yields blocks with consistent arrays, or an error of one printable line. The first byte selects the format, the
// second the format of meshes.
#include <algorithm>
#include <string>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/io/grids/adf_size.h"
#include "sansmesh/io/grids/netcdf_size.h"
#include "sansmesh/io/grids/volume_readers.h"
#include "target.h"

using namespace sansmesh;
using fuzz::check_grid;

namespace {

GridData read_mesh_of_cells(const io::Input& in, char format) {
  switch (format) {
    case 'g':
      return io::read_gmsh(in);
    case 'm':
      return io::read_medit(in);
    case 'v':
      return io::read_vega(in);
    default:
      break;
  }
  // TetGen's two files, separated by a zero byte.
  const std::size_t end = std::min(in.bytes.find('\0'), in.bytes.size());
  const io::Input nodes{in.file, in.bytes.substr(0, end), in.report};
  const io::Input cells{in.file, in.bytes.substr(std::min(end + 1, in.bytes.size())), in.report};
  return io::read_tetgen(nodes, &cells);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Data files named in a header are searched for in a folder that does not exist.
  static const std::string name = "/nonexistent-folder/fuzz.file";
  if (size < 2) return 0;
  const ThreadScope one(1);
  const fuzz::ExactBytes bytes(data + 1, size - 1);
  ReadReport report;
  const io::Input in{name, bytes.view(), report};
  try {
    switch (data[0] % 8) {
      case 0:
        check_grid(io::read_metaimage(in, 0));
        break;
      case 1:
        check_grid(io::read_nrrd(in, 0));
        break;
      case 2:
        check_grid(io::read_plot3d(in, {}));
        break;
      case 4:
        check_grid(io::read_nek_field(in));
        break;
      case 5:
        check_grid(io::read_nek_series(in, 0));
        break;
      case 6:
        io::check_adf_size(in);
        break;
      case 7: {
        const io::Input mesh{name, in.bytes.substr(1), report};
        check_grid(read_mesh_of_cells(mesh, in.bytes[0]));
        break;
      }
      default:
        io::check_netcdf_size(in);
    }
    fuzz::check_report(report);
  } catch (const FileError& error) {
    fuzz::check_message(error.what());
  }
  return 0;
}
