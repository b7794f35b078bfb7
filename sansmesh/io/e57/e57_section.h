// Compressed vectors of E57 files: records of one scan, stored as one stream of bits per field, divided into packets.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/io/e57/e57_pages.h"

namespace sansmesh::inline v1::io {

enum class E57Kind : std::uint8_t { integer, scaled, real32, real64, text };

/// A field of the records. Integers from `lowest` to `highest` are stored as the difference to `lowest`, in the least
/// number of bits; scaled ones are `scale` · integer + `offset`.
struct E57Field {
  std::string name;  ///< with the prefix of its extension: "nor:normalX"
  E57Kind kind = E57Kind::real64;
  std::int64_t lowest = 0, highest = 0;
  double scale = 1, offset = 0;
  std::optional<double> least, largest;  ///< announced range of the numbers

  bool is_whole() const { return kind == E57Kind::integer || kind == E57Kind::scaled; }
  /// Bits of a number; 0 for constants and texts.
  unsigned bits() const;
};

/// All numbers of a field, as stored.
class E57Column {
 public:
  /// The numbers [first, first + n) as reals, or, for fields of integers, as stored (without scale and offset).
  void reals(std::size_t first, std::size_t n, double* out) const;
  void integers(std::size_t first, std::size_t n, std::int64_t* out) const;
  const E57Field& field() const { return *field_; }

 private:
  friend class E57Section;
  const E57Field* field_ = nullptr;
  E57Bytes bytes_;
};

class E57Section {
 public:
  /// Reads the section at `offset` (a position in the file) with `records` records of `fields`, which must outlive
  /// this. `name` names the scan in messages. Throws FileError if the section is damaged or has too few bits.
  E57Section(const Input& in, const E57Pages& pages, std::uint64_t offset, std::uint64_t records,
             const std::vector<E57Field>& fields, const std::string& name);

  /// Bytes of the section in the file.
  std::size_t size() const { return bytes_.size; }
  /// Joins the parts of a field, which is no text.
  E57Column column(std::size_t field) const;

 private:
  struct Packet {
    std::size_t at = 0;      ///< first length of the packet's streams
    std::size_t stream = 0;  ///< first stream
  };

  std::size_t length_of(const Packet& packet, std::size_t field) const;

  const std::vector<E57Field>& fields_;
  std::uint64_t records_;
  E57Bytes bytes_;
  std::vector<Packet> packets_;
};

}  // namespace sansmesh::inline v1::io
