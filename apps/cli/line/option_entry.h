// One option in the table of the command line, used by parsing, help, shell completion and the manual page.
#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "sansmesh/option.h"

namespace sansmesh::cli {

/// Error in the value of an option.
struct ValueError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct OptionEntry {
  enum class Kind { flag, text, whole, real };

  std::vector<std::string> names;      ///< as typed, "-o", "--output"; a single name without dashes is positional
  std::vector<std::string> old_names;  ///< accepted with a warning; not in help and completion
  std::string what;                    ///< one line
  Kind kind = Kind::flag;
  std::string value_name = "VALUE";
  std::string group = "Options";
  std::vector<std::string> words;                             ///< allowed values; any if empty
  enum class File { none, read, written } file = File::none;  ///< whether the value is a file
  std::vector<std::string> endings;                           ///< allowed endings with dots; any if empty
  bool required = false;
  bool advanced = false;               ///< not in the short help of this command
  bool repeated = false;               ///< may be given several times
  bool in_order = false;               ///< keeps the order of its occurrences among options of this kind
  bool several = false;                ///< takes following words as long as they fit
  int numbers = 0;                     ///< count of numbers in one comma-separated word, or in as many words
  std::optional<OptionRange> range;    ///< range of numbers
  std::string excludes;                ///< option that cannot be given together with this one
  std::optional<std::string> implied;  ///< value if none is given
  /// With `implied`: words, besides numbers and `words`, that are taken as the value.
  std::vector<std::string> next_words;
  /// Receives the values of all occurrences (at least one unless it is a flag). Throws ValueError.
  std::function<void(const std::vector<std::string>&)> use;

  // For an option that is made from a row of a schema (schema_options.h):
  /// Name in messages of the library: the field, or "open = false" for a flag.
  std::string field;
  const OptionRow* row = nullptr;
  std::string usual;  ///< default value; empty if derived from the data

  // Input of the command line.
  std::string typed;                ///< name as typed; empty if not given
  std::vector<std::string> values;  ///< words, or single numbers of a list

  bool positional() const { return names[0][0] != '-'; }
  /// "--output", or the name of a positional argument.
  const std::string& name() const { return names.back(); }
  bool is_file() const { return file != File::none; }
};

}  // namespace sansmesh::cli
