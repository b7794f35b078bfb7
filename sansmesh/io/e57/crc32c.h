// CRC-32C (Castagnoli), the checksum of E57 pages.
#pragma once

#include <cstdint>
#include <string_view>

namespace sansmesh::inline v1::io {

/// Checksum of bytes: 0xe3069283 for "123456789".
std::uint32_t crc32c(std::string_view bytes);

}  // namespace sansmesh::inline v1::io
