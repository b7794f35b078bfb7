// Command line options generated from schemas of option structs.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/option.h"

namespace sansmesh::cli {

class CommandLine;

/// Selection and layout of options.
struct SchemaOptions {
  std::string group = "Options";               ///< heading in the help
  std::vector<std::string_view> only = {};     ///< names of rows; all if empty
  std::vector<std::string_view> without = {};  ///< names of rows to leave out
  /// Text before the description of a row: the methods that use it.
  std::function<std::string(std::string_view)> before = nullptr;
};

/// Adds an option for each row, --max-degree for `max_degree`. A flag that is on by default has its negation,
/// --no-enhance; one that is derived from the data has both. `options` must live until the command has run; its current
/// values become the defaults in the help. Throws std::logic_error for unknown rows.
void add_schema(CommandLine& command, const OptionSchema& schema, void* options, const SchemaOptions& how = {});
template <HasSchema T>
void add_schema(CommandLine& command, T& options, const SchemaOptions& how = {}) {
  add_schema(command, T::schema(), &options, how);
}

/// Calls `call`; error messages of the library name the option as it was typed. Throws ValueError.
void with_flags_in_errors(const std::function<void()>& call);

/// Replaces field names by flags in descriptions of options. Called once a command has all of its options.
void name_flags(CommandLine& command);

}  // namespace sansmesh::cli
