#include "sansmesh/io/section_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/output.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace sansmesh::inline v1 {
namespace {

/// Not text (0x89), and damaged by any conversion of line ends.
std::array<char, 8> magic_of(const SectionFormat& format) {
  const std::string_view s = format.letters;
  return {'\x89', s[0], s[1], s[2], '\r', '\n', '\x1a', '\n'};
}

constexpr std::size_t kAlignment = 64, kMostSections = 256;

struct Header {
  char magic[8];
  std::uint32_t major, minor;
  std::uint64_t file_size;
  std::uint32_t sections;
  std::uint32_t unused[7];
  std::uint64_t checksum;  ///< checksum of all bytes before it and of the table after it
};
static_assert(sizeof(Header) == 64);
static_assert(std::endian::native == std::endian::little, "files hold little-endian arrays, as they lie in memory");

struct Entry {
  char name[8];  ///< padded with zeros
  std::uint64_t offset, bytes;
  std::uint32_t element_size, unused;
  std::uint64_t checksum;
};
static_assert(sizeof(Entry) == 40);

std::uint64_t checksum_of(std::string_view bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

std::uint64_t checksum_of(const Header& header, const Entry* table) {
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  XXH3_64bits_update(&state, &header, offsetof(Header, checksum));
  XXH3_64bits_update(&state, table, header.sections * sizeof(Entry));
  return XXH3_64bits_digest(&state);
}

std::size_t aligned(std::size_t n) { return (n + kAlignment - 1) / kAlignment * kAlignment; }

std::string name_of(const Entry& entry) {
  return {entry.name, std::find(entry.name, entry.name + sizeof entry.name, '\0')};
}

bool is_name(std::string_view name) {
  return !name.empty() && name.size() <= 8 && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

}  // namespace

void write_sections(const std::string& file, const std::vector<FileSection>& sections, const SectionFormat& format) {
  if (sections.size() > kMostSections) throw ArgumentError("too many sections for one file");
  std::string head(aligned(sizeof(Header) + sections.size() * sizeof(Entry)), '\0');
  Header header{};
  const auto magic = magic_of(format);
  std::copy(magic.begin(), magic.end(), header.magic);
  header.major = format.major, header.minor = format.minor;
  header.sections = static_cast<std::uint32_t>(sections.size());
  std::vector<Entry> table(sections.size());
  std::size_t at = head.size();
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const FileSection& s = sections[i];
    const bool twice = std::any_of(sections.begin(), sections.begin() + static_cast<std::ptrdiff_t>(i),
                                   [&](const FileSection& other) { return other.name == s.name; });
    if (twice) throw ArgumentError(fmt::format("there are two sections of the name {}", s.name));
    if (!is_name(s.name) || s.element_size == 0 || s.bytes.size() % s.element_size != 0)
      throw ArgumentError(fmt::format("'{}' cannot be the name of a section of elements of {} bytes each, {} in all",
                                      s.name, s.element_size, s.bytes.size()));
    Entry& e = table[i];
    e = {};
    std::copy(s.name.begin(), s.name.end(), e.name);
    e.offset = at, e.bytes = s.bytes.size(), e.element_size = s.element_size;
    at = aligned(at + s.bytes.size());
  }
  parallel_for(0, table.size(), 1, [&](std::size_t i) { table[i].checksum = checksum_of(sections[i].bytes); });
  header.file_size = at;
  header.checksum = checksum_of(header, table.data());
  std::memcpy(head.data(), &header, sizeof header);
  if (!table.empty()) std::memcpy(head.data() + sizeof header, table.data(), table.size() * sizeof(Entry));

  static constexpr std::array<char, kAlignment> zeros{};
  std::vector<std::string_view> parts{head};
  for (const FileSection& s : sections) {
    parts.push_back(s.bytes);
    parts.emplace_back(zeros.data(), aligned(s.bytes.size()) - s.bytes.size());
  }
  io::write_parts(file, parts);
}

SectionFile::SectionFile(const std::string& file, const SectionFormat& format) : file_(file) {
  auto content = std::make_shared<const io::FileContent>(file);
  open(content->bytes(), format);
  owner_ = std::move(content);
}

SectionFile::SectionFile(const std::string& name, std::shared_ptr<const void> owner, std::string_view bytes,
                         const SectionFormat& format)
    : file_(name), owner_(std::move(owner)) {
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % 16 != 0)
    throw ArgumentError("the bytes of a file of sections must be aligned to 16");
  open(bytes, format);
}

void SectionFile::open(std::string_view bytes, const SectionFormat& format) {
  const auto fail = [&](const std::string& cause) { throw FileError(file_, cause); };

  Header header;
  const auto magic = magic_of(format);
  if (bytes.size() < magic.size() || std::memcmp(bytes.data(), magic.data(), magic.size()) != 0)
    fail(bytes.size() >= magic.size() && bytes.substr(1, 3) == format.letters
             ? "damaged: its line ends were changed"
             : fmt::format("is not a {}", format.words));
  if (bytes.size() < sizeof header) fail(fmt::format("truncated: it ends after {} bytes", bytes.size()));
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.major > format.major)
    fail(fmt::format("was written by a newer version of sansmesh (format {}.{}, this one reads up to {}.x)",
                     header.major, header.minor, format.major));
  if (header.major == 0 || header.sections > kMostSections) fail("damaged: its header is invalid");
  const std::size_t table_end = sizeof header + header.sections * sizeof(Entry);
  if (bytes.size() < table_end) fail("truncated: its table of contents is not complete");
  std::vector<Entry> table(header.sections);
  if (!table.empty()) std::memcpy(table.data(), bytes.data() + sizeof header, table.size() * sizeof(Entry));
  if (checksum_of(header, table.data()) != header.checksum) fail("damaged: the checksum of its header is wrong");
  if (bytes.size() < header.file_size)
    fail(fmt::format("truncated: {} bytes are missing", grouped(header.file_size - bytes.size())));
  if (bytes.size() != header.file_size)
    fail(fmt::format("damaged: {} bytes follow after its end", grouped(bytes.size() - header.file_size)));

  std::uint64_t all = 0;
  for (const Entry& e : table) {
    const std::string name = name_of(e);
    if (!is_name(name) || find(name) || e.element_size == 0 || e.bytes % e.element_size != 0 ||
        e.offset % kAlignment != 0 || e.offset < table_end || e.offset > bytes.size() ||
        e.bytes > bytes.size() - e.offset)
      fail("damaged: its table of contents is invalid");
    all += e.bytes;
    if (all > bytes.size()) fail("damaged: its sections overlap");
    sections_.push_back({name, e.element_size, bytes.substr(e.offset, e.bytes)});
  }
  std::vector<std::uint8_t> right(table.size());
  parallel_for(0, table.size(), 1,
               [&](std::size_t i) { right[i] = checksum_of(sections_[i].bytes) == table[i].checksum; });
  for (std::size_t i = 0; i < right.size(); ++i)
    if (!right[i]) fail(fmt::format("damaged: the checksum of section {} is wrong", sections_[i].name));
}

const FileSection* SectionFile::find(std::string_view name) const {
  for (const FileSection& s : sections_)
    if (s.name == name) return &s;
  return nullptr;
}

std::string_view SectionFile::bytes_of(std::string_view name, std::size_t element_size) const {
  const FileSection* section = find(name);
  if (!section) throw FileError(file_, fmt::format("has no section {}", name));
  if (section->element_size != element_size)
    throw FileError(
        file_, fmt::format("elements of section {} have {} bytes, not {}", name, section->element_size, element_size));
  return section->bytes;
}

}  // namespace sansmesh::inline v1
