#include "sansmesh/io/grids/netcdf_size.h"

#include <algorithm>
#include <vector>

#include "sansmesh/io/binary.h"

namespace sansmesh::inline v1::io {
namespace {

/// Iterates over the header, which is big endian and padded to multiples of four bytes.
class NetcdfHeader {
 public:
  explicit NetcdfHeader(const Input& in) : in_(in), version_(in.bytes.size() > 3 ? in.bytes[3] : 0) {}

  std::uint64_t count() { return version_ == 5 ? number<std::uint64_t>() : number<std::uint32_t>(); }
  std::uint64_t offset() { return version_ == 1 ? number<std::uint32_t>() : number<std::uint64_t>(); }
  template <class T>
  T number() {
    need(sizeof(T));
    const T v = load<T, true>(in_.bytes.data() + at_);
    at_ += sizeof(T);
    return v;
  }
  void skip(std::uint64_t bytes) {
    if (bytes > in_.bytes.size()) damaged();
    bytes = (bytes + 3) / 4 * 4;
    need(bytes);
    at_ += bytes;
  }
  /// The number of entries of a list, which begins with `tag`, or with zeros if it is empty.
  std::uint64_t list(std::uint32_t tag) {
    const std::uint32_t found = number<std::uint32_t>();
    const std::uint64_t n = count();
    if ((found != tag && !(found == 0 && n == 0)) || n > in_.bytes.size()) damaged();
    return n;
  }
  std::uint64_t type_size() {
    constexpr std::uint64_t sizes[] = {1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    const std::uint32_t type = number<std::uint32_t>();
    if (type < 1 || type > std::size(sizes)) damaged();
    return sizes[type - 1];
  }
  void skip_attributes() {
    for (std::uint64_t n = list(12); n > 0; --n) {
      skip(count());
      const std::uint64_t size = type_size(), values = count();
      if (values > in_.bytes.size()) damaged();
      skip(size * values);
    }
  }
  [[noreturn]] void damaged() const { in_.fail("its NetCDF header is damaged"); }

 private:
  void need(std::uint64_t bytes) const {
    if (bytes > in_.bytes.size() - at_) in_.fail("truncated: its NetCDF header does not end");
  }
  const Input& in_;
  char version_;
  std::size_t at_ = 4;
};

}  // namespace

void check_netcdf_size(const Input& in) {
  if (in.bytes.size() < 4) in.fail("truncated: its NetCDF header does not end");
  NetcdfHeader header(in);
  const std::uint64_t records = header.count();
  const bool streaming = records == 0xffffffffu || records == ~std::uint64_t{0};
  std::vector<std::uint64_t> dims;
  for (std::uint64_t n = header.list(10); n > 0; --n) {
    header.skip(header.count());
    dims.push_back(header.count());  // 0: that of the records
  }
  header.skip_attributes();
  std::uint64_t end = 0, record = 0, first_record = ~std::uint64_t{0};
  for (std::uint64_t n = header.list(11); n > 0; --n) {
    header.skip(header.count());
    std::uint64_t values = 1;
    bool in_records = false;
    const std::uint64_t rank = header.count();
    if (rank > 1024) header.damaged();
    for (std::uint64_t k = 0; k < rank; ++k) {
      const std::uint64_t d = header.count();
      if (d >= dims.size()) header.damaged();
      if (k == 0 && dims[d] == 0)
        in_records = true;
      else if (dims[d] != 0 && values > (std::uint64_t{1} << 48) / dims[d])
        header.damaged();
      else
        values *= dims[d];
    }
    header.skip_attributes();
    const std::uint64_t size = (header.type_size() * values + 3) / 4 * 4;
    header.count();  // the same size, truncated to 32 bits
    const std::uint64_t begin = header.offset();
    if (begin > std::uint64_t{1} << 60) header.damaged();
    if (in_records)
      record += size, first_record = std::min(first_record, begin);
    else
      end = std::max(end, begin + size);
  }
  if (record > 0 && records > 0 && !streaming) {
    if (records > (std::uint64_t{1} << 50) / record) header.damaged();
    end = std::max(end, first_record + records * record);
  }
  // The padding of the last array may be missing.
  if (end > in.bytes.size() + 3) in.fail_short(end, in.bytes.size());
}

}  // namespace sansmesh::inline v1::io
