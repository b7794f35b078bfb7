#include "sansmesh/io/input.h"

#include <fmt/core.h>

#include "sansmesh/core/number_words.h"

namespace sansmesh::inline v1::io {
namespace {

std::string missing_words(std::uint64_t bytes, bool at_least) {
  return fmt::format("truncated: {}{} byte{} missing", at_least ? "at least " : "", grouped(bytes),
                     bytes == 1 ? " is" : "s are");
}

}  // namespace

void Input::fail_truncated(std::uint64_t missing_bytes, bool at_least) const {
  fail(missing_words(missing_bytes, at_least));
}

void Input::fail_short(std::uint64_t announced_bytes, std::uint64_t held_bytes, bool at_least) const {
  fail(fmt::format("{} (of {}, {} {} there)", missing_words(announced_bytes - held_bytes, at_least),
                   grouped(announced_bytes), grouped(held_bytes), held_bytes == 1 ? "is" : "are"));
}

}  // namespace sansmesh::inline v1::io
