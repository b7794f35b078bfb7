// Fuzz target: reading an E57 file yields points with consistent arrays, or a FileError of one printable line. If the
// first byte is odd, the checksums of the pages are set to the right values, so that the content behind them is read.
#include <string>
#include <string_view>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/io/e57/crc32c.h"
#include "sansmesh/io/readers.h"
#include "target.h"

using namespace sansmesh;

static std::string with_checksums(std::string file) {
  for (std::size_t at = 0; at + 1024 <= file.size(); at += 1024) {
    const std::uint32_t crc = io::crc32c(std::string_view(file).substr(at, 1020));
    for (std::size_t k = 0; k < 4; ++k) file[at + 1020 + k] = static_cast<char>(crc >> (24 - 8 * k) & 255);
  }
  return file;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string name = "fuzz.file";
  if (size < 2) return 0;  // readers never see empty content
  const ThreadScope one(1);
  std::string content(reinterpret_cast<const char*>(data + 1), size - 1);
  if (data[0] % 2 == 1) content = with_checksums(std::move(content));
  const fuzz::ExactBytes bytes(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
  ReadReport report;
  const io::Input in{name, bytes.view(), report};
  try {
    fuzz::check_points(io::read_e57(in));
    fuzz::check_report(report);
  } catch (const FileError& error) {
    fuzz::demand(std::string_view(error.what()).starts_with("fuzz.file: "), "an error that does not name the file");
    fuzz::check_message(error.what());
  }
  return 0;
}
