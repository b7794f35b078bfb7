// Reports of files that commands read and write.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "sansmesh/mesh_measures.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::cli {

/// One file, or several read as one.
struct ReadFiles {
  std::vector<std::string> files;

  static const ReportSchema& schema();
};

struct ReadCloud : ReadFiles {
  std::string format;
  std::size_t points = 0;
  std::shared_ptr<const ReferenceSystem> reference;  ///< null if unknown

  static const ReportSchema& schema();
};

struct ReadMesh {
  std::string file;
  std::size_t triangles = 0;

  static const ReportSchema& schema();
};

/// A file of any kind, read or written.
struct FileReport {
  std::string file;

  static const ReportSchema& schema();
};

struct WrittenPoints {
  std::string file;
  std::size_t points = 0;

  static const ReportSchema& schema();
};

struct WrittenMesh {
  std::string file;
  std::size_t vertices = 0, triangles = 0;
  MeshTopology topology;

  WrittenMesh(std::string file_name, const TriangleMesh& mesh);
  static const ReportSchema& schema();
};

/// One picture, or frames.
struct WrittenPictures {
  std::vector<std::string> files;
  int width = 0, height = 0;

  /// "a.png", "a_000.png to a_035.png".
  std::string words() const;
  /// "a.png: 800 × 600 pixels".
  std::string size_line() const;
  static const ReportSchema& schema();
};

}  // namespace sansmesh::cli
