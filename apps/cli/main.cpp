// The command line: which commands there are, what all of them have, and which exit code says what went wrong.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "flags.h"
#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::cli {
namespace {

constexpr int kFailed = 1;         // a file or its data
constexpr int kUsage = 2;          // the command line
constexpr int kInterrupted = 130;  // Ctrl-C, as shells have it

constexpr const char* kExamples = R"(
Examples:
  sansmesh reconstruct scan.ply -o surface.ply
  sansmesh reconstruct scan.ply -o surface.glb --preview surface.png
  sansmesh evaluate surface.ply reference.ply
  sansmesh COMMAND --help

Lengths are in the unit of the input. What is not given is chosen from the data.
Exit codes: 0 done, 1 a file or its data is at fault, 2 the command line is, 130 interrupted.)";

/// What every command can be told.
struct CommonArguments {
  ConsoleOptions console;
  int threads = 0;
};

void add_common(CommandLine& command, CommonArguments& common) {
  command.add_flag("--json", common.console.json, "Print the results as one JSON object").group("Output");
  command.add_flag("--verbose", common.console.verbose, "Print the time that each stage took").group("Output");
  command.add_flag("--quiet", common.console.quiet, "Print errors and nothing else").group("Output");
  command.add_option("--threads", common.threads, "Number of threads; results do not depend on it [all cores]")
      .within(1, ThreadScope::kMost)
      .type_name("COUNT")
      .group("Output");
}

/// The command that the command line chose; it must have.
const Command& chosen_of(const std::vector<Command>& commands) {
  return *std::find_if(commands.begin(), commands.end(), [](const Command& c) { return c.line->chosen(); });
}

void run(const Command& command, const CommonArguments& common) {
  const ThreadScope threads(common.threads);
  Console console(common.console, *command.line);
  command.run(console);
}

/// "render " or "volume probe ": what to put before --help.
std::string chosen_words(const CLI::App& app) {
  std::string words;
  for (const CLI::App* at = &app; !at->get_subcommands().empty();) {
    at = at->get_subcommands().front();
    words += at->get_name() + " ";
  }
  return words;
}

int main(int argc, char** argv) {
  CommonArguments common;
  CommandLine line("Surfaces and volumes straight from samples.", "sansmesh");
  CLI::App& app = line.app();
  app.footer(kExamples);
  app.set_version_flag("--version", std::string("sansmesh ") + SANSMESH_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(28);
  std::vector<Command> commands = {add_reconstruct(line), add_normals(line), add_evaluate(line),  add_info(line),
                                   add_render(line),      add_project(line), add_curvature(line), add_advise(line),
                                   add_fit(line),         add_mesh(line),    add_eval(line),      add_edit(line),
                                   add_diagnose(line),    add_section(line), add_compare(line),   add_measure(line),
                                   add_csg(line),         add_deform(line),  add_simulate(line)};
  for (Command& command : add_volume(line)) commands.push_back(std::move(command));
  for (Command& command : add_flow(line)) commands.push_back(std::move(command));
  for (const Command& command : commands) add_common(*command.line, common);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    return app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    const std::string words = chosen_words(app);
    if (argc < 2) {
      fmt::print("{}", app.help());
    } else if (words.empty() && argv[1][0] != '-') {
      print_error(fmt::format("unknown command '{}' (see sansmesh --help)", argv[1]));
    } else {
      print_error(fmt::format("{} (see sansmesh {}--help)", error.what(), words));
    }
    return kUsage;
  }
  const Command& command = chosen_of(commands);
  try {
    run(command, common);
    return 0;
  } catch (const Cancelled&) {
    print_error("interrupted, nothing was written");
    return kInterrupted;
  } catch (const ArgumentError& error) {
    print_error(in_flags(error.what(), *command.line));
    return kUsage;
  } catch (const std::bad_alloc&) {
    print_error("not enough memory");
  } catch (const std::exception& error) {
    print_error(error.what());
  }
  return kFailed;
}

}  // namespace
}  // namespace sansmesh::cli

int main(int argc, char** argv) { return sansmesh::cli::main(argc, argv); }
