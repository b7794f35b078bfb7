#include "cli/line/manual_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/line/help_text.h"
#include "sansmesh/core/option_text.h"

namespace sansmesh::cli {
namespace {

/// Decodes the next character of well-formed UTF-8.
unsigned code_point(const std::string& text, std::size_t& at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(at++);
  if (first < 0x80) return first;
  const int more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : 1;
  unsigned code = first & (0x3fU >> more);
  for (int i = 0; i < more; ++i) code = code << 6 | (byte(at++) & 0x3fU);
  return code;
}

/// Escapes a line for troff: searchable dashes, no macro at the beginning.
std::string roff(const std::string& text) {
  std::string safe;
  for (std::size_t at = 0; at < text.size();) {
    const bool begins = at == 0 || text[at - 1] == '\n';
    const unsigned code = code_point(text, at);
    if (begins && (code == '.' || code == '\'')) safe += "\\&";
    if (code == '\\')
      safe += "\\e";
    else if (code == '-')
      safe += "\\-";
    else if (code == '\'')
      safe += "\\(aq";
    else if (code == '`')
      safe += "\\(ga";
    else if (code == '^')
      safe += "\\(ha";
    else if (code == '~')
      safe += "\\(ti";
    else if (code < 0x80)
      safe += static_cast<char>(code);
    else
      safe += fmt::format("\\[u{:04X}]", code);
  }
  return safe;
}

std::string dashed(const CommandLine& command) {
  std::string name = command.full_name();
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

/// Lines without filling.
std::string verbatim(const std::string& text) { return ".PP\n.nf\n" + roff(text) + "\n.fi\n"; }

std::string option_lines(const OptionEntry& o) {
  std::string text = ".TP\n";
  for (std::size_t i = 0; i < o.names.size(); ++i) text += (i == 0 ? "\\fB" : ", \\fB") + roff(o.names[i]) + "\\fR";
  if (o.positional() ? o.several : o.kind != OptionEntry::Kind::flag)
    text += o.positional() ? " ..."
                           : (o.implied ? " [\\fI" : " \\fI") + roff(o.value_name) + (o.implied ? "\\fR]" : "\\fR");
  text += "\n" + roff(o.what) + (o.required && !o.positional() ? " (required)" : "") + "\n";
  if (!o.words.empty() && std::any_of(o.words.begin(), o.words.end(), [&](const std::string& word) {
        return o.what.find(word) == std::string::npos;
      })) {
    text += "One of " + roff(fmt::format("{}", fmt::join(o.words, ", "))) + ".\n";
  }
  return text;
}

}  // namespace

std::string manual_page_name(const CommandLine& command) { return dashed(command) + ".1"; }

std::string manual_page(const CommandLine& command, const std::string& version) {
  std::string text = fmt::format(".\\\" Made by `sansmesh manual`.\n.TH {} 1 \"\" \"sansmesh {}\" \"User Commands\"\n",
                                 upper_case(roff(dashed(command))), roff(version));
  text += ".SH NAME\n" + roff(dashed(command)) + " \\- " + roff(command.what()) + "\n";
  text += ".SH SYNOPSIS\n\\fB" + roff(command.full_name()) + "\\fR" +
          roff(usage_of(command).substr(command.full_name().size())) + "\n";
  if (!command.commands().empty()) {
    text += ".SH COMMANDS\n";
    for (const auto& further : command.commands())
      text += ".TP\n\\fB" + roff(further->name()) + "\\fR\n" + roff(further->what()) + ", see \\fB" +
              roff(dashed(*further)) + "\\fR(1)\n";
  }
  for (const OptionGroup& group : option_groups_of(command)) {
    text += ".SH " +
            (group.heading.empty()                               ? std::string("ARGUMENTS")
             : group.heading.find("ptions") != std::string::npos ? roff(upper_case(group.heading))
                                                                 : roff(upper_case(group.heading) + " OPTIONS")) +
            "\n";
    for (const OptionEntry* option : group.options) text += option_lines(*option);
  }
  if (const std::string remarks = remarks_of(command); !remarks.empty()) text += ".SH NOTES\n" + verbatim(remarks);
  if (const auto examples = examples_of(command); !examples.empty())
    text += ".SH EXAMPLES\n" + verbatim(fmt::format("{}", fmt::join(examples, "\n")));
  text +=
      ".SH EXIT STATUS\n0: success. 1: error in a file or its data. 2: error in the command line. 130: interrupted.\n";
  if (command.parent()) text += ".SH SEE ALSO\n\\fB" + roff(dashed(*command.parent())) + "\\fR(1)\n";
  return text;
}

}  // namespace sansmesh::cli
