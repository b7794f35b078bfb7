// ParaView data collections: XML that names a file for each time and part.
#include "sansmesh/io/grids/header_fields.h"
#include "sansmesh/io/grids/volume_readers.h"
#include "sansmesh/io/meshes/vtk_xml.h"

namespace sansmesh::inline v1::io {

std::vector<PvdEntry> read_pvd(const Input& in) {
  std::vector<PvdEntry> entries;
  XmlScanner xml(in);
  bool ended = false;
  while (const auto tag = xml.next()) {
    if (tag->name == "/VTKFile") ended = true;
    if (tag->name != "DataSet") continue;
    if ((*tag)["file"].empty()) in.fail("names a part without a file");
    double time = 0;
    if (const std::string_view text = (*tag)["timestep"]; !text.empty()) {
      TextScanner s(text);
      if (!s.number(time)) in.fail("gives a time that is not a number");
    }
    entries.push_back({time, beside(in, from_xml((*tag)["file"]))});
  }
  if (!ended) in.fail("truncated: it does not end");
  if (entries.empty()) in.fail("names no files");
  return entries;
}

}  // namespace sansmesh::inline v1::io
