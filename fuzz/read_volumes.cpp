// Whatever bytes the header of an image, of a PLOT3D, Nek5000, NetCDF or ADF file holds, or a mesh of Gmsh, Medit,
// TetGen or Vega, reading it ends with blocks whose arrays fit together, or with an error of one printable line. The
// first byte chooses the format, of meshes the second.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/io/adf_size.h"
#include "sansmesh/io/netcdf_size.h"
#include "sansmesh/io/volume_readers.h"
#include "support/clean_text.h"

using namespace sansmesh;
using test::is_clean;

namespace {

void require(bool ok, const char* what) {
  if (ok) return;
  std::fprintf(stderr, "fuzz_read_volumes: %s\n", what);
  std::abort();
}

void check(const GridData& data) {
  require(!data.blocks.empty(), "no blocks");
  for (const GridBlock& b : data.blocks) {
    const bool lattice = b.kind == GridKind::lattice;
    const std::size_t n = lattice ? b.axes[0].size() * b.axes[1].size() * b.axes[2].size() : b.points.size();
    require(n > 0, "no points");
    require(lattice || b.kind == GridKind::unstructured || n == b.dims[0] * b.dims[1] * b.dims[2],
            "other points than its size says");
    require(b.hidden_points.empty() || b.hidden_points.size() == n, "hidden ones of other points");
    for (const std::uint32_t p : b.cells.corners) require(p < n, "a cell of points that are not there");
    for (const auto& ring : b.flat_cells)
      for (std::size_t k = 0; k < 4; ++k)
        require(ring[k] < n || (k == 3 && ring[k] == GridBlock::kNone), "a flat cell of points that are not there");
    for (const auto& axis : b.axes)
      require(std::is_sorted(axis.begin(), axis.end(), std::less_equal<>()), "an axis that does not increase");
    require(b.point_numbers.empty() || b.point_numbers.size() == n, "numbers of other points");
    for (const Attribute& a : b.cell_arrays)
      require(a.rows() == (b.cells.empty() ? b.flat_cells.size() : b.cells.size()), "an array of other cells");
    for (const Attribute& a : b.point_arrays)
      require(a.components > 0 && !a.name.empty() && a.size() == n * a.components, "an array of other points");
  }
}

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
  // TetGen's two files with a zero between.
  const std::size_t end = std::min(in.bytes.find('\0'), in.bytes.size());
  const io::Input nodes{in.file, in.bytes.substr(0, end), in.report};
  const io::Input cells{in.file, in.bytes.substr(std::min(end + 1, in.bytes.size())), in.report};
  return io::read_tetgen(nodes, &cells);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Data files that a header names are looked for where there are none.
  static const std::string name = "/nonexistent-folder/fuzz.file";
  if (size < 2) return 0;
  const ThreadScope one(1);
  const std::unique_ptr<char[]> bytes(new char[size - 1]);
  std::copy(data + 1, data + size, bytes.get());
  ReadReport report;
  const io::Input in{name, {bytes.get(), size - 1}, report};
  try {
    switch (data[0] % 8) {
      case 0:
        check(io::read_metaimage(in, 0));
        break;
      case 1:
        check(io::read_nrrd(in, 0));
        break;
      case 2:
        check(io::read_plot3d(in, {}));
        break;
      case 4:
        check(io::read_nek_field(in));
        break;
      case 5:
        check(io::read_nek_series(in, 0));
        break;
      case 6:
        io::check_adf_size(in);
        break;
      case 7: {
        const io::Input mesh{name, in.bytes.substr(1), report};
        check(read_mesh_of_cells(mesh, in.bytes[0]));
        break;
      }
      default:
        io::check_netcdf_size(in);
    }
    for (const std::string& warning : report.warnings) require(is_clean(warning), "a warning that is not printable");
  } catch (const FileError& error) {
    const std::string what = error.what();
    require(is_clean(what), "an error that is not printable");
    require(what.size() < 5000, "an error as long as a file");
  }
  return 0;
}
