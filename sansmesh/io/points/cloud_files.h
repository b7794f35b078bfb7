// Files of a cloud in several parts: folders, patterns and lists of files.
#pragma once

#include <string>
#include <vector>

namespace sansmesh::inline v1::io {

/// Replaces names of several files by their files, each in ascending order of names (bytes), so that the order does not
/// depend on the file system:
/// - a folder: its clouds and meshes, without subfolders and hidden files. They must be of one format (LAS and LAZ are
///   one), so that results and notes beside the tiles are not read with them;
/// - a pattern with *, ? or [ ] that is not itself a file: the files that match;
/// - a list of files (ending .lst or .list; or .txt, if its first line names a file that exists): the files in its
///   order. Names are relative to the list's folder or, if there is none, to the current folder; lines that begin with
///   # are comments. Lines may be folders and patterns.
/// Other names stay unchanged. A file that is named several times, by any paths, is listed once. Throws FileError if a
/// name has no files, or if a folder or pattern has copies of the same points (tile.las, tile.laz, tile.copc.laz).
std::vector<std::string> list_cloud_files(const std::vector<std::string>& names);

/// Whether a name is a folder with clouds or meshes.
bool is_cloud_folder(const std::string& name);

}  // namespace sansmesh::inline v1::io
