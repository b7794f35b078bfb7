// Notes of jobs.
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "sansmesh/note.h"

namespace sansmesh::test {

inline bool has_note(const std::vector<Note>& notes, std::string_view code) {
  return std::any_of(notes.begin(), notes.end(), [&](const Note& n) { return n.code == code; });
}

}  // namespace sansmesh::test
