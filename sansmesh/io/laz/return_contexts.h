// Contexts of LAZ that depend on the return of a point: number `r` of `n` returns of its pulse.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace sansmesh::inline v1::io::laz {

template <std::size_t N>
using ReturnTable = std::array<std::array<std::uint8_t, N>, N>;

/// Point formats 0 to 5: the combinations with r <= n <= 5 have contexts, from 0; the others share contexts up to 15.
inline constexpr ReturnTable<8> kReturnContext = {{{15, 14, 13, 12, 11, 10, 9, 8},
                                                   {14, 0, 1, 3, 6, 10, 10, 9},
                                                   {13, 1, 2, 4, 7, 11, 11, 10},
                                                   {12, 3, 4, 5, 8, 12, 12, 11},
                                                   {11, 6, 7, 8, 9, 13, 13, 12},
                                                   {10, 10, 11, 12, 13, 14, 14, 13},
                                                   {9, 10, 11, 12, 13, 14, 15, 14},
                                                   {8, 9, 10, 11, 12, 13, 14, 15}}};

/// Point formats 6 to 10: six contexts, 0 for single returns.
inline constexpr ReturnTable<16> kWideReturnContext = {{{0, 1, 2, 3, 4, 5, 3, 4, 4, 5, 5, 5, 5, 5, 5, 5},
                                                        {1, 0, 1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3},
                                                        {2, 1, 2, 4, 4, 4, 4, 4, 4, 4, 4, 3, 3, 3, 3, 3},
                                                        {3, 3, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
                                                        {4, 3, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
                                                        {5, 3, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
                                                        {3, 3, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4},
                                                        {4, 3, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4},
                                                        {4, 3, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4},
                                                        {5, 3, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4},
                                                        {5, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4},
                                                        {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 4, 4, 4},
                                                        {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4, 4},
                                                        {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4},
                                                        {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5},
                                                        {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5}}};

/// Returns between this one and the last one of the pulse, at most 7.
inline unsigned return_level(unsigned n, unsigned r) { return std::min(n > r ? n - r : r - n, 7u); }

}  // namespace sansmesh::inline v1::io::laz
