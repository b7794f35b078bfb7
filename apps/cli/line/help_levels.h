// Which options of a command its help shows at first.
#pragma once

#include <span>

#include "cli/line/command.h"

namespace sansmesh::cli {

/// Headings of options that are not shown at first: the same in all commands with pictures, and variants of the sources
/// beside ours.
inline constexpr const char *kViewGroup = "View", *kSourcesGroup = "As in the sources";

/// Marks the options that people use first, twenty a command at most, and puts those that choose what the sources do
/// under a heading of their own. Called once each command has all of its options. Throws std::logic_error for options
/// that a command has not.
void arrange_help(std::span<const Command> commands);

}  // namespace sansmesh::cli
