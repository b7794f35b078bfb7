// Fuzz target: the parser accepts any command line or rejects it with a one-line error. No command is run. Words are
// separated by line ends; the mutator takes new ones from the table of options.
#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "cli/line/command_table.h"
#include "cli/line/flags.h"
#include "cli/line/help_text.h"
#include "cli/line/parse_line.h"
#include "cli/line/suggestions.h"
#include "target.h"

using namespace sansmesh;
using namespace sansmesh::cli;

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

/// The whole tool, created for each input, since options keep their values.
struct Tool {
  CommonArguments common;
  CommandLine line{"Surfaces and volumes straight from samples.", "sansmesh"};
  std::vector<Command> commands = add_commands(line, common);
};

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    words.emplace_back(text.substr(0, end));
    std::erase(words.back(), '\0');  // not possible in words of a command line
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

void add_words(const CommandLine& line, std::vector<std::string>& words) {
  for (const auto& option : line.options()) {
    for (const std::string& name : option->names)
      if (name[0] == '-') words.push_back(name);
    words.insert(words.end(), option->words.begin(), option->words.end());
  }
  for (const auto& command : line.commands()) {
    words.push_back(command->name());
    add_words(*command, words);
  }
}

const std::vector<std::string>& known_words() {
  static const std::vector<std::string> words = [] {
    std::vector<std::string> all{"0",   "1",     "-1",          "0.5",     "1e300", "nan",
                                 "inf", "1,2,3", "1,2,3,4,5,6", "--",      "a.ply", "out.png",
                                 "x",   "x>1",   "-1<z<2",      "#ff8800", "all",   "data.vtu[T=3]"};
    const Tool tool;
    add_words(tool.line, all);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }();
  return words;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 2000) return 0;
  Tool tool;
  const CommandLine* at = &tool.line;
  try {
    const ParsedLine parsed = parse_line(tool.line, words_of({reinterpret_cast<const char*>(data), size}));
    fuzz::demand(parsed.command != nullptr, "no command");
    at = parsed.command;
    if (parsed.action == ParsedLine::Action::help) fuzz::demand(!help_text(*at).empty(), "no help");
  } catch (const UsageError& error) {
    fuzz::demand(error.command != nullptr, "an error of no command");
    if (error.bare) fuzz::demand(!short_help(*error.command).empty(), "no help");
    fuzz::check_message(error.what());
  } catch (const ArgumentError& error) {
    const std::string message = with_typed_values(in_flags(error.what(), *at), *at);
    fuzz::check_message(message + did_you_mean_listed(message));
  } catch (const Error& error) {
    fuzz::check_message(in_flags(error.what(), *at));
  }
  return 0;
}

/// Half of the mutations change whole words.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned int seed) {
  std::mt19937 random(seed);
  if (random() % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  std::vector<std::string> words = words_of({reinterpret_cast<const char*>(data), size});
  const std::string& known = known_words()[random() % known_words().size()];
  const std::size_t at = random() % (words.size() + 1);
  const auto place = words.begin() + static_cast<std::ptrdiff_t>(at);
  if (at == words.size() || random() % 2 == 0) {
    words.insert(place, known);
  } else if (random() % 3 == 0) {
    words.erase(place);
  } else if (random() % 3 == 0) {
    *place += "=" + known;
  } else {
    *place = known;
  }
  std::string text;
  for (const std::string& word : words) text += word + "\n";
  if (text.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::copy(text.begin(), text.end(), data);
  return text.size();
}
