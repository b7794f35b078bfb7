// Layout of compressed LAS records: the "laszip" VLR (isenburg2013).
#pragma once

#include <cstdint>
#include <string>

#include "sansmesh/io/points/las_header.h"

namespace sansmesh::inline v1::io::laz {

inline constexpr std::string_view kLazUser = "laszip encoded";
inline constexpr std::uint16_t kLazId = 22204;
/// Points per chunk of most writers.
inline constexpr std::uint32_t kChunkPoints = 50000;
/// Chunks have any number of points, which their table lists.
inline constexpr std::uint32_t kVariableChunks = 0xffffffff;

/// Parts of a point record and their places; 0 bytes or position 0: absent.
struct LazLayout {
  bool layered = false;        ///< point formats 6 to 10: each attribute of a chunk is compressed by itself
  bool chunked = true;         ///< false: all points are one chunk, and there is no table
  bool first_version = false;  ///< not layered: version 1 of the parts, of writers before 2011
  bool fixed_channels = true;  ///< layered: version 4 of the parts, see layered_chunk.h
  std::uint32_t chunk_points = kChunkPoints;
  std::size_t record = 0;  ///< bytes of a record
  std::size_t time = 0, rgb = 0, infrared = 0, wave = 0;
  std::size_t extra = 0, extra_bytes = 0;
};

/// The parts of a point format, with as many extra bytes as fill the record.
LazLayout laz_layout(unsigned format, std::size_t record);

/// The layout that the VLR of a compressed file describes. Throws FileError if it is missing, malformed or not
/// supported.
LazLayout read_laz_layout(const Input& in, const LasHeader& header);

/// The VLR, with its head.
std::string laz_vlr(const LazLayout& layout);

}  // namespace sansmesh::inline v1::io::laz
