#include "sansmesh/io/grids/adf_size.h"

#include <charconv>
#include <cstdint>
#include <string_view>

namespace sansmesh::inline v1::io {

void check_adf_size(const Input& in) {
  constexpr std::size_t kRoot = 12, kBlockDigits = 8, kOffsetDigits = 4;
  const std::string_view head = in.bytes.substr(0, 256);
  const std::size_t at = head.find("AdF4");
  if (at == std::string_view::npos || head.size() < at + 4 + kRoot + kBlockDigits + kOffsetDigits)
    in.fail("truncated or damaged: its header does not state its end");
  const auto number = [&](std::string_view digits) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    if (error != std::errc() || end != digits.data() + digits.size())
      in.fail("damaged: its header does not state its end");
    return value;
  };
  const std::string_view end = head.substr(at + 4 + kRoot);
  const std::uint64_t size =
      4096 * number(end.substr(0, kBlockDigits)) + number(end.substr(kBlockDigits, kOffsetDigits));
  if (in.bytes.size() < size) in.fail_short(size, in.bytes.size());
}

}  // namespace sansmesh::inline v1::io
