// COPC: LAZ whose chunks are the nodes of an octree. Files with its ending are recognised as LAZ by their content.
#include "sansmesh/io/formats.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/readers.h"

namespace sansmesh::inline v1 {
namespace {

constexpr FormatInfo kCopcFormats[] = {{.name = "COPC",
                                        .endings = "copc.laz",
                                        .reads = kPoints,
                                        .written = {{{"copc.laz", kPoints}}},
                                        .read_points = io::read_las,
                                        .selects = true,
                                        .write_points = io::points_to_copc,
                                        .points_capacity = FormatCapacity::all_but_normals,
                                        .system_capacity = SystemCapacity::records_of_text}};

}  // namespace

std::span<const FormatInfo> copc_formats() { return kCopcFormats; }

}  // namespace sansmesh::inline v1
