// Readers of volumes, each in a source of its own: X_read.cpp.
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
/// What the name of a raw file says of its layout ("engine_256x256x128_uint8.raw"), if anything.
std::optional<RawLayout> raw_layout_of_name(const std::string& file);
/// PLOT3D grid and, where there is one, solution or functions.
GridData read_plot3d(const Input& in, const std::string& solution);
/// Whether the bytes are those of a PLOT3D grid: of a size that follows exactly from the numbers at their beginning.
bool is_plot3d(const Input& in);
/// The file of the solution that belongs to a grid by its name, if it is there; else empty.
std::string plot3d_solution_of(const std::string& grid);
/// A file of fields by Nek5000 ("#std …").
GridData read_nek_field(const Input& in);
/// A step of a series of such files (.nek5000).
GridData read_nek_series(const Input& in, std::size_t step);
/// Whether files of fields end like that: f00001.
bool is_nek_field_name(const std::string& ending);
/// Gmsh's MSH, versions 2 and 4.
GridData read_gmsh(const Input& in);
/// Medit's .mesh, and .meshb.
GridData read_medit(const Input& in);
/// TetGen's .node and .ele, the one that was given and the other beside it.
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
/// The same of a series of files (.vtu.series, .vtk.series, …).
std::vector<PvdEntry> read_file_series(const Input& in);

}  // namespace sansmesh::inline v1::io
