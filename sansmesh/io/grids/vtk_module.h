// Interface between the library and the module of VTK's readers (sansmesh/io/vtk). The module is loaded when a file
// first needs it, so that nothing else depends on VTK. It links nothing of the library and calls it only through
// `VtkSink`.
#pragma once

#include <string>

#include "sansmesh/grid_data.h"

namespace sansmesh::inline v1::io {

enum class VtkFormat : std::uint8_t { xml, legacy, exodus, ensight, cgns, openfoam, dicom };

struct VtkRequest {
  std::string file;  ///< a folder for DICOM
  VtkFormat format = VtkFormat::xml;
  std::string xml_type;  ///< type of XML files: "UnstructuredGrid", …
  std::size_t time_step = 0;
};

/// Receives arrays into blocks, and reports whether reading is cancelled.
class VtkSink {
 public:
  virtual void add(GridBlock& block, bool of_cells, Attribute array) = 0;
  virtual bool stopped() const = 0;

 protected:
  ~VtkSink() = default;
};

/// Layout signature: both sides must be compiled with the same value.
inline constexpr std::size_t kVtkInterface =
    2'000'000 + sizeof(GridData) + 7 * sizeof(GridBlock) + 11 * sizeof(Attribute) + 13 * sizeof(VtkRequest);

/// Names and types of the module's functions. `VtkReadFunction` fills `data` and returns true, or returns false with
/// the cause in `error`; it throws no exceptions. A time step beyond those of the file leaves `data.blocks` empty.
inline constexpr const char* kVtkInterfaceFunction = "sansmesh_vtk_interface";
inline constexpr const char* kVtkReadFunction = "sansmesh_vtk_read";
using VtkInterfaceFunction = std::size_t (*)();
using VtkReadFunction = bool (*)(const VtkRequest& request, VtkSink& sink, GridData& data, std::string& error);

/// Loads the module if it is not loaded yet: the file in the environment variable SANSMESH_VTK_MODULE, or
/// libsansmesh_vtk.so beside the installed or built program or library. Null if it cannot be loaded, with the reason in
/// `why_not`.
VtkReadFunction load_vtk_module(std::string& why_not);

/// Reads a file with the module. Throws FileError if the module is missing or fails, ArgumentError if the time step
/// does not exist.
GridData read_by_vtk(const VtkRequest& request);

}  // namespace sansmesh::inline v1::io
