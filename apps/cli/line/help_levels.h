// Options that the short help of a command shows.
#pragma once

#include <span>

#include "cli/line/command.h"

namespace sansmesh::cli {

/// Headings of options that the short help omits: the common options of pictures, and variants from publications.
inline constexpr const char *kViewGroup = "View", *kSourcesGroup = "As in the sources";

/// Marks up to twenty basic options per command, and moves options for published variants under their own heading.
/// Called once each command has all of its options. Throws std::logic_error for options that a command does not have.
void arrange_help(std::span<const Command> commands);

}  // namespace sansmesh::cli
