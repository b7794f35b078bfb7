// Header and variable length records of LAS 1.0 to 1.4 (ASPRS LAS specification), which LAZ and COPC share.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

/// Bytes of a record of each point format, without extra bytes.
inline constexpr std::array<std::size_t, 11> kLasRecordBytes = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
/// Bytes before the payload of a variable length record, and of an extended one.
inline constexpr std::size_t kVlrHead = 54, kEvlrHead = 60;

/// A variable length record ("VLR") or an extended one ("EVLR").
struct LasVlr {
  std::string_view user;  ///< without trailing zeros, e.g. "LASF_Projection"
  std::uint16_t id;       ///< e.g. 2112 for WKT, 34735 to 34737 for GeoTIFF keys
  std::string_view payload;
};

struct LasHeader {
  unsigned minor = 0;            ///< version 1.minor
  unsigned global_encoding = 0;  ///< bit 0: adjusted standard GPS times; bit 4: the reference system is WKT
  std::size_t header_bytes = 0;  ///< position of the first VLR
  std::size_t begin = 0;         ///< position of the points
  unsigned format = 0;           ///< point format 0 to 10
  bool compressed = false;       ///< LAZ
  std::size_t record = 0;        ///< bytes of a point record
  std::uint64_t count = 0;       ///< points, > 0
  Vec3 scale, offset;            ///< coordinate = integer * scale + offset
  Box3 box;                      ///< as the file states it, unchecked
  std::vector<LasVlr> vlrs;      ///< VLRs, then EVLRs

  /// Formats 6 to 10 have another layout of records than 0 to 5.
  bool wide() const { return format >= 6; }
  /// Offset of red, green and blue (16 bits each) in a record; 0 = none.
  std::size_t colors() const;
  /// The first record of that user and number; null if there is none.
  const LasVlr* find(std::string_view user, std::uint16_t id) const;
};

/// Bytes of the header of all versions.
inline constexpr std::size_t kLasHeaderBytes = 227;

/// The box that a header of at least kLasHeaderBytes states, unchecked.
Box3 load_las_box(const char* header);

/// Throws FileError if the file is not LAS or LAZ, its header contradicts itself, or it holds no points. Damage ends
/// the list of records: the points do not depend on it. `in` must outlive the header.
LasHeader read_las_header(const Input& in);

}  // namespace sansmesh::inline v1::io
