// Fuzz target: reading any file of points or meshes yields points with consistent arrays, or a FileError of one
// printable line. The first byte selects the format, so that each reader also sees content that detection would not
// give it.
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/readers.h"
#include "target.h"

using namespace sansmesh;

using Reader = PointSet (*)(const io::Input&);

static std::vector<Reader> all_readers() {
  std::vector<Reader> all = {io::read_ply, io::read_obj, io::read_off, io::read_stl, io::read_table,
                             io::read_pcd, io::read_las, io::read_vtp, io::read_glb};
  for (const FormatInfo* const format : formats())
    if (format->id == FormatId::added && format->read_points) all.push_back(format->read_points);
  return all;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<Reader> readers = all_readers();
  static const std::string name = "fuzz.file";
  if (size < 2) return 0;  // readers never see empty content
  const ThreadScope one(1);
  const fuzz::ExactBytes bytes(data + 1, size - 1);
  ReadReport report;
  const io::Input in{name, bytes.view(), report};
  try {
    fuzz::check_points(readers[data[0] % readers.size()](in));
    fuzz::check_report(report);
  } catch (const FileError& error) {
    fuzz::demand(std::string_view(error.what()).starts_with("fuzz.file: "), "an error that does not name the file");
    fuzz::check_message(error.what());
  }
  return 0;
}
