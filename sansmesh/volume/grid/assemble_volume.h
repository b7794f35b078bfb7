// From the blocks of a file to samples: the one place where grids of all kinds become the same.
#pragma once

#include <string>

#include "sansmesh/grid_data.h"
#include "sansmesh/progress.h"
#include "sansmesh/reconstruction_options.h"
#include "sansmesh/sampled_volume.h"

namespace sansmesh::inline v1 {

/// Where the array of that name is. Points, where both have one. Throws ArgumentError naming the arrays that there are
/// where neither has.
Association association_of(const GridData& data, const std::string& array);

/// Samples, stars and cells of all blocks together (METHODS §6, §9):
/// - a single lattice stays one; samples of cells are the lattice of the cells' centres;
/// - points at one place become one sample (the mean of their values), so that O-grids close and the blocks of a
///   conforming multiblock grid are connected; cells with coinciding corners become those of fewer corners, and cells
///   without volume are left out;
/// - of samples of cells the finest level counts (AMR); a cell's neighbours are those that share a face with it, or
///   part of one;
/// - where blocks overlap the finer one counts, judged by the local length of edges, of equally fine ones the one whose
///   cell's centre comes first in lexicographic order of its coordinates: never by the order of blocks. Samples and
///   cells of the others are left out there, and stars reach across;
/// - arrays of one name and different types in several blocks get a type that holds all; where a block has not got an
///   array, or with another number of components than most rows have it, values are unknown: NaN, integers become
///   reals;
/// - grids with one layer of points or with flat cells become a slab one spacing thick;
/// - scattered points get the cells of their Delaunay tetrahedralisation.
///
/// Samples of lattices and curvilinear blocks keep their order; those of unstructured blocks and scattered points, and
/// their cells, are sorted along a curve that fills space: neighbours are near each other in memory, and the result
/// does not depend on how the file lists points and cells. (It does on how a cell lists its corners, and on which
/// corner comes first.) Nor does it depend on the order of blocks but for `block`, nor on the number of threads.
///
/// Throws DataError naming the cause where nothing is left (no points, no array of what is asked for but others, all in
/// a plane or line, nothing finite, nothing visible) and where cells name points that are not there. Of data without
/// any arrays come samples without attributes.
SampledVolume assemble_volume(const GridData& data, Association association, Progress& progress);

}  // namespace sansmesh::inline v1
