// COPC, as it is written. Reading follows from the content: it is LAZ.
#include "sansmesh/io/formats.h"
#include "sansmesh/io/output.h"

namespace sansmesh::inline v1 {
namespace {

constexpr FormatInfo kCopcFormats[] = {{.name = "COPC",
                                        .endings = "copc.laz",
                                        .written = {{{"copc.laz", kPoints}}},
                                        .write_points = io::points_to_copc,
                                        .points_capacity = FormatCapacity::all_but_normals,
                                        .system_capacity = SystemCapacity::records_of_text}};

}  // namespace

std::span<const FormatInfo> copc_formats() { return kCopcFormats; }

}  // namespace sansmesh::inline v1
