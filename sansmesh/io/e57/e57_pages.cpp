#include "sansmesh/io/e57/e57_pages.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/io/binary.h"
#include "sansmesh/io/e57/crc32c.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr std::uint64_t kPage = 1024, kContent = kPage - 4;
constexpr std::size_t kHeaderSize = 48, kSlack = 16;
constexpr std::size_t kPagesAtOnce = 256;
/// Descriptions of some 15,000 scans.
constexpr std::uint64_t kLongestXml = std::uint64_t{1} << 26;

}  // namespace

E57Pages::E57Pages(const Input& in) : in_(in), pages_(in.bytes.size() / kPage) {
  const std::string_view bytes = in.bytes;
  if (!bytes.starts_with("ASTM-E57")) in.fail("is not an E57 file");
  if (bytes.size() < kHeaderSize) in.fail_truncated(kHeaderSize - bytes.size(), true);
  const auto version = load<std::uint32_t>(bytes.data() + 8);
  if (version != 1)
    in.fail(fmt::format("is of E57 version {}.{}; version 1 is supported", version,
                        load<std::uint32_t>(bytes.data() + 12)));
  if (const auto page = load<std::uint64_t>(bytes.data() + 40); page != kPage)
    in.fail(fmt::format("malformed E57 header: pages of {} bytes (always 1024)", page));
  const auto length = load<std::uint64_t>(bytes.data() + 16);
  if (length > bytes.size()) in.fail_short(length, bytes.size());
  if (length % kPage != 0 || length == 0)
    in.fail(fmt::format("malformed E57 header: a length of {} bytes, which is no number of pages", length));
  pages_ = length / kPage;
  xml_offset_ = load<std::uint64_t>(bytes.data() + 24), xml_length_ = load<std::uint64_t>(bytes.data() + 32);
  read(0, kHeaderSize, "the header");
}

E57Bytes E57Pages::xml() const {
  if (xml_length_ > kLongestXml)
    in_.fail(fmt::format("its XML section has {} bytes; at most {} are supported", grouped(xml_length_),
                         grouped(kLongestXml)));
  return read(xml_offset_, xml_length_, "the XML section");
}

std::uint64_t E57Pages::logical(std::uint64_t offset, const char* what) const {
  const std::uint64_t page = offset / kPage, at = offset % kPage;
  if (page >= pages_ || at >= kContent)
    in_.fail(fmt::format("malformed E57: {} is announced at byte {}, which is {}", what, offset,
                         page >= pages_ ? "behind the end" : "inside a checksum"));
  return page * kContent + at;
}

E57Bytes E57Pages::read(std::uint64_t offset, std::uint64_t length, const char* what) const {
  const std::uint64_t first = logical(offset, what), held = pages_ * kContent - first;
  if (length > held)
    in_.fail(fmt::format("malformed E57: {} has {} bytes at byte {}, where {} follow", what, length, offset, held));
  E57Bytes out{std::make_unique_for_overwrite<char[]>(length + kSlack), static_cast<std::size_t>(length)};
  std::memset(out.data.get() + length, 0, kSlack);
  if (length == 0) return out;
  const std::uint64_t from = first / kContent, to = (first + length - 1) / kContent + 1;
  const std::uint64_t bad = parallel_reduce(
      static_cast<std::size_t>(to - from), kPagesAtOnce, to,
      [&](std::size_t a, std::size_t b) {
        std::uint64_t wrong = to;
        for (std::uint64_t page = from + b; page-- > from + a;) {
          const std::string_view content = in_.bytes.substr(page * kPage, kContent);
          if (crc32c(content) != load<std::uint32_t, true>(content.data() + kContent)) wrong = page;
          const std::uint64_t start = std::max(first, page * kContent),
                              stop = std::min(first + length, (page + 1) * kContent);
          std::memcpy(out.data.get() + (start - first), content.data() + (start - page * kContent), stop - start);
        }
        return wrong;
      },
      [](std::uint64_t a, std::uint64_t b) { return std::min(a, b); });
  if (bad < to)
    in_.fail(fmt::format("damaged: page {} (bytes {} to {}, in {}) does not match its checksum", grouped(bad + 1),
                         bad * kPage, bad * kPage + kPage - 1, what));
  return out;
}

}  // namespace sansmesh::inline v1::io
