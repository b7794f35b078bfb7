// Reads volumes: files of grids, images and scattered points as blocks of points, cells and arrays.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/io.h"
#include "sansmesh/volume_read_options.h"

namespace sansmesh::inline v1 {

/// Reads the volume of a file (docs/formats/volumes.md). The format follows from the ending and the content. This
/// library reads MetaImage (.mhd, .mha), NRRD (.nrrd, .nhdr), raw numbers (by `raw`, or by a name such as
/// engine_256x256x128_uint8.raw), PLOT3D (its solution is found by its name: flowxyz.bin and flowq.bin, flow.xyz and
/// flow.q), Nek5000 (.nek5000, .f00001), cell meshes by Gmsh (.msh), Medit (.mesh, .meshb), TetGen (.node, .ele) and
/// Vega (.veg), and files of points (read_points). VTK, Exodus, EnSight, CGNS, OpenFOAM and folders of DICOM slices
/// need the module that `scripts/install-deps volume` and the target `sansmesh_vtk` build; the error explains this if
/// it is missing.
///
/// While the module reads, it replaces VTK's output window and silences its log in the whole process, and for a CGNS
/// file it replaces the buffer of std::cerr: do not set these on another thread meanwhile.
///
/// Throws FileError if the file is missing, empty, truncated, malformed, of an unknown or ambiguous layout, or has no
/// points, and ArgumentError if options are out of range (`time_step` beyond the file's).
GridData read_volume(const std::string& file, const VolumeReadOptions& options = {}, ReadReport* report = nullptr);

/// Reads several files as blocks of one volume, in the order of the files and named after them. A PLOT3D grid may be
/// followed by its solution. Throws as read_volume, and ArgumentError for an empty list.
GridData read_volumes(const std::vector<std::string>& files, const VolumeReadOptions& options = {},
                      ReadReport* report = nullptr);

/// Whether the name shows a volume that only read_volume reads (images, grids; not files of points).
bool is_volume_name(const std::string& file);

/// The same; if the ending is also used for points, whether the content is a grid (PLOT3D named .xyz).
bool holds_volume(const std::string& file);

/// Whether the module for VTK's formats can be loaded; otherwise `why_not` receives the reason.
bool has_vtk_readers(std::string* why_not = nullptr);

}  // namespace sansmesh::inline v1
