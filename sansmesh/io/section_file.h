// Container of function and volume files: named arrays as they are in memory. docs/formats/smf.md describes the bytes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "sansmesh/core/shared_array.h"

namespace sansmesh::inline v1 {

/// One array of a file. Names have 1 to 8 characters of A–Z, 0–9 and _.
struct FileSection {
  std::string name;
  std::uint32_t element_size = 1;  ///< bytes
  std::string_view bytes;          ///< a multiple of element_size
};

template <class T>
FileSection section_of(const std::string& name, std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {name, sizeof(T), {reinterpret_cast<const char*>(values.data()), values.size_bytes()}};
}

/// A kind of section file.
struct SectionFormat {
  std::string_view letters;  ///< three letters at the beginning of the file: "SMF"
  std::string_view words;    ///< for messages: "function file (.smf)"
  std::uint32_t major = 1;   ///< readers reject files of a larger one
  std::uint32_t minor = 0;
};
inline constexpr SectionFormat kFunctionSections{"SMF", "function file (.smf)", 1, 2};
inline constexpr SectionFormat kVolumeSections{"SMV", "fitted volume (.smv)", 1, 1};

/// Writes the sections atomically, each with a checksum and aligned to 64 bytes. Throws FileError.
void write_sections(const std::string& file, const std::vector<FileSection>& sections,
                    const SectionFormat& format = kFunctionSections);

/// A section file, mapped into memory (decompressed if it is gzipped) and checked: every returned byte belongs to a
/// section with a correct checksum.
class SectionFile {
 public:
  /// Throws FileError if the file is missing, not of this kind, of a newer version, truncated or damaged.
  explicit SectionFile(const std::string& file, const SectionFormat& format = kFunctionSections);
  /// The same from bytes in memory, aligned to 16 and unchanged while `owner` exists; `name` is for messages.
  SectionFile(const std::string& name, std::shared_ptr<const void> owner, std::string_view bytes,
              const SectionFormat& format = kFunctionSections);

  const std::string& file() const { return file_; }
  bool has(std::string_view name) const { return find(name) != nullptr; }

  /// The elements of a section without a copy; the array keeps the file mapped. Throws FileError if the section is
  /// missing or its elements have another size than T.
  template <class T>
  SharedArray<T> array(std::string_view name) const {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= 16);
    const std::string_view bytes = bytes_of(name, sizeof(T));
    return {std::span(reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)), owner_};
  }
  /// The same for single bytes.
  std::string_view text(std::string_view name) const { return bytes_of(name, 1); }

 private:
  void open(std::string_view bytes, const SectionFormat& format);
  const FileSection* find(std::string_view name) const;
  std::string_view bytes_of(std::string_view name, std::size_t element_size) const;

  std::string file_;
  std::shared_ptr<const void> owner_;
  std::vector<FileSection> sections_;
};

}  // namespace sansmesh::inline v1
