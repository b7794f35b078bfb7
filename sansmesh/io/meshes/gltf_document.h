// Document of glTF 2.0: its JSON, its buffers, and arrays of numbers in them.
#pragma once

#include <cstddef>
#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "sansmesh/io/binary.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

/// Numbers of an accessor, `components` per element.
struct GltfNumbers {
  Column first;  ///< first component of all elements
  std::size_t count = 0, components = 1;
  double scale = 1;  ///< factor of normalised integers, so that the largest becomes 1

  Column component(std::size_t k) const;
  double operator()(std::size_t i, std::size_t k) const {
    const double value = scale * component(k)[i];
    return scale < 1 && value < -1 ? -1 : value;
  }
};

/// Parsed container. All errors of the file are FileErrors. Numbers stay valid as long as the document.
class GltfDocument {
 public:
  explicit GltfDocument(const Input& in);

  /// Number of objects in a list of the document ("nodes"), 0 if it is missing.
  std::size_t count(const char* list) const;
  /// The object `index` of a list; `user` refers to it in messages.
  const nlohmann::json& object(const char* list, std::size_t index, std::string_view user) const;
  const nlohmann::json& root() const { return root_; }

  /// A member of an object; null if it is missing. Fails if it is of another kind.
  const nlohmann::json* member(const nlohmann::json& of, const char* key, nlohmann::json::value_t kind) const;
  /// A member that is an index, a count or an offset.
  std::optional<std::size_t> whole(const nlohmann::json& of, const char* key) const;
  /// `size` numbers of a list; nothing if the member is missing.
  std::optional<std::vector<double>> numbers(const nlohmann::json& of, const char* key, std::size_t size) const;
  /// Whether an object has the extension.
  bool has_extension(const nlohmann::json& of, const char* name) const;

  /// The elements of an accessor.
  GltfNumbers accessor(std::size_t index, std::string_view user);
  /// Bytes of the file and of the buffers beside it.
  std::size_t size() const { return size_; }

 private:
  struct Buffer {
    bool loaded = false;
    std::string_view bytes;
  };
  std::string_view json_of_container();
  void parse(std::string_view text);
  std::string_view buffer(std::size_t index);
  std::string_view buffer_of_uri(std::size_t index, std::string_view uri);
  /// Bytes and stride (0: none) of a view.
  std::string_view view(std::size_t index, std::size_t& stride);
  /// Checks that `count` elements of `bytes` are inside of a view, and returns the first.
  const char* elements(std::size_t view_index, std::size_t offset, std::size_t count, std::size_t bytes,
                       std::size_t& stride);
  /// A new array of zeros.
  std::vector<char>& make(std::size_t count, std::size_t bytes);
  void apply_sparse(const nlohmann::json& sparse, GltfNumbers& numbers);

  const Input& in_;
  nlohmann::json root_;
  std::string_view binary_;  ///< binary chunk
  bool has_binary_ = false;
  std::size_t size_ = 0;
  std::vector<Buffer> buffers_;
  std::vector<std::optional<GltfNumbers>> accessors_;  ///< those that were requested
  std::size_t made_ = 0;                               ///< bytes of arrays that the file does not hold
  std::deque<std::vector<char>> owned_;                ///< decoded buffers and sparse arrays
  std::deque<FileContent> files_;
};

}  // namespace sansmesh::inline v1::io
