// The made clouds are binary little endian PLY with x y z nx ny nz in float: all that the drivers read. Meshes go out
// as binary PLY.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

struct OrientedPoint {
  float x, y, z, nx, ny, nz;
};

inline std::vector<OrientedPoint> read_cloud(const char* file) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  std::size_t count = 0;
  while (std::getline(in, line) && line != "end_header")
    if (line.rfind("element vertex ", 0) == 0) count = std::stoul(line.substr(15));
  std::vector<OrientedPoint> points(count);
  in.read(reinterpret_cast<char*>(points.data()), static_cast<std::streamsize>(count * sizeof(OrientedPoint)));
  if (count == 0 || !in) {
    std::fprintf(stderr, "%s: not a cloud of make-clouds\n", file);
    std::exit(1);
  }
  return points;
}

inline void write_mesh(const char* file, const std::vector<std::array<float, 3>>& vertices,
                       const std::vector<std::array<std::int32_t, 3>>& triangles) {
  std::ofstream out(file, std::ios::binary);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  out.write(reinterpret_cast<const char*>(vertices.data()), static_cast<std::streamsize>(vertices.size() * 12));
  for (const auto& t : triangles) {
    out.put(3);
    out.write(reinterpret_cast<const char*>(t.data()), 12);
  }
}
