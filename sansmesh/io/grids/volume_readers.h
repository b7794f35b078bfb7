// Readers of volumes, each in its own source: X_read.cpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/io/input.h"
#include "sansmesh/volume_read_options.h"

namespace sansmesh::inline v1::io {

/// MetaImage, header and numbers in one file or in two. `step` counts along a fourth axis.
GridData read_metaimage(const Input& in, std::size_t step);
/// NRRD, attached or detached. `step` counts along an axis of time.
GridData read_nrrd(const Input& in, std::size_t step);
/// Numbers without a header.
GridData read_raw(const Input& in, const RawLayout& layout);
/// The layout in the name of a raw file ("engine_256x256x128_uint8.raw"), if any.
std::optional<RawLayout> raw_layout_of_name(const std::string& file);
/// PLOT3D grid with its solution or functions, if there are any.
GridData read_plot3d(const Input& in, const std::string& solution);
/// Whether the bytes are a PLOT3D grid: the file size follows exactly from the numbers at its beginning.
bool is_plot3d(const Input& in);
/// The file of the solution that belongs to a grid by its name, if it exists; else empty.
std::string plot3d_solution_of(const std::string& grid);
/// A field file of Nek5000 ("#std …").
GridData read_nek_field(const Input& in);
/// One step of a series of field files (.nek5000).
GridData read_nek_series(const Input& in, std::size_t step);
/// Whether `ending` is that of a field file: f00001.
bool is_nek_field_name(const std::string& ending);
/// Gmsh's MSH, versions 2 and 4.
GridData read_gmsh(const Input& in);
/// Medit's .mesh and .meshb.
GridData read_medit(const Input& in);
/// TetGen's .node and .ele: the given file and the other one beside it.
GridData read_tetgen_pair(const Input& in);
/// The same from both; `cells` null: points alone.
GridData read_tetgen(const Input& nodes, const Input* cells);
/// Vega's .veg.
GridData read_vega(const Input& in);
/// The time steps and files of a ParaView data collection (.pvd); names are relative to its folder.
struct PvdEntry {
  double time;
  std::string file;
};
std::vector<PvdEntry> read_pvd(const Input& in);
/// The same of a file series (.vtu.series, .vtk.series, …).
std::vector<PvdEntry> read_file_series(const Input& in);

}  // namespace sansmesh::inline v1::io
