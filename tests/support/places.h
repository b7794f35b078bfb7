// Where tests find what they read and run. Only places.cpp is compiled with these absolute paths, so that clones in
// different folders share every other object of a compiler cache.
#pragma once

#include <string>

namespace sansmesh::test {

/// A file of the repository: `name` relative to its root, say "examples/data/owl.vtp".
std::string source_file(const std::string& name);

/// A cloud or mesh of the shared data beside the checkout, which need not be there.
std::string shared_points(const std::string& name);

/// The command line tool of this build; empty if it was not built.
const char* tool();
/// The same with what tests/extension/ adds to it.
const char* extended_tool();

}  // namespace sansmesh::test
