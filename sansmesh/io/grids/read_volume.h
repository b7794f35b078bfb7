// Volumes in: files of grids, images and scattered points as blocks of points, cells and arrays.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/io.h"
#include "sansmesh/volume_read_options.h"

namespace sansmesh::inline v1 {

/// The volume that a file holds (docs/formats/volumes.md). The format follows from the ending and the content:
/// MetaImage
/// (.mhd, .mha), NRRD (.nrrd, .nhdr), raw numbers (by `raw`, or by a name such as engine_256x256x128_uint8.raw), PLOT3D
/// (its solution is found by its name: flowxyz.bin and flowq.bin, flow.xyz and flow.q), Nek5000 (.nek5000, .f00001),
/// meshes of cells by Gmsh (.msh), Medit (.mesh, .meshb), TetGen (.node, .ele) and Vega (.veg), and files of points
/// (read_points) are read by this library. The formats of VTK, Exodus, EnSight, CGNS, OpenFOAM and folders of DICOM
/// slices need the module that `scripts/install-deps volume` and the target `sansmesh_vtk` make; the error says so
/// where it is missing.
///
/// While the module reads, VTK's window for messages is replaced and its log silent in the whole process, and for a
/// CGNS file the buffer of std::cerr: do not set these on another thread meanwhile.
///
/// Throws FileError where the file is missing, empty, truncated, malformed, of an unknown or ambiguous layout, or has
/// no points, and ArgumentError where options are out of their range (`time_step` beyond the file's).
GridData read_volume(const std::string& file, const VolumeReadOptions& options = {}, ReadReport* report = nullptr);

/// Several files as blocks of one volume, in the order of the files; blocks are named after their files. A PLOT3D grid
/// may be followed by its solution. Throws as read_volume, and ArgumentError for no files at all.
GridData read_volumes(const std::vector<std::string>& files, const VolumeReadOptions& options = {},
                      ReadReport* report = nullptr);

/// Whether read_volume takes files of that name for volumes that no other reader of this library knows (images, grids);
/// files of points are not among them.
bool is_volume_name(const std::string& file);

/// The same, and where the ending is that of points as well, whether the content is a grid (PLOT3D named .xyz).
bool holds_volume(const std::string& file);

/// Whether the module for VTK's formats can be loaded; `why_not` receives the reason otherwise.
bool has_vtk_readers(std::string* why_not = nullptr);

}  // namespace sansmesh::inline v1
