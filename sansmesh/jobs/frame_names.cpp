#include "sansmesh/jobs/frame_names.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>

#include "sansmesh/core/read_text.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

namespace {

void check_holds_several(const std::string& file) {
  if (file.starts_with(kStandardOutput)) throw ArgumentError("standard output can hold only one file");
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
  return place_name(file, fmt::format("{:0{}}", number, width));
}

std::string place_name(const std::string& file, const std::string& place) {
  check_holds_several(file);
  const std::filesystem::path path(file);
  std::string name = path.filename().string();
  std::string endings = path.extension().string();
  std::filesystem::path stem = path.stem();
  if (endings == ".gz" || endings == ".GZ") endings = stem.extension().string() + endings, stem = stem.stem();
  if (stem.extension() == ".copc") endings = ".copc" + endings;
  name.resize(name.size() - endings.size());
  return (path.parent_path() / fmt::format("{}_{}{}", name, place, endings)).string();
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
