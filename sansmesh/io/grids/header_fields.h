// Headers of images in text: fields with values, and the files that these name.
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
  /// The value of the first of these names (lower case) that is there.
  const std::string* find(std::initializer_list<std::string_view> names) const;
  /// Numbers of a field, `count` of them (any number if 0); nothing where it is not there. Throws FileError otherwise.
  std::optional<std::vector<double>> numbers(std::initializer_list<std::string_view> names, std::size_t count) const;
  std::optional<std::int64_t> whole(std::initializer_list<std::string_view> names) const;
  bool flag(std::initializer_list<std::string_view> names) const;

 private:
  static std::string lower_name(std::string_view name);
  const Input& in_;
  std::map<std::string, std::string, std::less<>> fields_;
};

/// A name in a header, relative to the folder of the header. Throws FileError where it has more than 1,024 characters.
std::string beside(const Input& in, std::string_view name);

/// The files that a pattern such as "slice%03d.raw 1 90 1" names. Throws FileError where it is not one.
std::vector<std::string> files_of_pattern(const Input& in, const std::string& pattern);

/// The numbers of an image that lie in files of their own, one after the other.
class DataFiles {
 public:
  /// `skip` bytes of each file are left out at its beginning; if it is −1, all but the last `size` / files bytes, where
  /// `size` is that of all numbers. Throws FileError naming the data file.
  DataFiles(const Input& in, const std::vector<std::string>& files, std::int64_t skip, std::uint64_t size);
  std::string_view bytes() const { return bytes_; }
  /// For messages: the data file where there is one, else the header.
  const std::string& name() const { return name_; }

 private:
  std::vector<std::unique_ptr<FileContent>> contents_;
  std::string joined_, name_;
  std::string_view bytes_;
};

}  // namespace sansmesh::inline v1::io
