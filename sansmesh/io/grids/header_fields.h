// Text headers of images: fields with values, and the data files that they name.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/attribute_table.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

/// Fields by their names in lower case.
class HeaderFields {
 public:
  explicit HeaderFields(const Input& in) : in_(in) {}

  void set(std::string_view name, std::string_view value) { fields_[lower_name(name)] = std::string(value); }
  /// The value of the first of these names (lower case) that exists.
  const std::string* find(std::initializer_list<std::string_view> names) const;
  /// The numbers of a field: `count` of them, or any number if 0. Empty if the field is missing. Throws FileError if
  /// they are malformed.
  std::optional<std::vector<double>> numbers(std::initializer_list<std::string_view> names, std::size_t count) const;
  std::optional<std::int64_t> whole(std::initializer_list<std::string_view> names) const;
  bool flag(std::initializer_list<std::string_view> names) const;

 private:
  static std::string lower_name(std::string_view name);
  const Input& in_;
  std::map<std::string, std::string, std::less<>> fields_;
};

/// Resolves a name in a header relative to the header's folder. Throws FileError if it has more than 1,024 characters.
std::string beside(const Input& in, std::string_view name);

/// The files of a pattern, for example "slice%03d.raw 1 90 1". Throws FileError if it is malformed.
std::vector<std::string> files_of_pattern(const Input& in, const std::string& pattern);

/// The numbers of an image from separate data files, joined.
class DataFiles {
 public:
  /// Skips `skip` bytes at the beginning of each file; −1: all but the last `size` / files bytes, where `size` is the
  /// size of all numbers. Throws FileError naming the data file.
  DataFiles(const Input& in, const std::vector<std::string>& files, std::int64_t skip, std::uint64_t size);
  std::string_view bytes() const { return bytes_; }
  /// For messages: the data file if there is one, else the header.
  const std::string& name() const { return name_; }

 private:
  std::vector<std::unique_ptr<FileContent>> contents_;
  std::string joined_, name_;
  std::string_view bytes_;
};

}  // namespace sansmesh::inline v1::io
