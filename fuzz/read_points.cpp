// Whatever bytes a file of points or a mesh holds, reading it ends with points whose arrays fit together, or with a
// FileError of one printable line. The first byte chooses the format: a reader sees what it would never get through the
// choice by content.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/io/readers.h"
#include "support/clean_text.h"

using namespace sansmesh;
using test::is_clean;

namespace {

void require(bool ok, const char* what) {
  if (ok) return;
  std::fprintf(stderr, "fuzz_read_points: %s\n", what);
  std::abort();
}

bool fits(std::size_t size, std::size_t n) { return size == 0 || size == n; }

void check(const PointSet& p) {
  const std::size_t n = p.size();
  require(n > 0 && is_finite(p.origin), "no points, or no origin");
  require(fits(p.normals.size(), n) && fits(p.colors.size(), n) && fits(p.scan_of_point.size(), n) &&
              fits(p.grid_normals.size(), n),
          "arrays of different lengths");
  for (const Attribute& a : p.attributes)
    require(a.components > 0 && !a.name.empty() && a.size() == n * a.components, "an attribute of other points");
  for (const Attribute& a : p.triangle_attributes)
    require(a.components > 0 && !a.name.empty() && a.size() == p.triangles.size() * a.components,
            "an attribute of other triangles");
  for (const Vec3f& x : p.positions) require(is_finite(x), "a position is not finite");
  for (const Vec3f& x : p.normals) require(is_finite(x), "a normal is not finite");
  for (const auto& t : p.triangles)
    for (const std::uint32_t v : t) require(v < n, "a triangle of points that are not there");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using Reader = PointSet (*)(const io::Input&);
  static constexpr Reader readers[] = {io::read_ply,   io::read_obj, io::read_off, io::read_stl,
                                       io::read_table, io::read_pcd, io::read_las, io::read_vtp};
  static const std::string name = "fuzz.file";
  if (size < 2) return 0;  // readers are never given nothing
  const ThreadScope one(1);
  // A copy of its own, so that the address sanitizer sees each byte beyond its end.
  const std::unique_ptr<char[]> bytes(new char[size - 1]);
  std::copy(data + 1, data + size, bytes.get());
  ReadReport report;
  const io::Input in{name, {bytes.get(), size - 1}, report};
  try {
    check(readers[data[0] % std::size(readers)](in));
    for (const std::string& warning : report.warnings) require(is_clean(warning), "a warning that is not printable");
  } catch (const FileError& error) {
    const std::string what = error.what();
    require(what.starts_with("fuzz.file: "), "an error that does not name the file");
    require(is_clean(what), "an error that is not printable");
    require(what.size() < 5000, "an error as long as a file");
  }
  return 0;
}
