#include "cli/line/suggestions.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "cli/line/option_values.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kMostFiles = 10000;  // most entries of a folder that are compared

}  // namespace

std::string did_you_mean_listed(const std::string& message, std::string mistyped) {
  if (message.find("did you mean") != std::string::npos) return "";
  if (mistyped.empty()) {  // the last word in quotes
    for (const char quote : {'\'', '"'}) {
      const std::size_t end = message.rfind(quote), begin = end == 0 ? end : message.rfind(quote, end - 1);
      if (end != std::string::npos && begin != std::string::npos) mistyped = message.substr(begin + 1, end - begin - 1);
      if (!mistyped.empty()) break;
    }
  }
  std::size_t at = message.find(mistyped);
  if (mistyped.empty() || at == std::string::npos) return "";
  for (const char* const before : {"known are ", "there are ", "holds ", ": "})
    if (const std::size_t list = message.rfind(before); list != std::string::npos && list > at) {
      at = list + std::string(before).size();
      break;
    }
  std::vector<std::string> words;
  while (at < message.size()) {
    const std::size_t end =
        std::min({message.find(", ", at), message.find(" or ", at), message.find(" and ", at), message.size()});
    words.push_back(message.substr(at, end - at));
    at = std::min(message.find_first_not_of(", ", end), message.size());
    for (const char* const joint : {"or ", "and "})
      if (message.compare(at, std::string(joint).size(), joint) == 0) at += std::string(joint).size();
  }
  return words.size() < 2 ? "" : did_you_mean(mistyped, words);
}

std::string did_you_mean_file(const std::string& missing) {
  namespace fs = std::filesystem;
  std::error_code error;
  // The existing part of the path, and the name that is missing.
  fs::path folder = fs::path(missing).parent_path(), name = fs::path(missing).filename();
  while (!folder.empty() && !fs::is_directory(folder, error)) name = folder.filename(), folder = folder.parent_path();
  if (name.empty()) return "";
  std::vector<std::string> names;
  fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, error);
  for (; !error && entry != fs::directory_iterator() && names.size() < kMostFiles; entry.increment(error))
    // Equal endings do not make names similar.
    if (const fs::path known = entry->path().filename();
        known.extension() != name.extension() || word_distance(name.stem().string(), known.stem().string()) >= 0)
      names.push_back(known.string());
  std::sort(names.begin(), names.end());  // the order of folder entries is arbitrary
  std::vector<std::string> shown;
  for (const std::string& known : similar_words(name.string(), names))
    shown.push_back(in_quotes((folder / known).string()));
  return shown.empty() ? "" : " (did you mean " + joined_by_or(shown) + "?)";
}

}  // namespace sansmesh::cli
