// Levels of options per job: basic ones, advanced ones, and variants of the published methods. User interfaces show
// options by level.
#pragma once

#include <string_view>
#include <vector>

namespace sansmesh::inline v1 {

/// Basic options ("mesh-error") of a job by its name ("volume fit"): at most twenty, file options included. Empty if
/// all options are basic.
std::vector<std::string_view> basic_options(std::string_view job);

/// Options that select variants of the published methods, for comparisons. `has_surface`: the job has an option for the
/// surface of samples.
std::vector<std::string_view> source_options(std::string_view job, bool has_surface);

}  // namespace sansmesh::inline v1
