// Levels of options, which belong to a job and an option: what people use first, what is advanced, and variants of the
// sources beside ours. Doors show options by them.
#pragma once

#include <string_view>
#include <vector>

namespace sansmesh::inline v1 {

/// Options that people use first, "mesh-error", of a job by its name ("volume fit"), twenty at most, those of files
/// among them; empty where all are.
std::vector<std::string_view> basic_options(std::string_view job);

/// Options that choose among variants of the sources, for those who compare with them. `has_surface`: the job lets a
/// surface of samples be chosen.
std::vector<std::string_view> source_options(std::string_view job, bool has_surface);

}  // namespace sansmesh::inline v1
