#include "sansmesh/io/names.h"

#include <filesystem>

#include "sansmesh/core/option_text.h"

namespace sansmesh::inline v1::io {

std::string ending(const std::string& file) {
  std::string name = lower_case(std::filesystem::path(file).filename().string());
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  const std::size_t dot = name.rfind('.');
  return dot == std::string::npos ? std::string() : name.substr(dot + 1);
}

}  // namespace sansmesh::inline v1::io
