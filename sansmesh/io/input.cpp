#include "sansmesh/io/input.h"

#include <fmt/core.h>

#include "sansmesh/core/number_words.h"

namespace sansmesh::io {

void Input::fail_truncated(std::uint64_t missing_bytes, bool at_least) const {
  fail(fmt::format("truncated: {}{} byte{} missing", at_least ? "at least " : "", grouped(missing_bytes),
                   missing_bytes == 1 ? " is" : "s are"));
}

}  // namespace sansmesh::io
