// Independent implementation of the container of function files, in memory and without checks, for tests and fuzzing
// with files that are wrong in one place. Follows docs/formats/smf.md, not the library.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace sansmesh::test {

inline constexpr std::size_t kHeaderBytes = 64, kEntryBytes = 40, kSectionAlignment = 64;
/// Offsets in the header and in a table entry.
inline constexpr std::size_t kMajorAt = 8, kMinorAt = 12, kFileSizeAt = 16, kSectionsAt = 24, kChecksumAt = 56;
inline constexpr std::size_t kEntryOffsetAt = 8, kEntryBytesAt = 16, kEntryElementAt = 24, kEntryChecksumAt = 32;

struct RawSection {
  std::string name;
  std::uint32_t element_size = 1;
  std::string bytes;
};

template <class T>
T number_at(std::string_view bytes, std::size_t at) {
  T value{};
  if (at + sizeof(T) <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}
template <class T>
void put_number(std::string& bytes, std::size_t at, T value) {
  if (at + sizeof(T) <= bytes.size()) std::memcpy(bytes.data() + at, &value, sizeof(T));
}

/// Recomputes all checksums: of the sections within the file, then of header and table.
inline void mend_checksums(std::string& bytes) {
  if (bytes.size() < kHeaderBytes) return;
  const std::size_t count =
      std::min<std::size_t>(number_at<std::uint32_t>(bytes, kSectionsAt), (bytes.size() - kHeaderBytes) / kEntryBytes);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t entry = kHeaderBytes + i * kEntryBytes;
    const auto offset = number_at<std::uint64_t>(bytes, entry + kEntryOffsetAt);
    const auto size = number_at<std::uint64_t>(bytes, entry + kEntryBytesAt);
    if (offset > bytes.size() || size > bytes.size() - offset) continue;
    put_number<std::uint64_t>(bytes, entry + kEntryChecksumAt, XXH3_64bits(bytes.data() + offset, size));
  }
  std::string covered = bytes.substr(0, kChecksumAt) + bytes.substr(kHeaderBytes, count * kEntryBytes);
  put_number<std::uint64_t>(bytes, kChecksumAt, XXH3_64bits(covered.data(), covered.size()));
}

/// File with these sections and the given magic letters and minor version.
inline std::string packed(const std::vector<RawSection>& sections, std::string_view letters = "SMF",
                          std::uint32_t minor = 2) {
  const auto pad = [](std::string& s) {
    s.resize((s.size() + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment);
  };
  std::string file(kHeaderBytes + sections.size() * kEntryBytes, '\0');
  std::memcpy(file.data(), "\x89SMF\r\n\x1a\n", 8);
  std::memcpy(file.data() + 1, letters.data(), 3);
  put_number<std::uint32_t>(file, kMajorAt, 1);
  put_number<std::uint32_t>(file, kMinorAt, minor);
  put_number<std::uint32_t>(file, kSectionsAt, static_cast<std::uint32_t>(sections.size()));
  pad(file);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const std::size_t entry = kHeaderBytes + i * kEntryBytes;
    std::memcpy(file.data() + entry, sections[i].name.data(), std::min<std::size_t>(8, sections[i].name.size()));
    put_number<std::uint64_t>(file, entry + kEntryOffsetAt, file.size());
    put_number<std::uint64_t>(file, entry + kEntryBytesAt, sections[i].bytes.size());
    put_number<std::uint32_t>(file, entry + kEntryElementAt, sections[i].element_size);
    file += sections[i].bytes;
    pad(file);
  }
  put_number<std::uint64_t>(file, kFileSizeAt, file.size());
  mend_checksums(file);
  return file;
}

/// Sections of a file that are within its size.
inline std::vector<RawSection> unpacked(std::string_view bytes) {
  std::vector<RawSection> sections;
  if (bytes.size() < kHeaderBytes) return sections;
  const std::size_t count =
      std::min<std::size_t>(number_at<std::uint32_t>(bytes, kSectionsAt), (bytes.size() - kHeaderBytes) / kEntryBytes);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t entry = kHeaderBytes + i * kEntryBytes;
    const auto offset = number_at<std::uint64_t>(bytes, entry + kEntryOffsetAt);
    const auto size = number_at<std::uint64_t>(bytes, entry + kEntryBytesAt);
    if (offset > bytes.size() || size > bytes.size() - offset) continue;
    const std::string_view name = bytes.substr(entry, 8);
    sections.push_back({std::string(name.substr(0, name.find('\0'))),
                        number_at<std::uint32_t>(bytes, entry + kEntryElementAt),
                        std::string(bytes.substr(offset, size))});
  }
  return sections;
}

}  // namespace sansmesh::test
