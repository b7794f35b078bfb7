// Notes: warnings and information that a job returns with its result.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sansmesh::inline v1 {

/// A warning or a piece of information. Its text names options by their fields, between grave accents, as errors do
/// (sansmesh/error.h).
struct Note {
  /// Information does not affect the result; a warning should be checked before the result is used.
  enum class Severity : std::uint8_t { information, warning };

  std::string code;                       ///< stable identifier of the subject for programs, in lower case: "moved_far"
  std::string text;                       ///< one line, without its full stop
  std::string remedy = {};                ///< suggested remedy; empty if none is known
  Severity severity = Severity::warning;  ///< warning if the result may not be as intended
  std::string of = {};                    ///< name of the input, if the job has several

  bool operator==(const Note&) const = default;  ///< all members are equal
};

/// Text with the remedy in parentheses.
inline std::string note_line(const Note& note) {
  return note.remedy.empty() ? note.text : note.text + " (" + note.remedy + ")";
}

/// Appends notes; `of` names the input of those without a name.
inline void add_notes(std::vector<Note>& notes, std::vector<Note> more, const std::string& of = {}) {
  for (Note& note : more) {
    if (note.of.empty()) note.of = of;
    notes.push_back(std::move(note));
  }
}

/// Appends a warning with this code and no remedy for each line; `of` names the input. For parts of the library that
/// report sentences only.
inline void add_notes(std::vector<Note>& notes, std::string_view code, const std::vector<std::string>& lines,
                      const std::string& of = {}) {
  for (const std::string& line : lines) notes.push_back({.code = std::string(code), .text = line, .of = of});
}

}  // namespace sansmesh::inline v1
