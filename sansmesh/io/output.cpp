#include "sansmesh/io/output.h"

#include <errno.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <filesystem>

#include "sansmesh/io/names.h"

namespace sansmesh::io {
namespace {

const std::vector<Triangle> kNoTriangles;
const AttributeTable kNoAttributes;

/// The reason, without the temporary name that the reader of the message never chose.
[[noreturn]] void fail_system(const std::string& file, int error) {
  if (error == EACCES || error == EPERM) throw FileError(file, "cannot be written (permission denied)");
  if (error == ENOENT || error == ENOTDIR) throw FileError(file, "cannot be written (its folder does not exist)");
  if (error == ENOSPC || error == EDQUOT) throw FileError(file, "cannot be written (the disk is full)");
  throw FileError(file, fmt::format("cannot be written ({})", std::strerror(error)));
}

/// Writes everything or returns the error.
int write_all(int fd, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t done = ::write(fd, data, std::min<std::size_t>(size, std::size_t{1} << 30));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return errno;
    data += done, size -= static_cast<std::size_t>(done);
  }
  return 0;
}

using Parts = std::vector<std::string_view>;

Parts views(const std::vector<std::string>& parts) { return {parts.begin(), parts.end()}; }

std::vector<std::string> gzip(const std::string& file, const Parts& parts) {
  z_stream z{};
  if (deflateInit2(&z, 4, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw FileError(file, "cannot be written (compression does not start)");
  }
  std::vector<std::string> packed;
  const std::size_t block = 1 << 20;
  for (std::size_t k = 0; k <= parts.size(); ++k) {
    const bool last = k == parts.size();
    const char* next = last ? nullptr : parts[k].data();
    std::size_t left = last ? 0 : parts[k].size();
    do {
      const uInt now = static_cast<uInt>(std::min<std::size_t>(left, 1u << 30));
      z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(next));
      z.avail_in = now;
      next += now, left -= now;
      do {
        if (packed.empty() || packed.back().size() == block) {
          packed.emplace_back();
          packed.back().reserve(block);
        }
        std::string& out = packed.back();
        const std::size_t used = out.size();
        out.resize(block);
        z.next_out = reinterpret_cast<Bytef*>(out.data() + used);
        z.avail_out = static_cast<uInt>(block - used);
        deflate(&z, last ? Z_FINISH : Z_NO_FLUSH);
        out.resize(block - z.avail_out);
      } while (z.avail_out == 0);
    } while (left > 0);
  }
  deflateEnd(&z);
  return packed;
}

/// A name beside `target` that no file has yet; opened for writing.
int open_temporary(const std::filesystem::path& target, std::string& name) {
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; attempt < 100; ++attempt) {
    // Leading dot: out of sight of listings and globs while incomplete.
    const std::string unique = fmt::format(".sansmesh-{}-{}.tmp", ::getpid(), counter.fetch_add(1));
    name = (target.parent_path() / unique).string();
    const int fd = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd >= 0 || errno != EEXIST) return fd;
  }
  return -1;
}

void write_bytes(const std::string& file, const Parts& parts) {
  struct stat info {};
  const bool exists = ::stat(file.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) throw FileError(file, "cannot be written (it is a directory)");
  if (exists && ::access(file.c_str(), W_OK) != 0) fail_system(file, errno);
  if (exists && !S_ISREG(info.st_mode)) {  // a pipe or a device cannot be replaced: straight into it
    const int fd = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
    if (fd < 0) fail_system(file, errno);
    int error = 0;
    for (const std::string_view part : parts) {
      if (error == 0) error = write_all(fd, part.data(), part.size());
    }
    if (::close(fd) != 0 && error == 0) error = errno;
    if (error != 0) fail_system(file, error);
    return;
  }

  // Through a symbolic link the file it names is replaced, not the link.
  std::filesystem::path target = file;
  std::error_code ignored;
  if (exists) target = std::filesystem::canonical(target, ignored);
  if (target.empty()) target = file;

  std::string temporary;
  const int fd = open_temporary(target, temporary);
  if (fd < 0) fail_system(file, errno);
  int error = 0;
  if (exists) (void)!::fchmod(fd, info.st_mode & 07777);  // keeps the old file's mode where the system lets us
  for (const std::string_view part : parts) {
    if (error == 0) error = write_all(fd, part.data(), part.size());
  }
  if (::close(fd) != 0 && error == 0) error = errno;
  if (error == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.c_str());
    fail_system(file, error);
  }
}

}  // namespace

void write_whole(const std::string& file, const std::vector<std::string>& parts) { write_parts(file, views(parts)); }

void write_parts(const std::string& file, const Parts& parts) {
  if (file.empty()) throw FileError("(no name)", "the name of the file to write is empty");
  if (lower(file).ends_with(".gz")) return write_bytes(file, views(gzip(file, parts)));
  write_bytes(file, parts);
}

OutputContent::OutputContent(const TriangleMesh& mesh)
    : origin(mesh.origin),
      positions(mesh.vertices),
      normals(mesh.normals),
      colors(mesh.colors),
      attributes(mesh.attributes),
      triangles(mesh.triangles),
      triangle_attributes(mesh.triangle_attributes) {}

OutputContent::OutputContent(const PointSet& points)
    : origin(points.origin),
      positions(points.positions),
      normals(points.normals),
      colors(points.colors),
      attributes(points.attributes),
      triangles(kNoTriangles),
      triangle_attributes(kNoAttributes) {}

WorldCoordinates::WorldCoordinates(const Vec3& origin, const std::vector<Vec3f>& positions)
    : origin_(origin), positions_(positions), shifted_(origin != Vec3{}) {
  if (!shifted_) return;
  const Box3f box = parallel_reduce(
      positions.size(), 1 << 15, Box3f{},
      [&](std::size_t first, std::size_t last) {
        Box3f b;
        for (std::size_t i = first; i < last; ++i) b.extend(positions[i]);
        return b;
      },
      [](Box3f a, const Box3f& b) { return a.extend(b), a; });
  if (box.empty()) return;
  double farthest = 0;
  for (int k = 0; k < 3; ++k) {
    farthest = std::max({farthest, std::abs(origin[k] + box.lower[k]), std::abs(origin[k] + box.upper[k])});
  }
  const double extent = std::max<double>(box.diagonal(), farthest * 0x1p-40);
  if (!(extent > 0)) return;
  float_loss_ = farthest * 0x1p-24 / extent;
  decimals_ = std::clamp(static_cast<int>(std::ceil(-std::log10(extent * 0x1p-26))), 0, 17);
}

char* WorldCoordinates::put(char* p, std::size_t i, char separator) const {
  for (int k = 0; k < 3; ++k) {
    if (k > 0) *p++ = separator;
    if (!shifted_) {
      p = std::to_chars(p, p + number_width, positions_[i][k]).ptr;
      continue;
    }
    const double value = origin_[k] + static_cast<double>(positions_[i][k]);
    const auto [end, error] = std::to_chars(p, p + number_width, value, std::chars_format::fixed, decimals_);
    if (error != std::errc()) {  // too long for fixed notation: astronomically large
      p = std::to_chars(p, p + number_width, value).ptr;
      continue;
    }
    p = end;
    if (decimals_ > 0) {
      while (p[-1] == '0') --p;
      if (p[-1] == '.') --p;
    }
  }
  return p;
}

}  // namespace sansmesh::io
