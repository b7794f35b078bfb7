// Paths of test data and programs. Only places.cpp is compiled with these absolute paths, so that clones in different
// folders share all other objects of a compiler cache.
#pragma once

#include <string>

namespace sansmesh::test {

/// File of the repository: `name` relative to its root, for example "examples/data/owl.vtp".
std::string source_file(const std::string& name);

/// Cloud or mesh of the shared data beside the checkout; may not exist.
std::string shared_points(const std::string& name);

/// Command line tool of this build; empty if it was not built.
const char* tool();
/// Same tool with the additions of tests/extension/.
const char* extended_tool();

}  // namespace sansmesh::test
