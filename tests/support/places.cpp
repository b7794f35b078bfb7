#include "support/places.h"

namespace sansmesh::test {

std::string source_file(const std::string& name) { return SANSMESH_SOURCE_DIR "/" + name; }

std::string shared_points(const std::string& name) { return SANSMESH_SOURCE_DIR "/../shared/data/points/" + name; }

const char* tool() { return SANSMESH_CLI; }

const char* extended_tool() { return SANSMESH_EXTENDED_CLI; }

}  // namespace sansmesh::test
