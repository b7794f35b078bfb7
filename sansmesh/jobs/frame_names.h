// Names of files that nobody typed: the frames of a motion, the parts of a whole.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace sansmesh::inline v1 {

/// The file of a frame: NAME_007.png of NAME.png.
std::string frame_name(const std::string& output, std::size_t frame, int digits = 3);
/// The same of motions, which have many: NAME_0007.vtu of NAME.vtu.
std::string motion_frame_name(const std::string& output, std::size_t frame);
/// "out/a.ply.gz", 7 of 1234 → "out/a_0007.ply.gz".
std::string part_name(const std::string& file, std::size_t number, std::size_t parts);

/// Throws FileError where one of the results is one of the inputs; empty names are none.
void check_inputs_stay(const std::vector<std::string>& inputs, const std::vector<std::string>& results);

}  // namespace sansmesh::inline v1
