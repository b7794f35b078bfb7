#include "sansmesh/io/names.h"

#include <filesystem>

namespace sansmesh::inline v1::io {

std::string lower(std::string_view s) {
  std::string r(s);
  for (char& c : r) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return r;
}

std::string ending(const std::string& file) {
  std::string name = lower(std::filesystem::path(file).filename().string());
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  const std::size_t dot = name.rfind('.');
  return dot == std::string::npos ? std::string() : name.substr(dot + 1);
}

}  // namespace sansmesh::inline v1::io
