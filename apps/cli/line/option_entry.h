// One option as the table of the command line has it: parsing, help, shell completion and the manual page all read it.
#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "sansmesh/option.h"

namespace sansmesh::cli {

/// What is wrong with the value of an option.
struct ValueError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct OptionEntry {
  enum class Kind { flag, text, whole, real };

  std::vector<std::string> names;  ///< as they are typed, "-o", "--output"; one without dashes is told from its place
  std::vector<std::string> old_names;  ///< understood, but warned of: neither help nor completion has them
  std::string what;                    ///< one line
  Kind kind = Kind::flag;
  std::string value_name = "VALUE";
  std::string group = "Options";
  std::vector<std::string> words;                             ///< the only ones that are taken; any if there are none
  enum class File { none, read, written } file = File::none;  ///< whether its value names one
  std::vector<std::string> endings;                           ///< of these, with dots; any if there are none
  bool required = false;
  bool advanced = false;               ///< in this command: help names it, and shows it where all is asked for
  bool repeated = false;               ///< may be given several times
  bool in_order = false;               ///< used once for each time that it was given, in turn with others of that kind
  bool several = false;                ///< takes words as long as there are some that fit
  int numbers = 0;                     ///< so many numbers in one word, with commas between them, or in as many words
  std::optional<OptionRange> range;    ///< of numbers
  std::string excludes;                ///< an option that cannot be given as well
  std::optional<std::string> implied;  ///< stands for a value where none is given
  /// With `implied`: what the next word must be, beside a number or one of `words`, to be the value.
  std::vector<std::string> next_words;
  /// Takes the values of all times that it was given, one at least unless it is a flag. Throws ValueError.
  std::function<void(const std::vector<std::string>&)> use;

  // For an option that is made from a row of a schema (schema_options.h):
  /// Its name in messages of the library: the field, or "open = false" for the flag that sets it so.
  std::string field;
  const OptionRow* row = nullptr;
  std::string usual;  ///< its value where it is not given; empty if that follows from the data

  // What the command line had.
  std::string typed;                ///< the name by which it was given; empty if it was not
  std::vector<std::string> values;  ///< words, or numbers where one word has several of them

  bool positional() const { return names[0][0] != '-'; }
  /// "--output", or the name of what is told from its place.
  const std::string& name() const { return names.back(); }
  bool is_file() const { return file != File::none; }
};

}  // namespace sansmesh::cli
