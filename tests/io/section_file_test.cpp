#include "sansmesh/io/section_file.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "io_test_tools.h"
#include "support/any_threads.h"
#include "support/section_bytes.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

const std::vector<double> kNumbers{1.5, -2, 1e300};
const std::vector<std::uint8_t> kOdd{1, 2, 3, 4, 5, 6, 7};

std::vector<FileSection> some_sections() {
  return {section_of("NUMBERS", std::span<const double>(kNumbers)),
          {"EMPTY", 12, {}},
          section_of("ODD_7", std::span<const std::uint8_t>(kOdd)),
          {"TEXT", 1, "a line"}};
}

std::string written(const Folder& folder, const std::vector<FileSection>& sections) {
  write_sections(folder / "made.smf", sections);
  return slurp(folder / "made.smf");
}

class SectionFiles : public ::testing::Test {
 protected:
  void expect_bad(const std::string& bytes, const std::string& part) {
    const std::string file = folder_.put("bad.smf", bytes);
    expect_file_error(file, part, [&] { SectionFile opened(file); });
  }
  /// Changed by `edit`, with all checksums corrected.
  template <class Edit>
  std::string edited(Edit&& edit) {
    std::string bytes = written(folder_, some_sections());
    edit(bytes);
    mend_checksums(bytes);
    return bytes;
  }

  Folder folder_;
};

void expect_some_sections(const SectionFile& file) {
  EXPECT_TRUE(std::ranges::equal(file.array<double>("NUMBERS").view(), kNumbers));
  EXPECT_EQ(file.array<Vec3f>("EMPTY").size(), 0u);
  EXPECT_TRUE(std::ranges::equal(file.array<std::uint8_t>("ODD_7").view(), kOdd));
  EXPECT_EQ(file.text("TEXT"), "a line");
  EXPECT_TRUE(file.has("EMPTY"));
  EXPECT_FALSE(file.has("OTHER"));
  EXPECT_FALSE(file.has(""));
}

TEST_F(SectionFiles, RoundTrip) {
  const std::string bytes = written(folder_, some_sections());
  expect_some_sections(SectionFile(folder_ / "made.smf"));
  // The independent description of the format agrees in every byte.
  std::vector<RawSection> raw;
  for (const FileSection& s : some_sections()) raw.push_back({s.name, s.element_size, std::string(s.bytes)});
  EXPECT_EQ(packed(raw), bytes);
  ASSERT_EQ(unpacked(bytes).size(), 4u);
  EXPECT_EQ(unpacked(bytes)[3].bytes, "a line");
}

TEST_F(SectionFiles, NoSectionsAtAll) {
  EXPECT_EQ(written(folder_, {}).size(), 64u);
  EXPECT_FALSE(SectionFile(folder_ / "made.smf").has("META"));
}

TEST_F(SectionFiles, AlignedAndPaddedWithZeros) {
  const std::string bytes = written(folder_, some_sections());
  EXPECT_EQ(bytes.size() % 64, 0u);
  const std::size_t table_end = kHeaderBytes + 4 * kEntryBytes;
  std::vector<std::uint8_t> used(bytes.size());
  std::fill_n(used.begin(), table_end, 1);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto offset = number_at<std::uint64_t>(bytes, kHeaderBytes + i * kEntryBytes + kEntryOffsetAt);
    EXPECT_EQ(offset % 64, 0u);
    EXPECT_GE(offset, table_end);
    std::fill_n(used.begin() + static_cast<std::ptrdiff_t>(offset),
                number_at<std::uint64_t>(bytes, kHeaderBytes + i * kEntryBytes + kEntryBytesAt), 1);
  }
  for (std::size_t i = 0; i < bytes.size(); ++i) EXPECT_TRUE(used[i] || bytes[i] == '\0') << i;
  const SectionFile file(folder_ / "made.smf");
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(file.array<double>("NUMBERS").data()) % 64, 0u);
}

TEST_F(SectionFiles, ArraysOutliveTheFile) {
  written(folder_, some_sections());
  SharedArray<double> numbers;
  {
    const SectionFile file(folder_ / "made.smf");
    numbers = file.array<double>("NUMBERS");
  }
  std::filesystem::remove(folder_ / "made.smf");
  EXPECT_TRUE(std::ranges::equal(numbers.view(), kNumbers));
}

TEST_F(SectionFiles, Gzipped) {
  write_sections(folder_ / "made.smf.gz", some_sections());
  EXPECT_EQ(slurp(folder_ / "made.smf.gz").substr(0, 2), "\x1f\x8b");
  expect_some_sections(SectionFile(folder_ / "made.smf.gz"));
  const std::string packed_bytes = slurp(folder_ / "made.smf.gz");
  expect_bad(packed_bytes.substr(0, packed_bytes.size() - 9), "");
}

TEST_F(SectionFiles, FromMemory) {
  const std::string bytes = written(folder_, some_sections());
  struct alignas(64) Line {
    char bytes[64];
  };
  const auto owner = std::make_shared<std::vector<Line>>(bytes.size() / 64 + 1);
  char* at = owner->data()->bytes;
  std::copy(bytes.begin(), bytes.end(), at);
  expect_some_sections(SectionFile("memory", owner, {at, bytes.size()}));
  EXPECT_THROW(SectionFile("memory", owner, {at + 1, bytes.size()}), ArgumentError);
  expect_file_error("memory", "truncated", [&] { SectionFile("memory", owner, {at, bytes.size() - 1}); });
}

TEST_F(SectionFiles, OneByteOfHeaderOrTableChanged) {
  const std::string good = written(folder_, some_sections());
  for (std::size_t at = 0; at < kHeaderBytes + 4 * kEntryBytes; ++at)
    for (const int change : {1, 0x80, 0xff}) {
      std::string bytes = good;
      bytes[at] = static_cast<char>(bytes[at] ^ change);
      expect_bad(bytes, "");
      ASSERT_FALSE(HasFailure()) << "byte " << at << " ^ " << change;
    }
}

TEST_F(SectionFiles, OneByteOfASectionChanged) {
  const std::string good = written(folder_, some_sections());
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t entry = kHeaderBytes + i * kEntryBytes;
    const auto offset = number_at<std::uint64_t>(good, entry + kEntryOffsetAt);
    for (std::size_t k = 0; k < number_at<std::uint64_t>(good, entry + kEntryBytesAt); ++k) {
      std::string bytes = good;
      bytes[offset + k] = static_cast<char>(bytes[offset + k] ^ 0x10);
      expect_bad(bytes, "the checksum of section " + some_sections()[i].name);
    }
  }
}

TEST_F(SectionFiles, TruncatedAnywhere) {
  const std::string good = written(folder_, some_sections());
  expect_bad("", "empty");
  for (std::size_t n = 1; n < good.size(); ++n) {
    expect_bad(good.substr(0, n), n < 8 ? "not a function file" : "truncated");
    ASSERT_FALSE(HasFailure()) << n << " bytes";
  }
  expect_bad(good + '\0', "1 bytes follow");
}

TEST_F(SectionFiles, ThroughATextFilter) {
  const std::string good = written(folder_, some_sections());
  const auto replaced = [](std::string s, const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = s.find(from, at)) != std::string::npos; at += to.size())
      s.replace(at, from.size(), to);
    return s;
  };
  expect_bad(replaced(good, "\r\n", "\n"), "line ends");
  expect_bad(replaced(good, "\n", "\r\n"), "line ends");
}

TEST_F(SectionFiles, OtherFiles) {
  expect_bad("ply\nformat ascii 1.0\n", "is not a function file");
  expect_bad(std::string(4096, '\0'), "is not a function file");
  expect_file_error(folder_ / "absent.smf", "no such file", [&] { SectionFile file(folder_ / "absent.smf"); });
  expect_file_error(folder_.path().string(), "directory", [&] { SectionFile file(folder_.path().string()); });
}

TEST_F(SectionFiles, Versions) {
  expect_bad(edited([](std::string& b) { put_number<std::uint32_t>(b, kMajorAt, 2); }), "newer version of sansmesh");
  expect_bad(edited([](std::string& b) { put_number<std::uint32_t>(b, kMajorAt, 0); }), "damaged");
  // A later minor version adds sections; known sections keep their meaning.
  std::vector<FileSection> sections = some_sections();
  sections.push_back({"LATER", 5, "fives"});
  std::string later = written(folder_, sections);
  put_number<std::uint32_t>(later, kMinorAt, 7);
  mend_checksums(later);
  expect_some_sections(SectionFile(folder_.put("later.smf", later)));
}

TEST_F(SectionFiles, TablesThatMakeNoSense) {
  const std::size_t first = kHeaderBytes, second = kHeaderBytes + kEntryBytes;
  const auto with = [&]<class T>(std::size_t at, T value) {
    return edited([&](std::string& b) { put_number(b, at, value); });
  };
  const std::string good = written(folder_, some_sections());
  const std::uint64_t huge = ~std::uint64_t{0};
  expect_bad(with(kSectionsAt, std::uint32_t{257}), "damaged");
  expect_bad(with(kSectionsAt, std::uint32_t{0xffffffff}), "damaged");
  expect_bad(with(kSectionsAt, std::uint32_t{200}), "truncated");
  expect_bad(with(kFileSizeAt, huge), "truncated");
  expect_bad(with(kFileSizeAt, std::uint64_t{0}), "follow after its end");
  expect_bad(with(first + kEntryOffsetAt, std::uint64_t{65}), "table of contents");
  expect_bad(with(first + kEntryOffsetAt, std::uint64_t{64}), "table of contents");  // in the table itself
  expect_bad(with(first + kEntryOffsetAt, std::uint64_t{0}), "table of contents");
  expect_bad(with(first + kEntryOffsetAt, huge - 63), "table of contents");
  expect_bad(with(first + kEntryOffsetAt, std::uint64_t{good.size() + 64}), "table of contents");
  expect_bad(with(first + kEntryBytesAt, huge - 7), "table of contents");
  expect_bad(with(first + kEntryBytesAt, std::uint64_t{good.size()}), "table of contents");
  expect_bad(with(first + kEntryElementAt, std::uint32_t{0}), "table of contents");
  expect_bad(with(first + kEntryElementAt, std::uint32_t{7}), "table of contents");
  for (const char bad : {'\0', ' ', 'a', '-', '\x80'}) expect_bad(with(first, bad), "table of contents");
  // Two sections of one name.
  expect_bad(edited([&](std::string& b) { std::copy_n(b.begin() + first, 8, b.begin() + second); }),
             "table of contents");
  // Sections may share bytes: both have correct checksums.
  const std::string shared = edited([&](std::string& b) {
    std::copy_n(b.begin() + first + kEntryOffsetAt, 16, b.begin() + second + kEntryOffsetAt);
  });
  const SectionFile opened(folder_.put("shared.smf", shared));
  EXPECT_EQ(opened.array<Vec3f>("EMPTY").size(), 2u);
}

TEST_F(SectionFiles, WrongNameOrElement) {
  written(folder_, some_sections());
  const SectionFile file(folder_ / "made.smf");
  expect_file_error(file.file(), "has no section OTHER", [&] { file.array<float>("OTHER"); });
  expect_file_error(file.file(), "elements of section NUMBERS have 8 bytes, not 4",
                    [&] { file.array<float>("NUMBERS"); });
  expect_file_error(file.file(), "NUMBERS", [&] { file.text("NUMBERS"); });
}

TEST_F(SectionFiles, WritesOnlyWhatCanBeRead) {
  for (const char* name : {"", "lower", "NINECHARS", "A B", "Ä"})
    EXPECT_THROW(write_sections(folder_ / "x.smf", {{name, 1, "abc"}}), ArgumentError) << name;
  EXPECT_THROW(write_sections(folder_ / "x.smf", {{"TWICE", 1, "a"}, {"TWICE", 1, "b"}}), ArgumentError);
  EXPECT_THROW(write_sections(folder_ / "x.smf", {{"ODD", 2, "abc"}}), ArgumentError);
  EXPECT_THROW(write_sections(folder_ / "x.smf", {{"ZERO", 0, "abc"}}), ArgumentError);
  EXPECT_THROW(write_sections(folder_ / "x.smf", std::vector<FileSection>(257, FileSection{"A", 1, ""})),
               ArgumentError);
  EXPECT_THROW(write_sections(folder_ / "absent/x.smf", some_sections()), FileError);
  EXPECT_EQ(folder_.entries(), 0u);
}

TEST_F(SectionFiles, SameBytesWhateverTheThreads) {
  std::vector<std::vector<float>> arrays(20, std::vector<float>(5000));
  std::vector<FileSection> sections;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    std::fill(arrays[i].begin(), arrays[i].end(), static_cast<float>(i));
    sections.push_back(section_of(std::string("A").append(std::to_string(i)), std::span<const float>(arrays[i])));
  }
  expect_equal_for_any_threads([&] { return written(folder_, sections); });
}

}  // namespace
}  // namespace sansmesh::inline v1
