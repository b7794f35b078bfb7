#include "sansmesh/io/grids/header_fields.h"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {

std::string HeaderFields::lower_name(std::string_view name) { return lower_case(name); }

const std::string* HeaderFields::find(std::initializer_list<std::string_view> names) const {
  for (const std::string_view name : names) {
    if (const auto it = fields_.find(name); it != fields_.end()) return &it->second;
  }
  return nullptr;
}

std::optional<std::vector<double>> HeaderFields::numbers(std::initializer_list<std::string_view> names,
                                                         std::size_t count) const {
  const std::string* const value = find(names);
  if (!value) return std::nullopt;
  std::vector<double> numbers;
  TextScanner s(*value);
  for (double v = 0; s.number(v);) numbers.push_back(v);
  s.skip_space();
  if (!s.at_end() || (count != 0 && numbers.size() != count)) {
    in_.fail(fmt::format(
        "'{}' of its header {} (\"{}\")", *names.begin(),
        count == 0 ? std::string("must be numbers") : fmt::format("must be {} number{}", count, count == 1 ? "" : "s"),
        value->substr(0, 60)));
  }
  return numbers;
}

std::optional<std::int64_t> HeaderFields::whole(std::initializer_list<std::string_view> names) const {
  const auto v = numbers(names, 1);
  if (!v) return std::nullopt;
  if (v->front() != std::floor(v->front()) || std::abs(v->front()) > 0x1p53)
    in_.fail(fmt::format("'{}' of its header must be a whole number", *names.begin()));
  return static_cast<std::int64_t>(v->front());
}

bool HeaderFields::flag(std::initializer_list<std::string_view> names) const {
  const std::string* const value = find(names);
  if (!value) return false;
  const std::string v = lower_case(*value);
  return v == "true" || v == "1" || v == "t" || v == "yes";
}

std::string beside(const Input& in, std::string_view name) {
  if (name.size() > 1024) in.fail(fmt::format("names a file with {} characters", grouped(name.size())));
  return (std::filesystem::path(in.file).parent_path() / std::filesystem::path(name)).string();
}

std::vector<std::string> files_of_pattern(const Input& in, const std::string& pattern) {
  TextScanner s(pattern);
  const std::string_view name = s.word();
  std::int64_t first = 0, last = 0, step = 1;
  if (!s.number(first) || !s.number(last)) in.fail("its pattern of data files gives no range of numbers");
  if (!s.number(step)) step = 1;
  const std::size_t percent = name.find('%');
  std::size_t d = percent == std::string_view::npos ? percent : percent + 1;
  while (d < name.size() && name[d] >= '0' && name[d] <= '9') ++d;
  if (d >= name.size() || name[d] != 'd' || step == 0 || (last - first) / step > 100000 || (last - first) / step < 0)
    in.fail("its pattern of data files cannot be understood");
  const std::string_view digits = name.substr(percent + 1, d - percent - 1);
  std::size_t width = 0;
  for (const char c : digits) width = std::min<std::size_t>(20, width * 10 + static_cast<std::size_t>(c - '0'));
  std::vector<std::string> files;
  for (std::int64_t n = first; step > 0 ? n <= last : n >= last; n += step) {
    const std::string number =
        digits.starts_with('0') ? fmt::format("{:0{}d}", n, width) : fmt::format("{:{}d}", n, width);
    files.push_back(beside(in, std::string(name.substr(0, percent)) + number + std::string(name.substr(d + 1))));
    // Checks the first file, so that a wrong pattern does not expand to a hundred thousand names.
    std::error_code ignored;
    if (files.size() == 1 && !std::filesystem::exists(files[0], ignored)) throw FileError(files[0], "no such file");
  }
  return files;
}

DataFiles::DataFiles(const Input& in, const std::vector<std::string>& files, std::int64_t skip, std::uint64_t size)
    : name_(files.size() == 1 ? files[0] : in.file) {
  if (files.empty()) in.fail("names no data files");
  const std::uint64_t share = size / files.size();
  for (const std::string& file : files) {
    contents_.push_back(std::make_unique<FileContent>(file));
    std::string_view bytes = contents_.back()->bytes();
    const std::uint64_t skipped = skip >= 0               ? static_cast<std::uint64_t>(skip)
                                  : bytes.size() >= share ? bytes.size() - share
                                                          : 0;
    if (skipped > bytes.size()) throw FileError(file, "truncated: is shorter than the bytes to skip");
    bytes.remove_prefix(skipped);
    if (files.size() == 1) {
      bytes_ = bytes;
    } else {
      if (bytes.size() < share)
        throw FileError(file, fmt::format("truncated: {} bytes are missing", grouped(share - bytes.size())));
      joined_.append(bytes.substr(0, share));
      contents_.pop_back();
      bytes_ = joined_;
    }
  }
}

}  // namespace sansmesh::inline v1::io
