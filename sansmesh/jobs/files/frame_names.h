// Names of numbered files: frames of a motion, parts of a whole.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace sansmesh::inline v1 {

/// File name of a frame: NAME_007.png for NAME.png.
std::string frame_name(const std::string& output, std::size_t frame, int digits = 3);
/// The same for simulations, with four digits: NAME_0007.vtu for NAME.vtu.
std::string motion_frame_name(const std::string& output, std::size_t frame);
/// "out/a.ply.gz", 7 of 1234 → "out/a_0007.ply.gz".
std::string part_name(const std::string& file, std::size_t number, std::size_t parts);
/// "out/a.ply.gz", "512000_5403000" → "out/a_512000_5403000.ply.gz".
std::string tile_name(const std::string& file, const std::string& corner);
/// Existing files that are named as by `tile_name` but not among the names, as of a run with tiles of another size.
std::vector<std::string> other_tiles(const std::string& file, const std::vector<std::string>& names);

/// Throws FileError if a result would overwrite an input; empty names are ignored.
void check_inputs_stay(const std::vector<std::string>& inputs, const std::vector<std::string>& results);

}  // namespace sansmesh::inline v1
