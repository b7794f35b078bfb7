// Fuzz target: reading LAZ and COPC files yields points with consistent arrays, or a FileError of one printable line.
// The first byte selects a box, a level and the number of threads.
#include <string>
#include <string_view>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/io/readers.h"
#include "target.h"

using namespace sansmesh;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string name = "fuzz.laz";
  if (size < 2) return 0;
  const ThreadScope threads(data[0] & 4 ? 2 : 1);
  const fuzz::ExactBytes bytes(data + 1, size - 1);
  ReadReport report;
  ReadOptions options;
  if (data[0] & 1) options.box = Box3{{636500, 849500, 410}, {637500, 851500, 440}};
  if (data[0] & 2) options.resolution = 10;
  const io::Input in{name, bytes.view(), report, {}, 0, options};
  try {
    const PointSet points = io::read_las(in);
    if (points.size() > 0 || data[0] % 4 == 0) fuzz::check_points(points);  // a query may select nothing
    fuzz::check_report(report);
  } catch (const FileError& error) {
    fuzz::demand(std::string_view(error.what()).starts_with("fuzz.laz: "), "an error that does not name the file");
    fuzz::check_message(error.what());
  }
  return 0;
}
