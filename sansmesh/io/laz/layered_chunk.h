// Chunks of point formats 6 to 10: each attribute is compressed by itself, as a layer, so that layers can be skipped.
//
// Each scanner channel (0 to 3) has models and a last point. Version 3 of the format has two defects that it must keep,
// in colours, wave packets and extra bytes: only the first point after a change of the channel uses the models of its
// channel, the others those of channel 0; and after a change to a channel that has occurred before, the point is
// predicted from the last point of the previous channel, which also receives the result. Version 4 has neither.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "sansmesh/io/laz/laz_layout.h"

namespace sansmesh::inline v1::io::laz {

/// Appends `count` records of `layout.record` bytes to `out`, compressed (version 3).
void encode_layered(const LazLayout& layout, const char* records, std::size_t count, std::string& out);

/// A chunk whose layers are decoded on demand.
class LayeredChunk {
 public:
  /// `bytes` begin with a chunk of `count` > 0 points and may contain more. They must outlive this.
  LayeredChunk(const LazLayout& layout, std::string_view bytes, std::size_t count, char* records);
  ~LayeredChunk();
  LayeredChunk(const LayeredChunk&) = delete;
  LayeredChunk& operator=(const LayeredChunk&) = delete;

  /// Length in bytes; 0 if the head of the chunk is damaged.
  std::size_t length() const { return length_; }
  /// Decode the records. False if the chunk is damaged. Positions come first.
  bool decode_positions();
  bool decode_rest();

 private:
  struct Steps;
  const LazLayout& layout_;
  std::string_view bytes_;
  std::size_t count_, length_ = 0;
  char* records_;
  std::unique_ptr<Steps> steps_;
};

}  // namespace sansmesh::inline v1::io::laz
