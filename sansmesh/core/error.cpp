#include "sansmesh/error.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace sansmesh::inline v1 {
namespace {

/// Largest number of characters of a cause: enough for any message of the library with a few excerpts of a file.
constexpr std::size_t kLongestCause = 600;

/// Length in bytes of the first character of `text` if it is printable on one line; 0 for invalid UTF-8 (RFC 3629), a
/// control character (C0, DEL, C1) or a line break.
std::size_t showable(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  const std::uint32_t first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7f ? 1 : 0;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
  std::uint32_t code = first & (0xffu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3f);
  }
  constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool character = code >= least[length] && code <= 0x10ffff && !(code >= 0xd800 && code <= 0xdfff);
  return character && code >= 0xa0 && code != 0x2028 && code != 0x2029 ? length : 0;
}

}  // namespace

std::string printable(std::string_view text, std::size_t most) {
  constexpr std::string_view dots = "…", digits = "0123456789abcdef";
  // Only the ends of a long excerpt are needed: a character has at most four bytes.
  std::string ends;
  if (most < text.size() / 8) {
    ends = std::string(text.substr(0, 4 * most + 4)) + std::string(text.substr(text.size() - 4 * most - 4));
    text = ends;
  }
  std::string result;
  std::vector<std::size_t> begins;  // start of each character, escaped or not, in the result
  while (!text.empty()) {
    begins.push_back(result.size());
    const std::size_t length = showable(text);
    if (length > 0) {
      result += text.substr(0, length);
    } else {
      const auto byte = static_cast<unsigned char>(text[0]);
      ((result += "\\x") += digits[byte >> 4]) += digits[byte & 15];
    }
    text.remove_prefix(std::max<std::size_t>(1, length));
  }
  if (begins.size() <= most) return result;
  if (most == 0) return {};
  // The beginning is most informative, but a comment on an excerpt is at its end.
  const std::size_t tail = (most - 1) / 3, head = most - 1 - tail;
  const std::string end = tail == 0 ? std::string() : result.substr(begins[begins.size() - tail]);
  return result.substr(0, begins[head]).append(dots) + end;
}

namespace {

std::string words_of(const ArgumentFault& fault) {
  return "`" + fault.field + "` must be " + fault.allowed + (fault.value.empty() ? "" : ", not " + fault.value) +
         (fault.remedy.empty() ? "" : ": " + fault.remedy);
}

}  // namespace

ArgumentError::ArgumentError(const ArgumentFault& fault) : Error(words_of(fault)), fault_(fault) {}

FileError::FileError(const std::string& file, const std::string& cause)
    : Error(printable(file) + ": " + printable(cause, kLongestCause)), file_(file) {}

}  // namespace sansmesh::inline v1
