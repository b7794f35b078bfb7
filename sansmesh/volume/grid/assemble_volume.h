// Assembles the blocks of a file into samples; later stages do not distinguish kinds of grids.
#pragma once

#include <string>

#include "sansmesh/grid_data.h"
#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume_reconstruction_options.h"

namespace sansmesh::inline v1 {

/// Samples, stars and cells of all blocks together (tejada2008, ch. 6; docs/methods/volume-grids.md):
/// - a single lattice stays a lattice; cell data become samples on the lattice of the cell centres;
/// - coincident points become one sample (the mean of their values), so that O-grids close and the blocks of a
///   conforming multiblock grid are connected; cells with coincident corners become cells with fewer corners, and
///   cells without volume are removed;
/// - for cell data the finest level counts (AMR); the neighbours of a cell share a face or a part of a face with it;
/// - where blocks overlap the finer one counts, by local edge length; among equally fine ones the block whose cell
///   centre is lexicographically first, so that the order of blocks does not matter. Samples and cells of the others
///   are removed there, and stars connect across;
/// - arrays of one name and different types in several blocks get a common type that holds all of them; in a block that
///   lacks the array, or has another number of components than most rows, values are unknown: NaN, and integers become
///   reals;
/// - grids with one layer of points or with flat cells become a slab one spacing thick;
/// - scattered points get the cells of their Delaunay tetrahedralisation.
///
/// Samples of lattices and curvilinear blocks keep their order. Samples and cells of unstructured blocks and scattered
/// points are sorted along a space-filling curve: neighbours are close in memory, and the result is independent of the
/// order of points and cells in the file (it depends on the first corner and the corner order of a cell). It is also
/// independent of the order of blocks, except for `block`, and of the number of threads.
///
/// Throws DataError that names the cause if no sample remains (no points, no array of the requested association but
/// others, all points in a plane or line, no finite or no visible values) and for cells with invalid point numbers.
/// Data without any array give samples without attributes.
SampledVolume assemble_volume(const GridData& data, Association association, Progress& progress);

}  // namespace sansmesh::inline v1
