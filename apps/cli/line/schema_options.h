// Options of the command line made of the schema of an options struct of the library.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/option.h"

namespace sansmesh::cli {

class CommandLine;

/// Which rows become options, and how.
struct SchemaOptions {
  std::string group = "Options";               ///< heading in the help
  std::vector<std::string_view> only = {};     ///< names of rows; all if there are none
  std::vector<std::string_view> without = {};  ///< names of rows that the command does not have
  /// Put before the sentence of a row, by its name: which methods use it.
  std::function<std::string(std::string_view)> before = nullptr;
};

/// Adds an option for each row, `max_degree` as --max-degree. A flag that is on by itself gets the one that turns it
/// off, --no-enhance; one that follows from the data gets both. `options` must live until the command has run; what it
/// holds when this is called is what help calls the usual value. Throws std::logic_error for names that are no rows.
void add_schema(CommandLine& command, const OptionSchema& schema, void* options, const SchemaOptions& how = {});
template <HasSchema T>
void add_schema(CommandLine& command, T& options, const SchemaOptions& how = {}) {
  add_schema(command, T::schema(), &options, how);
}

/// Calls; what the library says of a value becomes what the command line says, which names the option as it was typed.
/// Throws ValueError.
void in_words_of_the_line(const std::function<void()>& call);

/// Puts flags in the place of fields in what the options say. Called once a command has all of its options.
void name_flags(CommandLine& command);

}  // namespace sansmesh::cli
