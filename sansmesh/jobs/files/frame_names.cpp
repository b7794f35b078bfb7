#include "sansmesh/jobs/files/frame_names.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "sansmesh/core/read_text.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

namespace {

void check_holds_several(const std::string& file) {
  if (file.starts_with(kStandardOutput)) throw ArgumentError("standard output can hold only one file");
}

/// "a" and ".copc.laz" of "b/a.copc.laz".
std::pair<std::string, std::string> name_and_endings(const std::filesystem::path& path) {
  std::string name = path.filename().string();
  std::string endings = path.extension().string();
  std::filesystem::path stem = path.stem();
  const auto is = [](const std::filesystem::path& ending, std::string_view lower) {
    const std::string text = ending.string();
    return std::equal(text.begin(), text.end(), lower.begin(), lower.end(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
  };
  if (is(endings, ".gz")) endings = stem.extension().string() + endings, stem = stem.stem();
  if (is(stem.extension(), ".copc")) endings = stem.extension().string() + endings;
  name.resize(name.size() - endings.size());
  return {name, endings};
}

}  // namespace

std::string frame_name(const std::string& output, std::size_t frame, int digits) {
  check_holds_several(output);
  const std::filesystem::path path(output);
  return (path.parent_path() /
          fmt::format("{}_{:0{}}{}", path.stem().string(), frame, digits, path.extension().string()))
      .string();
}

std::string motion_frame_name(const std::string& output, std::size_t frame) { return frame_name(output, frame, 4); }

std::string part_name(const std::string& file, std::size_t number, std::size_t parts) {
  const std::size_t width = std::max<std::size_t>(3, std::to_string(parts).size());
  return tile_name(file, fmt::format("{:0{}}", number, width));
}

std::string tile_name(const std::string& file, const std::string& corner) {
  check_holds_several(file);
  const std::filesystem::path path(file);
  const auto [name, endings] = name_and_endings(path);
  return (path.parent_path() / fmt::format("{}_{}{}", name, corner, endings)).string();
}

std::vector<std::string> other_tiles(const std::string& file, const std::vector<std::string>& names) {
  const std::filesystem::path path(file);
  const auto [name, endings] = name_and_endings(path);
  std::set<std::string> known;
  for (const std::string& made : names) known.insert(std::filesystem::path(made).filename().string());
  const auto is_place = [](std::string_view words) {
    for (const bool last : {false, true}) {
      double x = 0;
      const auto [end, error] = std::from_chars(words.data(), words.data() + words.size(), x);
      const auto length = static_cast<std::size_t>(end - words.data());
      if (error != std::errc() || (length == words.size()) != last) return false;
      if (!last && words[length] != '_') return false;
      words.remove_prefix(length + (last ? 0 : 1));
    }
    return true;
  };
  std::vector<std::string> others;
  std::error_code none;
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    const std::string found = entry.path().filename().string();
    if (known.contains(found) || found.size() <= name.size() + 1 + endings.size()) continue;
    if (!found.starts_with(name + "_") || !found.ends_with(endings)) continue;
    if (is_place(std::string_view(found).substr(name.size() + 1, found.size() - name.size() - 1 - endings.size())))
      others.push_back((path.parent_path() / found).string());
  }
  std::sort(others.begin(), others.end());
  return others;
}

void check_inputs_stay(const std::vector<std::string>& inputs, const std::vector<std::string>& results) {
  const auto canonical = [](const std::string& file) {
    std::error_code ignored;
    return std::filesystem::weakly_canonical(file, ignored);
  };
  std::set<std::filesystem::path> known;
  for (const std::string& file : inputs)
    if (!file.empty()) known.insert(canonical(file));
  const auto is_known = [&](const std::string& file) {
    std::error_code ignored;
    // Also finds inputs with another name: links.
    return known.contains(canonical(file)) || std::any_of(known.begin(), known.end(), [&](const auto& input) {
             return std::filesystem::equivalent(input, file, ignored);
           });
  };
  for (const std::string& file : results)
    if (!file.empty() && is_known(file))
      throw FileError(file, "is an input, which a result would overwrite: choose another `output`");
}

}  // namespace sansmesh::inline v1
