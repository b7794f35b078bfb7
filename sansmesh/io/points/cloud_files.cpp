#include "sansmesh/io/points/cloud_files.h"

#include <fmt/core.h>
#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <system_error>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/error.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostListed = 1000000, kLongestLine = 4096, kListStart = 8192;

bool is_folder(const std::string& name) {
  std::error_code none;
  return fs::is_directory(name, none);
}

bool does_exist(const std::string& name) {
  std::error_code none;
  return fs::exists(name, none);
}

/// Text files beside clouds are mostly notes.
bool is_plain_text(const std::string& file) {
  const std::string end = ending(file);
  return end == "txt" || end == "dat" || end == "asc";
}

/// Formats that programs mix in one folder count as one.
std::string format_group(const std::string& file) {
  const FormatInfo* const format = format_of_name(file, kPoints);
  if (!format) return {};
  return format->id == FormatId::laz ? "LAS" : std::string(format->name);
}

/// The name without endings that only state how the points are packed: tile.las, tile.laz, tile.copc.laz, tile.las.gz.
std::string unpacked_name(const std::string& file) {
  fs::path name(file);
  if (lower_case(name.extension().string()) == ".gz") name.replace_extension();
  if (format_group(file) != "LAS") return name.string();
  name.replace_extension();
  if (lower_case(name.extension().string()) == ".copc") name.replace_extension();
  return name.string();
}

/// Throws FileError if two files of a folder or pattern seem to be copies of the same points.
void check_copies(const std::string& name, const std::vector<std::string>& files) {
  std::map<std::string, const std::string*> known;
  for (const std::string& file : files) {
    const auto [other, is_new] = known.emplace(unpacked_name(file), &file);
    if (is_new) continue;
    throw FileError(name, fmt::format("has {} and {}, which seem to be the same points; a pattern or list selects one",
                                      printable(fs::path(*other->second).filename().string(), 200),
                                      printable(fs::path(file).filename().string(), 200)));
  }
}

using FilesByFormat = std::map<std::string, std::vector<std::string>>;

/// Clouds and meshes of a folder.
FilesByFormat clouds_in(const std::string& folder) {
  FilesByFormat by_format;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    std::error_code none;
    if (name.starts_with(".") || !at->is_regular_file(none)) continue;
    if (std::string group = format_group(name); !group.empty())
      by_format[is_plain_text(name) ? "text" : group].push_back(at->path().string());
  }
  if (error) throw FileError(folder, "cannot be listed (" + error.message() + ")");
  if (by_format.size() > 1) by_format.erase("text");
  return by_format;
}

bool is_pattern(const std::string& name) { return name.find_first_of("*?[") != std::string::npos && !does_exist(name); }

/// The pattern that matches the name alone.
std::string pattern_of(std::string_view name) {
  std::string pattern;
  for (const char c : name) {
    if (std::string_view("*?[\\").find(c) != std::string_view::npos) pattern += '\\';
    pattern += c;
  }
  return pattern;
}

std::vector<std::string> files_of_folder(const std::string& folder) {
  FilesByFormat by_format = clouds_in(folder);
  if (by_format.empty())
    throw FileError(folder, "is a folder without points or meshes (" + listed_endings(endings_read(kPoints)) + ")");
  if (by_format.size() > 1) {
    std::string held;
    const std::vector<std::string>* most = nullptr;
    for (const auto& [format, files] : by_format) {
      held += fmt::format("{}{} {}", held.empty() ? "" : ", ", grouped(files.size()), format);
      if (!most || files.size() > most->size()) most = &files;
    }
    throw FileError(folder, fmt::format("is a folder with files of several formats ({}); a pattern selects some: '{}'",
                                        held, (fs::path(pattern_of(folder)) / ("*." + ending((*most)[0]))).string()));
  }
  std::vector<std::string>& files = by_format.begin()->second;
  std::sort(files.begin(), files.end());
  check_copies(folder, files);
  return std::move(files);
}

std::vector<std::string> files_of_pattern(const std::string& pattern) {
  glob_t found = {};
  const int status = ::glob(pattern.c_str(), GLOB_NOSORT, nullptr, &found);
  std::vector<std::string> files;
  for (std::size_t k = 0; status == 0 && k < found.gl_pathc; ++k)
    if (!is_folder(found.gl_pathv[k])) files.emplace_back(found.gl_pathv[k]);
  ::globfree(&found);
  if (files.empty()) throw FileError(pattern, "no file matches the pattern");
  std::sort(files.begin(), files.end());
  check_copies(pattern, files);
  return files;
}

/// Leaves out files that were named before, by whatever path.
void drop_repeated(std::vector<std::string>& files) {
  std::set<std::string> known;
  std::erase_if(files, [&](const std::string& file) {
    std::error_code error;
    const fs::path path = fs::weakly_canonical(file, error);
    return !known.insert(error ? file : path.string()).second;
  });
}

/// A name in a list: beside the list, or from the current folder.
struct ListedName {
  std::string path;
  std::string pattern;  ///< empty if the name is that of a file or folder

  ListedName(const std::string& list, std::string_view name) : path((fs::path(list).parent_path() / name).string()) {
    const std::string here(name);
    if (does_exist(path)) return;
    if (does_exist(here)) {
      path = here;
    } else if (is_pattern(here)) {
      // The name is a pattern, and the folder of the list is none.
      pattern = fs::path(here).is_absolute() ? here : pattern_of(path.substr(0, path.size() - here.size())) + here;
    }
  }
};

/// First line that is no comment; empty if the text is no list.
std::string_view first_name(std::string_view text) {
  TextScanner lines(without_byte_order_mark(text));
  while (!lines.at_end()) {
    const std::string_view line = without_blanks(lines.line());
    if (line.empty() || line.front() == '#') continue;
    return line.size() <= kLongestLine && line.find('\0') == std::string_view::npos ? line : std::string_view();
  }
  return {};
}

bool is_list(const std::string& file) {
  const std::string end = ending(file);
  std::error_code none;
  if (!fs::is_regular_file(file, none)) return false;
  if (end == "lst" || end == "list") return true;
  if (end != "txt") return false;
  std::string start(kListStart, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(stream.gcount()));
  const std::string_view name = first_name(start);
  if (name.empty()) return false;
  const ListedName listed(file, name);
  if (!listed.pattern.empty()) return is_read(listed.path);
  return is_folder(listed.path) || (does_exist(listed.path) && is_read(listed.path));
}

std::vector<std::string> files_of_list(const std::string& list) {
  std::ifstream stream(list, std::ios::binary);
  if (!stream) throw FileError(list, "cannot be read");
  std::vector<std::string> files;
  std::size_t number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::string_view name = without_blanks(number == 1 ? without_byte_order_mark(line) : line);
    if (name.empty() || name.front() == '#') continue;
    if (name.size() > kLongestLine || name.find('\0') != std::string_view::npos)
      throw FileError(list, fmt::format("line {} is no name of a file", grouped(number)));
    const ListedName listed(list, name);
    const std::string& path = listed.path;
    if (is_folder(path) || !listed.pattern.empty()) {
      const std::vector<std::string> more = is_folder(path) ? files_of_folder(path) : files_of_pattern(listed.pattern);
      files.insert(files.end(), more.begin(), more.end());
    } else if (!does_exist(path)) {
      throw FileError(list,
                      fmt::format("line {} names {}, which does not exist", grouped(number), printable(path, 200)));
    } else {
      files.push_back(path);
    }
    if (files.size() > kMostListed) throw FileError(list, "names more than 1,000,000 files");
  }
  if (files.empty()) throw FileError(list, "is a list of files without names");
  return files;
}

}  // namespace

bool is_cloud_folder(const std::string& name) {
  if (!is_folder(name)) return false;
  try {
    const FilesByFormat files = clouds_in(name);
    return !files.empty() && !files.contains("text");
  } catch (const FileError&) {
    return false;
  }
}

std::vector<std::string> list_cloud_files(const std::vector<std::string>& names) {
  std::vector<std::string> all;
  for (const std::string& name : names) {
    std::vector<std::string> files;
    if (is_folder(name))
      files = files_of_folder(name);
    else if (is_pattern(name))
      files = files_of_pattern(name);
    else if (is_list(name))
      files = files_of_list(name);
    else
      files = {name};
    all.insert(all.end(), std::make_move_iterator(files.begin()), std::make_move_iterator(files.end()));
  }
  drop_repeated(all);
  return all;
}

}  // namespace sansmesh::inline v1::io
