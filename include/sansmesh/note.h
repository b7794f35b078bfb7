// Notes: warnings and information that a job returns beside its result.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::inline v1 {

/// A warning or a piece of information. Its text names options by their fields, between grave accents, as errors do
/// (sansmesh/error.h).
struct Note {
  /// Of no consequence for the result, or to be looked at before it is used.
  enum class Severity : std::uint8_t { information, warning };

  std::string code;                       ///< what it is about, for programs: lower case, stable: "moved_far"
  std::string text;                       ///< one line, without its full stop
  std::string remedy = {};                ///< what may help; empty if nothing is known
  Severity severity = Severity::warning;  ///< whether the result may not be what was wanted
  std::string of = {};                    ///< name of the input that it is about, where a job has several
};

/// The text with the remedy, in brackets, behind it.
inline std::string note_line(const Note& note) {
  return note.remedy.empty() ? note.text : note.text + " (" + note.remedy + ")";
}

/// Appends a warning of this code for each line, without a remedy; `of` names the input. For parts of the library that
/// report sentences only.
inline void add_notes(std::vector<Note>& notes, std::string_view code, const std::vector<std::string>& lines,
                      const std::string& of = {}) {
  for (const std::string& line : lines) notes.push_back({.code = std::string(code), .text = line, .of = of});
}

}  // namespace sansmesh::inline v1
