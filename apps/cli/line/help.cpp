// Commands `help`, `completion` and `manual`.
#include <string>
#include <vector>

#include "cli/line/commands.h"
#include "cli/line/completion.h"
#include "cli/line/help_text.h"
#include "cli/line/manual_page.h"
#include "cli/line/parse_line.h"
#include "cli/report/standard_output.h"
#include "sansmesh/io.h"

namespace sansmesh::cli {

Command add_help(CommandLine& app) {
  CommandLine& c = app.add_subcommand("help", "Help on a command");
  c.without_common_options();
  auto words = std::make_shared<std::vector<std::string>>();
  auto all = std::make_shared<bool>(false);
  c.add_option("command", *words,
               "Command or group with a command, optionally followed by a heading of its options; or view: the options "
               "of all pictures [all commands]")
      .type_name("COMMAND");
  c.add_flag("--all", *all, "Print every option, as --help-all");
  c.footer(
      "Examples:\n"
      "  sansmesh help reconstruct\n"
      "  sansmesh help reconstruct --all\n"
      "  sansmesh help render picture\n"
      "  sansmesh help view\n"
      "  sansmesh help volume render");
  return {&c, [words, all, &app](Console&) {
            if (words->size() == 1 && words->front() == "view") return print_out(help_on_views(app));
            if (words->size() > 1) {
              const CommandLine& command = command_of(app, {words->begin(), words->end() - 1});
              const std::string group = help_on_group(command, words->back());
              if (!group.empty()) return print_out(group);
            }
            print_out(help_text(command_of(app, *words), *all));
          }};
}

Command add_completion(CommandLine& app) {
  CommandLine& c = app.add_subcommand("completion", "Shell → script that completes commands, options, words and files");
  c.without_common_options();
  auto shell = std::make_shared<std::string>();
  c.add_option("shell", *shell, "bash, zsh or fish").one_of({"bash", "zsh", "fish"}).type_name("SHELL").required();
  c.footer(
      "cmake --install puts these scripts into the folders of the shells.\n\n"
      "Examples:\n"
      "  source <(sansmesh completion bash)\n"
      "  sansmesh completion zsh > ~/.zfunc/_sansmesh\n"
      "  sansmesh completion fish > ~/.config/fish/completions/sansmesh.fish");
  return {&c, [shell, &app](Console&) {
            print_out(*shell == "bash"  ? bash_completion(app)
                      : *shell == "zsh" ? zsh_completion(app)
                                        : fish_completion(app));
          }};
}

Command add_manual(CommandLine& app) {
  CommandLine& c = app.add_subcommand("manual", "Manual page of a command, for man");
  c.without_common_options();
  auto words = std::make_shared<std::vector<std::string>>();
  auto folder = std::make_shared<std::string>();
  c.add_option("command", *words, "Command or group with a command [the tool]").type_name("COMMAND");
  c.add_option("--folder", *folder, "Write the page and those of all its commands into this folder")
      .type_name("FOLDER");
  c.footer(
      "cmake --install puts the pages into the folder of man: man sansmesh-reconstruct.\n\n"
      "Examples:\n"
      "  sansmesh manual volume probe | man -l -\n"
      "  sansmesh manual --folder ~/.local/share/man/man1");
  return {&c, [words, folder, &app](Console&) {
            const CommandLine& command = command_of(app, *words);
            if (folder->empty()) return print_out(manual_page(command, SANSMESH_VERSION));
            for (const CommandLine* const page : command.with_subcommands())
              write_text(*folder + "/" + manual_page_name(*page), manual_page(*page, SANSMESH_VERSION));
          }};
}

}  // namespace sansmesh::cli
