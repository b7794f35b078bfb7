#include "sansmesh/io/input.h"

#include <errno.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <cstring>
#include <filesystem>

namespace sansmesh::io {
namespace {

/// Closes a descriptor at the end of a scope.
struct Descriptor {
  int fd = -1;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

/// Most bytes that `packed` bytes may expand to: deflate itself cannot exceed 1032:1, and clouds stay far below; small
/// files may use the full ratio.
std::size_t expansion_limit(std::size_t packed) {
  const std::size_t always_fine = std::size_t{256} << 20;
  return std::max(always_fine, packed * 100);
}

std::vector<char> read_stream(const std::string& file, int fd) {
  std::vector<char> bytes;
  std::size_t used = 0;
  const std::size_t limit = std::size_t{16} << 30;
  for (;;) {
    if (used == bytes.size()) bytes.resize(std::max<std::size_t>(1 << 16, bytes.size() * 2));
    const ssize_t got = ::read(fd, bytes.data() + used, bytes.size() - used);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw FileError(file, fmt::format("cannot be read ({})", std::strerror(errno)));
    if (got == 0) break;
    used += static_cast<std::size_t>(got);
    if (used > limit) throw FileError(file, "is a stream of more than 16 GiB");
  }
  bytes.resize(used);
  return bytes;
}

}  // namespace

FileContent::FileContent(const std::string& file) {
  if (file.empty()) throw FileError("(no name)", "the name of the file is empty");
  Descriptor d{::open(file.c_str(), O_RDONLY | O_CLOEXEC)};
  if (d.fd < 0) {
    if (errno == ENOENT || errno == ENOTDIR) throw FileError(file, "no such file");
    if (errno == EACCES) throw FileError(file, "permission to read it is denied");
    throw FileError(file, fmt::format("cannot be opened ({})", std::strerror(errno)));
  }
  struct stat info {};
  if (::fstat(d.fd, &info) != 0) throw FileError(file, fmt::format("cannot be examined ({})", std::strerror(errno)));
  if (S_ISDIR(info.st_mode)) throw FileError(file, "is a directory, not a file");
  if (S_ISREG(info.st_mode)) {
    if (info.st_size == 0) throw FileError(file, "is empty (0 bytes)");
    map_size_ = static_cast<std::size_t>(info.st_size);
    map_ = ::mmap(nullptr, map_size_, PROT_READ, MAP_PRIVATE | MAP_POPULATE, d.fd, 0);
    if (map_ == MAP_FAILED) {
      map_ = nullptr;
      owned_ = read_stream(file, d.fd);
      bytes_ = {owned_.data(), owned_.size()};
    } else {
      bytes_ = {static_cast<const char*>(map_), map_size_};
    }
  } else if (S_ISFIFO(info.st_mode) || S_ISSOCK(info.st_mode)) {
    owned_ = read_stream(file, d.fd);
    bytes_ = {owned_.data(), owned_.size()};
  } else {
    throw FileError(file, "is a device, not a file");
  }
  if (bytes_.empty()) throw FileError(file, "is empty (0 bytes)");

  if (bytes_.size() >= 2 && bytes_[0] == '\x1f' && bytes_[1] == '\x8b') {
    gzipped_ = true;
    Inflated unpacked;
    try {
      unpacked = inflate_bytes(file, bytes_, 4 * bytes_.size(), expansion_limit(bytes_.size()));
    } catch (...) {
      if (map_) ::munmap(map_, map_size_);
      throw;
    }
    if (map_) ::munmap(map_, map_size_), map_ = nullptr;
    if (!unpacked.complete) throw FileError(file, "truncated: the gzip data ends early");
    if (unpacked.bytes.empty()) throw FileError(file, "is empty (0 bytes when unpacked)");
    owned_ = std::move(unpacked.bytes);
    bytes_ = {owned_.data(), owned_.size()};
  }
}

FileContent::~FileContent() {
  if (map_) ::munmap(map_, map_size_);
}

Inflated inflate_bytes(const std::string& file, std::string_view packed, std::size_t expected, std::size_t limit) {
  Inflated result;
  z_stream z{};
  if (inflateInit2(&z, 15 + 32) != Z_OK) throw FileError(file, "cannot start unpacking");  // 32: zlib or gzip
  struct End {
    z_stream& z;
    ~End() { inflateEnd(&z); }
  } end{z};
  result.bytes.resize(std::clamp<std::size_t>(expected, 256, limit));
  std::size_t used = 0, consumed = 0;
  for (;;) {
    if (used == result.bytes.size()) {
      if (used >= limit) throw FileError(file, fmt::format("unpacks to more than {} bytes, refused", grouped(limit)));
      result.bytes.resize(std::min(limit, used * 2));
    }
    const std::size_t in_now = std::min<std::size_t>(packed.size() - consumed, 1u << 30);
    const std::size_t out_now = std::min<std::size_t>(result.bytes.size() - used, 1u << 30);
    z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + consumed));
    z.avail_in = static_cast<uInt>(in_now);
    z.next_out = reinterpret_cast<Bytef*>(result.bytes.data() + used);
    z.avail_out = static_cast<uInt>(out_now);
    const int status = inflate(&z, Z_NO_FLUSH);
    consumed += in_now - z.avail_in;
    used += out_now - z.avail_out;
    if (status == Z_STREAM_END) {
      // gzip files may be several streams one after the other.
      if (consumed + 2 <= packed.size() && packed[consumed] == '\x1f' && packed[consumed + 1] == '\x8b') {
        inflateReset(&z);
        continue;
      }
      result.complete = true;
      break;
    }
    if (status == Z_BUF_ERROR || (status == Z_OK && z.avail_out > 0)) {
      if (consumed >= packed.size() && z.avail_out > 0) break;
      if (status == Z_OK || z.avail_out == 0) continue;
      break;
    }
    if (status != Z_OK) throw FileError(file, fmt::format("damaged compressed data ({})", z.msg ? z.msg : "zlib"));
  }
  result.bytes.resize(used);
  return result;
}

void Input::fail_truncated(std::uint64_t missing_bytes, bool at_least) const {
  fail(fmt::format("truncated: {}{} byte{} missing", at_least ? "at least " : "", grouped(missing_bytes),
                   missing_bytes == 1 ? " is" : "s are"));
}

std::string grouped(std::uint64_t n) {
  const std::string digits = std::to_string(n);
  std::string s;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) s += ',';
    s += digits[i];
  }
  return s;
}

std::string lower(std::string_view s) {
  std::string r(s);
  for (char& c : r) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return r;
}

std::string ending(const std::string& file) {
  std::string name = lower(std::filesystem::path(file).filename().string());
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  const std::size_t dot = name.rfind('.');
  return dot == std::string::npos ? std::string() : name.substr(dot + 1);
}

Vec3 choose_origin(const Box3& box) {
  const double diagonal = box.diagonal();
  Vec3 origin;
  for (int k = 0; k < 3; ++k) {
    const double farthest = std::max(std::abs(box.lower[k]), std::abs(box.upper[k]));
    if (farthest <= 4 * diagonal || farthest == 0) continue;
    // The floor keeps the grid meaningful where the cloud is a single point.
    const double grid = std::exp2(std::floor(std::log2(std::max(diagonal, farthest * 0x1p-24))) - 1);
    origin[k] = std::round(box.center()[k] / grid) * grid;
  }
  return origin;
}

void set_scanner(PointSet& points, const Vec3& towards) {
  Box3 box;
  for (const Vec3f& p : points.positions) {
    if (is_finite(p)) box.extend(Vec3(p));
  }
  if (box.empty()) return;
  points.scanners.assign(1, Vec3f(box.center() + towards * (1000 * box.diagonal())));
  points.scan_of_point.assign(points.size(), 0);
}

void finish(const Input& in, PointSet& points) {
  const std::size_t n = points.positions.size();
  if (n == 0) in.fail("holds no points");
  if (n > 0xfffffffeu) in.fail(fmt::format("holds {} points; at most 4,294,967,294 are supported", grouped(n)));

  const std::size_t bad_triangle = parallel_reduce(
      points.triangles.size(), 1 << 16, points.triangles.size(),
      [&](std::size_t first, std::size_t last) {
        for (std::size_t t = first; t < last; ++t) {
          for (const std::uint32_t v : points.triangles[t]) {
            if (v >= n) return t;
          }
        }
        return points.triangles.size();
      },
      [](std::size_t a, std::size_t b) { return std::min(a, b); });
  if (bad_triangle < points.triangles.size()) {
    const auto& t = points.triangles[bad_triangle];
    const std::uint32_t v = t[0] >= n ? t[0] : t[1] >= n ? t[1] : t[2];
    const std::string which = v == 0xffffffffu ? "an impossible point number" : fmt::format("point {}", grouped(v));
    in.fail(
        fmt::format("a face refers to {}, but there are only {} points (0 to {})", which, grouped(n), grouped(n - 1)));
  }

  const std::size_t lost = parallel_reduce(
      n, 1 << 16, std::size_t{0},
      [&](std::size_t first, std::size_t last) {
        std::size_t count = 0;
        for (std::size_t i = first; i < last; ++i) count += !is_finite(points.positions[i]);
        return count;
      },
      [](std::size_t a, std::size_t b) { return a + b; });
  if (lost == n) in.fail(fmt::format("holds no points with finite coordinates (0 of {})", grouped(n)));
  if (lost > 0) {
    std::vector<std::uint8_t> gone(n);
    for (std::size_t i = 0; i < n; ++i) gone[i] = !is_finite(points.positions[i]);
    const std::size_t before = points.triangles.size();
    remove_samples(points, gone);
    in.warn(fmt::format("{} of {} points are not finite and were left out", grouped(lost), grouped(n)));
    if (before > points.triangles.size()) {
      in.warn(fmt::format("{} of {} triangles referred to them and were left out",
                          grouped(before - points.triangles.size()), grouped(before)));
    }
  }

  if (!points.normals.empty()) {
    const std::size_t with_direction = parallel_reduce(
        points.size(), 1 << 16, std::size_t{0},
        [&](std::size_t first, std::size_t last) {
          std::size_t count = 0;
          for (std::size_t i = first; i < last; ++i) {
            Vec3f& normal = points.normals[i];
            // In double: squares of tiny components would vanish in float.
            const Vec3 d(normal);
            const double length = norm(d);
            const bool good = std::isfinite(length) && length > 1e-30;
            // A normal that is unit already stays as it is, bit by bit.
            if (!good)
              normal = {};
            else if (std::abs(length - 1) > 1e-6)
              normal = Vec3f(d / length);
            count += good;
          }
          return count;
        },
        [](std::size_t a, std::size_t b) { return a + b; });
    if (with_direction == 0) {
      points.normals.clear();
      in.warn("all normals are zero and were left out");
    } else if (with_direction < points.size()) {
      in.warn(fmt::format("{} of {} normals are zero or not finite and count as unknown",
                          grouped(points.size() - with_direction), grouped(points.size())));
    }
  }
}

}  // namespace sansmesh::io
