#include "sansmesh/core/similar_words.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <utility>

namespace sansmesh::inline v1 {
namespace {

std::string plain(const std::string& word) {
  std::string text;
  for (const char c : word) text += c == '_' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Least number of letters to omit, insert or replace, or of neighbours to swap (edit distance).
std::size_t typing_errors(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, last, row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = last, last = row;
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

/// Leading dashes, common to all options, do not count as similarity.
std::string without_dashes(const std::string& word) {
  return word.substr(std::min(word.find_first_not_of('-'), word.size()));
}

}  // namespace

int word_distance(const std::string& mistyped, const std::string& known) {
  const std::string a = without_dashes(plain(mistyped)), b = without_dashes(plain(known));
  if (a.empty() || b.empty()) return -1;
  if (a.size() == 1 && mistyped[0] == '-' && a[0] == b[0]) return 4;  // a short option: -v
  if (a == b) return 0;
  const std::size_t errors = typing_errors(a, b), shorter = std::min(a.size(), b.size());
  if (errors <= (shorter <= 4 ? 1U : shorter <= 7 ? 2U : 3U) && errors < shorter) return static_cast<int>(errors);
  if (a.size() >= 3 && b.starts_with(a)) return 4;
  if (b.size() >= 3 && a.starts_with(b)) return 5;
  if (a.size() >= 4 && b.find(a) != std::string::npos) return 6;
  if (b.size() >= 4 && a.find(b) != std::string::npos) return 7;
  return -1;
}

std::string joined_by_or(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return text;
}

std::vector<std::string> similar_words(const std::string& mistyped, const std::vector<std::string>& known) {
  std::vector<std::pair<int, std::string>> found;
  for (const std::string& word : known)
    if (const int distance = word_distance(mistyped, word); distance >= 0) found.emplace_back(distance, word);
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> words;
  for (const auto& [distance, word] : found) {
    // Prefix matches do not help beside a word that is only one or two letters off.
    if (words.size() == 3 || (found[0].first < 4 && distance > found[0].first + 1)) break;
    if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
  }
  return words;
}

std::string did_you_mean(const std::string& mistyped, const std::vector<std::string>& known) {
  const std::vector<std::string> words = similar_words(mistyped, known);
  return words.empty() ? "" : " (did you mean " + joined_by_or(words) + "?)";
}

}  // namespace sansmesh::inline v1
