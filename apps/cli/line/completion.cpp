#include "cli/line/completion.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <vector>

#include "cli/line/help_text.h"

namespace sansmesh::cli {
namespace {

/// "'reconstruct'|'volume'|'volume probe'" with this separator.
std::string quoted_paths(const CommandLine& root, const char* separator) {
  std::vector<std::string> paths;
  for (const CommandLine* const command : root.with_subcommands())
    if (command->parent()) paths.push_back("'" + command->path() + "'");
  return fmt::format("{}", fmt::join(paths, separator));
}

/// A command's own and global options, without positional ones.
std::vector<const OptionEntry*> typed_options(const CommandLine& command) {
  std::vector<const OptionEntry*> list;
  for (const OptionGroup& group : option_groups_of(command))
    for (const OptionEntry* option : group.options)
      if (!option->positional()) list.push_back(option);
  return list;
}

std::vector<const OptionEntry*> positional_options(const CommandLine& command) {
  std::vector<const OptionEntry*> list;
  for (const auto& option : command.options())
    if (option->positional()) list.push_back(option.get());
  return list;
}

/// "ply|obj" for the matching endings; empty if all files match.
std::string endings_pattern(const OptionEntry& option) {
  std::vector<std::string> bare;
  bare.reserve(option.endings.size());
  for (const std::string& ending : option.endings) bare.push_back(ending.substr(1));
  return fmt::format("{}", fmt::join(bare, "|"));
}

std::string in_single_quotes(const std::string& text, const std::string& quote) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? quote : std::string(1, c);
  return quoted + "'";
}

// --- bash

constexpr const char* kBashBegin = R"(# Completion of sansmesh for bash, made by `sansmesh completion bash`.
# Every value is completed by one of these, or not at all.
_sansmesh_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$current"); }
_sansmesh_files() {
  local name all=()
  COMPREPLY=()
  while IFS= read -r name; do
    all+=("$name")
    [[ -d $name || ${name,,} =~ \.($1)(\.gz)?$ ]] && COMPREPLY+=("$name")
  done < <(compgen -f -- "$current")
  ((${#COMPREPLY[@]})) || COMPREPLY=("${all[@]}")
  compopt -o filenames 2>/dev/null
}

_sansmesh() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} command= word i
  COMPREPLY=()
  # --option=value comes in three words.
  if [[ $current == '=' ]]; then
    current=
  elif [[ $previous == '=' ]]; then
    previous=${COMP_WORDS[COMP_CWORD-2]}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    word=${command:+$command }${COMP_WORDS[i]}
    case $word in
)";

constexpr const char* kBashEnd = R"(  esac
}
complete -F _sansmesh sansmesh
)";

/// Completion action for the value of an option; empty if there is none.
std::string bash_action(const OptionEntry& option) {
  if (!option.words.empty()) return fmt::format("_sansmesh_words '{}'", fmt::join(option.words, " "));
  if (option.is_file()) return fmt::format("_sansmesh_files '{}'", endings_pattern(option));
  return "";
}

// --- zsh

/// Text inside a single-quoted specification of _arguments.
std::string zsh_text(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\'')
      safe += "'\\''";
    else
      safe += (std::string("[]:\\").find(c) != std::string::npos ? "\\" : "") + std::string(1, c);
  }
  return safe;
}

/// ":name:action" for a value.
std::string zsh_value(const OptionEntry& option) {
  std::string action = " ";
  if (!option.words.empty()) {
    action = fmt::format("({})", fmt::join(option.words, " "));
  } else if (option.is_file()) {
    const std::string endings = endings_pattern(option);
    action = endings.empty() ? "_files" : fmt::format("_files -g \"*.(#i)({})(.gz|)\"", endings);
  }
  return ":" + zsh_text(option.value_name) + ":" + action;
}

std::string zsh_option(const OptionEntry& option) {
  const std::string names = fmt::format("{}", fmt::join(option.names, " "));
  const std::string once = option.repeated ? "*" : "(" + names + ")";
  std::string text;
  for (const std::string& name : option.names) {
    text += fmt::format("    '{}{}", once, name);
    if (option.kind != OptionEntry::Kind::flag) text += name.starts_with("--") ? "=" : "+";
    text += "[" + zsh_text(option.what) + "]";
    if (option.kind != OptionEntry::Kind::flag) text += (option.implied ? ":" : "") + zsh_value(option);
    text += "' \\\n";
  }
  return text;
}

std::string function_name(const CommandLine& command) {
  std::string name = "_" + command.full_name();
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

std::string zsh_function(const CommandLine& command) {
  std::string text = function_name(command) + "() {\n";
  const bool further = !command.commands().empty();
  if (further) text += "  local curcontext=$curcontext state line\n  typeset -A opt_args\n";
  text += further ? "  _arguments -C \\\n" : "  _arguments -s -S \\\n";
  for (const OptionEntry* option : typed_options(command)) text += zsh_option(*option);
  if (!further) {
    std::size_t number = 0;
    for (const OptionEntry* option : positional_options(command))
      text += option->several ? fmt::format("    '*{}' \\\n", zsh_value(*option))
                              : fmt::format("    '{}{}' \\\n", ++number, zsh_value(*option));
    text.erase(text.rfind(" \\\n"));
    return text + "\n}\n";
  }
  text += "    '1:command:->command' '*::argument:->argument'\n";
  text += "  case $state in\n    command)\n      local -a commands=(\n";
  for (const auto& c : command.commands()) text += fmt::format("        '{}:{}'\n", c->name(), zsh_text(c->what()));
  text += "      )\n      _describe command commands ;;\n    argument)\n      case $line[1] in\n";
  for (const auto& c : command.commands()) text += fmt::format("        {}) {} ;;\n", c->name(), function_name(*c));
  return text + "      esac ;;\n  esac\n}\n";
}

// --- fish

constexpr const char* kFishBegin = R"(# Completion of sansmesh for fish, made by `sansmesh completion fish`.
function __sansmesh_at --description 'whether the words so far choose this command'
    set -l at ''
    for word in (commandline -opc)[2..-1]
        set -l further (string trim -- "$at $word")
        contains -- $further $__sansmesh_commands; and set at $further
    end
    test "$at" = "$argv[1]"
end
function __sansmesh_files --description 'files with one of these endings, and folders'
    set -l current (string replace -r -- '^--[a-z-]+=' '' (commandline -ct))
    set -l found
    set -l all
    for name in $current*
        test -d $name; and set name $name/
        set -a all $name
        string match -qr '/$' -- $name; or string match -qri "\.($argv[1])(\.gz)?\$" -- $name; and set -a found $name
    end
    test -n "$found"; and printf '%s\n' $found; or printf '%s\n' $all
end
complete -c sansmesh -e
complete -c sansmesh -f
)";

std::string fish_words(const OptionEntry& option) {
  if (!option.words.empty()) return "-a " + in_single_quotes(fmt::format("{}", fmt::join(option.words, " ")), "\\'");
  if (option.is_file()) return fmt::format("-a '(__sansmesh_files \"{}\")'", endings_pattern(option));
  return "";
}

std::string fish_lines(const CommandLine& command) {
  const std::string begin = fmt::format("complete -c sansmesh -n '__sansmesh_at \"{}\"'", command.path());
  std::string text;
  for (const auto& c : command.commands())
    text += fmt::format("{} -a {} -d {}\n", begin, c->name(), in_single_quotes(c->what(), "\\'"));
  for (const OptionEntry* option : positional_options(command))
    if (const std::string words = fish_words(*option); !words.empty())
      text.append(begin).append(" ").append(words).append("\n");
  for (const OptionEntry* option : typed_options(command)) {
    text += begin;
    for (const std::string& n : option->names)
      text += n.starts_with("--") ? " -l " + n.substr(2) : " -s " + n.substr(1);
    if (option->kind != OptionEntry::Kind::flag) {
      const std::string words = fish_words(*option);
      text += std::string(option->implied ? "" : " -x") + (words.empty() ? "" : " " + words);
    }
    text += " -d " + in_single_quotes(option->what, "\\'") + "\n";
  }
  return text;
}

}  // namespace

std::string bash_completion(const CommandLine& root) {
  const std::vector<const CommandLine*> commands = root.with_subcommands();
  std::string text = kBashBegin;
  text += fmt::format("      {}) command=$word ;;\n    esac\n  done\n", quoted_paths(root, "|"));
  // Options with the same completion share one line.
  std::map<std::string, std::vector<std::string>> values;
  for (const CommandLine* const command : commands)
    for (const OptionEntry* option : typed_options(*command))
      for (const std::string& flag : option->names)
        if (option->kind != OptionEntry::Kind::flag && !option->implied)
          values[bash_action(*option)].push_back(fmt::format("'{} {}'", command->path(), flag));
  text += "  case \"$command $previous\" in\n";
  for (const auto& [action, patterns] : values)
    text += fmt::format("    {})\n      {}return ;;\n", fmt::join(patterns, "|"), action.empty() ? "" : action + "; ");
  text += "  esac\n  if [[ $current == -* ]]; then\n    case $command in\n";
  for (const CommandLine* const command : commands) {
    std::vector<std::string> flags;
    for (const OptionEntry* option : typed_options(*command))
      flags.insert(flags.end(), option->names.begin(), option->names.end());
    text += fmt::format("      '{}') _sansmesh_words '{}' ;;\n", command->path(), fmt::join(flags, " "));
  }
  text += "    esac\n    return\n  fi\n  case $command in\n";
  for (const CommandLine* const command : commands) {
    std::string action;
    if (!command->commands().empty()) {
      action = fmt::format("_sansmesh_words '{}'", fmt::join(command->command_names(), " "));
    } else if (const auto positional = positional_options(*command); !positional.empty()) {
      action = bash_action(*positional.back());
    }
    if (!action.empty()) text += fmt::format("    '{}') {} ;;\n", command->path(), action);
  }
  return text + kBashEnd;
}

std::string zsh_completion(const CommandLine& root) {
  std::string text = "#compdef sansmesh\n# Completion of sansmesh for zsh, made by `sansmesh completion zsh`.\n";
  for (const CommandLine* const command : root.with_subcommands()) text += zsh_function(*command);
  // A file in $fpath is called as a function; a sourced script must register itself.
  return text +
         "if [[ $funcstack[1] == _sansmesh ]]; then\n  _sansmesh \"$@\"\nelse\n  compdef _sansmesh sansmesh\nfi\n";
}

std::string fish_completion(const CommandLine& root) {
  std::string text = fmt::format("set -g __sansmesh_commands {}\n{}", quoted_paths(root, " "), kFishBegin);
  for (const CommandLine* const command : root.with_subcommands()) text += fish_lines(*command);
  return text;
}

}  // namespace sansmesh::cli
