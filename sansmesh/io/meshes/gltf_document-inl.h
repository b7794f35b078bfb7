// Document of glTF 2.0: its JSON, its buffers, and arrays of numbers in them. Only for sources.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/core/number_words.h"
#include "sansmesh/io/binary.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/input.h"
#include "sansmesh/io/meshes/vtk_xml.h"

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

enum class JsonKind : std::uint8_t { object, list, text, flag };

/// Parsed container. All errors of the file are FileErrors. Numbers stay valid as long as the document.
class GltfDocument {
 public:
  explicit GltfDocument(const Input& in);

  /// Number of objects in a list of the document ("nodes"), 0 if it is missing.
  std::size_t count(const char* list) const;
  /// The object `index` of a list; `user` refers to it in messages.
  const nlohmann::json& object(const char* list, std::size_t index, std::string_view user) const;
  const nlohmann::json& root() const { return *root_; }

  /// A member of an object; null if it is missing. Fails if it is of another kind.
  const nlohmann::json* member(const nlohmann::json& of, const char* key, JsonKind kind) const;
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
  std::shared_ptr<const nlohmann::json> root_;
  std::string_view binary_;  ///< binary chunk
  bool has_binary_ = false;
  std::size_t size_ = 0;
  std::vector<Buffer> buffers_;
  std::vector<std::optional<GltfNumbers>> accessors_;  ///< those that were requested
  std::size_t made_ = 0;                               ///< bytes of arrays that the file does not hold
  std::deque<std::vector<char>> owned_;                ///< decoded buffers and sparse arrays
  std::deque<FileContent> files_;
};

namespace gltf_detail {

inline constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
/// Bytes of all sparse arrays and arrays of zeros, which a small file can announce: at most this, or so many times
/// the size of the file.
inline constexpr std::size_t kMostMade = 64 << 20, kMostMadeOfSize = 16;
inline constexpr std::size_t kLongestName = 4096;
/// Largest count, index or offset: sums of two do not overflow.
inline constexpr std::uint64_t kMostIndex = std::uint64_t{1} << 53;

struct Compression {
  const char *extension, *name;
};
inline constexpr Compression kMeshCompressions[] = {{"KHR_draco_mesh_compression", "Draco"},
                                                    {"EXT_meshopt_compression", "meshopt"},
                                                    {"KHR_meshopt_compression", "meshopt"}};

inline std::string compressed(const Compression& how) {
  return fmt::format("is compressed with {} ({}), which is not read: export it without compression", how.name,
                     how.extension);
}

inline nlohmann::json::value_t type_of(JsonKind kind) {
  switch (kind) {
    case JsonKind::object:
      return nlohmann::json::value_t::object;
    case JsonKind::list:
      return nlohmann::json::value_t::array;
    case JsonKind::text:
      return nlohmann::json::value_t::string;
    default:
      return nlohmann::json::value_t::boolean;
  }
}

inline std::optional<NumberType> number_type(std::size_t component) {
  switch (component) {
    case 5120:
      return NumberType::i8;
    case 5121:
      return NumberType::u8;
    case 5122:
      return NumberType::i16;
    case 5123:
      return NumberType::u16;
    case 5125:
      return NumberType::u32;
    case 5126:
      return NumberType::f32;
    default:
      return std::nullopt;
  }
}

inline double largest_of(NumberType type) {
  switch (type) {
    case NumberType::i8:
      return 127;
    case NumberType::u8:
      return 255;
    case NumberType::i16:
      return 32767;
    case NumberType::u16:
      return 65535;
    case NumberType::u32:
      return 4294967295.0;
    default:
      return 1;
  }
}

inline std::size_t components_of(std::string_view type) {
  return type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
}

/// "a%20b" → "a b".
inline std::string percent_decoded(std::string_view uri) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : (c | 32) >= 'a' && (c | 32) <= 'f' ? (c | 32) - 'a' + 10 : -1;
  };
  std::string name;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
      name += static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2]));
      i += 2;
    } else {
      name += uri[i];
    }
  }
  return name;
}

}  // namespace gltf_detail

inline Column GltfNumbers::component(std::size_t k) const {
  return {first.at + k * size_of(first.type), first.stride, first.type, false};
}

inline GltfDocument::GltfDocument(const Input& in) : in_(in), size_(in.bytes.size()) {
  const bool binary = in.bytes.starts_with("glTF");
  in.report.format = binary ? "glTF binary" : "glTF";
  parse(binary ? json_of_container() : in.bytes);
  if (const nlohmann::json* const asset = member(*root_, "asset", JsonKind::object))
    if (const nlohmann::json* const version = member(*asset, "version", JsonKind::text))
      if (!version->get_ref<const std::string&>().starts_with("2"))
        in.fail(fmt::format("is glTF {}; version 2 is read", printable(version->get<std::string>(), 20)));
  if (const nlohmann::json* const required = member(*root_, "extensionsRequired", JsonKind::list))
    for (const nlohmann::json& name : *required)
      for (const gltf_detail::Compression& how : gltf_detail::kMeshCompressions)
        if (name == how.extension) in.fail(gltf_detail::compressed(how));
  buffers_.resize(count("buffers"));
  accessors_.resize(count("accessors"));
}

inline std::string_view GltfDocument::json_of_container() {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  const std::string_view bytes = in_.bytes;
  if (bytes.size() < kHeader + kChunkHeader) in_.fail_short(kHeader + kChunkHeader, bytes.size(), true);
  const auto number = [&](std::size_t at) { return load<std::uint32_t>(bytes.data() + at); };
  if (number(4) != 2) in_.fail(fmt::format("is binary glTF {}; version 2 is read", number(4)));
  const std::size_t end = number(8);
  if (end > bytes.size()) in_.fail_short(end, bytes.size());
  if (end < bytes.size()) in_.warn(fmt::format("{} bytes after its end were ignored", grouped(bytes.size() - end)));
  std::string_view text;
  for (std::size_t at = kHeader; at + kChunkHeader <= end;) {
    const std::size_t length = number(at), kind = number(at + 4);
    at += kChunkHeader;
    if (length > end - at)
      in_.fail(fmt::format("truncated: a chunk of {} bytes has {}", grouped(length), grouped(end - at)));
    if (kind == gltf_detail::kJsonChunk && text.empty()) text = bytes.substr(at, length);
    if (kind == gltf_detail::kBinaryChunk && !has_binary_) binary_ = bytes.substr(at, length), has_binary_ = true;
    at += length;
  }
  if (text.empty()) in_.fail("malformed glTF: has no JSON chunk");
  return text;
}

inline void GltfDocument::parse(std::string_view text) {
  try {
    root_ = std::make_shared<const nlohmann::json>(nlohmann::json::parse(text.begin(), text.end()));
  } catch (const nlohmann::json::parse_error& error) {
    in_.fail(fmt::format("malformed glTF: no JSON from byte {} on", grouped(error.byte)));
  } catch (const nlohmann::json::exception&) {
    in_.fail("malformed glTF: a number of its JSON is out of range");
  }
  if (!root_->is_object()) in_.fail("malformed glTF: its JSON is not an object");
}

inline std::size_t GltfDocument::count(const char* list) const {
  const nlohmann::json* const all = member(*root_, list, JsonKind::list);
  return all ? all->size() : 0;
}

inline const nlohmann::json& GltfDocument::object(const char* list, std::size_t index, std::string_view user) const {
  const std::size_t n = count(list);
  if (index >= n)
    in_.fail(fmt::format("malformed glTF: {} refers to entry {} of {}, which has {}", user, grouped(index), list,
                         grouped(n)));
  const nlohmann::json& found = (*root_)[list][index];
  if (!found.is_object())
    in_.fail(fmt::format("malformed glTF: entry {} of {} is not an object", grouped(index), list));
  return found;
}

inline const nlohmann::json* GltfDocument::member(const nlohmann::json& of, const char* key, JsonKind kind) const {
  const auto found = of.find(key);
  if (found == of.end()) return nullptr;
  if (found->type() != gltf_detail::type_of(kind))
    in_.fail(fmt::format("malformed glTF: '{}' is of the wrong type", key));
  return &*found;
}

inline std::optional<std::size_t> GltfDocument::whole(const nlohmann::json& of, const char* key) const {
  const auto found = of.find(key);
  if (found == of.end()) return std::nullopt;
  if (found->is_number_unsigned() && found->get<std::uint64_t>() <= gltf_detail::kMostIndex)
    return static_cast<std::size_t>(found->get<std::uint64_t>());
  if (found->is_number_float()) {
    const double value = found->get<double>();
    if (value >= 0 && value <= static_cast<double>(gltf_detail::kMostIndex) && value == std::floor(value))
      return static_cast<std::size_t>(value);
  }
  in_.fail(fmt::format("malformed glTF: '{}' is not a count", key));
}

inline std::optional<std::vector<double>> GltfDocument::numbers(const nlohmann::json& of, const char* key,
                                                                std::size_t size) const {
  const nlohmann::json* const list = member(of, key, JsonKind::list);
  if (!list) return std::nullopt;
  std::vector<double> values;
  for (const nlohmann::json& value : *list) {
    if (!value.is_number()) break;
    values.push_back(value.get<double>());
  }
  if (values.size() != size || list->size() != size)
    in_.fail(fmt::format("malformed glTF: '{}' has not {} numbers", key, size));
  return values;
}

inline bool GltfDocument::has_extension(const nlohmann::json& of, const char* name) const {
  const nlohmann::json* const all = member(of, "extensions", JsonKind::object);
  return all && all->contains(name);
}

inline std::string_view GltfDocument::buffer(std::size_t index) {
  const nlohmann::json& described = object("buffers", index, "a view");
  Buffer& b = buffers_[index];
  if (!b.loaded) {
    if (const nlohmann::json* const uri = member(described, "uri", JsonKind::text))
      b.bytes = buffer_of_uri(index, uri->get_ref<const std::string&>());
    else if (index == 0 && has_binary_)
      b.bytes = binary_;
    else
      in_.fail(fmt::format("malformed glTF: buffer {} has no data", grouped(index)));
    const std::size_t length = whole(described, "byteLength").value_or(b.bytes.size());
    if (length > b.bytes.size())
      in_.fail(fmt::format("truncated: buffer {} has {} of {} bytes", grouped(index), grouped(b.bytes.size()),
                           grouped(length)));
    b.bytes = b.bytes.substr(0, length);
    b.loaded = true;
  }
  return b.bytes;
}

inline std::string_view GltfDocument::buffer_of_uri(std::size_t index, std::string_view uri) {
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64"))
      in_.fail(fmt::format("malformed glTF: buffer {} is not base64", grouped(index)));
    owned_.push_back(decode_base64(uri.substr(comma + 1)));
    return {owned_.back().data(), owned_.back().size()};
  }
  const std::string name = gltf_detail::percent_decoded(uri.substr(0, gltf_detail::kLongestName));
  const std::filesystem::path path(name);
  const bool inside = std::none_of(path.begin(), path.end(), [](const auto& part) { return part == ".."; });
  if (uri.size() > gltf_detail::kLongestName || name.empty() || name.find('\0') != std::string::npos ||
      path.is_absolute() || !inside || name.find(':') != std::string::npos)
    in_.fail(fmt::format("has its data at '{}'; only files in its folder are read", printable(name, 200)));
  try {
    files_.emplace_back((std::filesystem::path(in_.file).parent_path() / path).string());
  } catch (const FileError& error) {
    in_.fail(fmt::format("the file of its data cannot be read: {}", error.what()));
  }
  size_ += files_.back().bytes().size();
  return files_.back().bytes();
}

inline std::string_view GltfDocument::view(std::size_t index, std::size_t& stride) {
  const nlohmann::json& described = object("bufferViews", index, "an accessor");
  const std::size_t whose = whole(described, "buffer").value_or(0);
  for (const gltf_detail::Compression& how : gltf_detail::kMeshCompressions)
    if (has_extension(described, how.extension) && !object("buffers", whose, "a view").contains("uri") &&
        !(whose == 0 && has_binary_))
      in_.fail(gltf_detail::compressed(how));
  const std::string_view all = buffer(whose);
  const std::size_t offset = whole(described, "byteOffset").value_or(0);
  const auto length = whole(described, "byteLength");
  if (!length) in_.fail(fmt::format("malformed glTF: view {} has no length", grouped(index)));
  if (offset > all.size() || *length > all.size() - offset)
    in_.fail(fmt::format("malformed glTF: view {} ends at byte {} of a buffer of {}", grouped(index),
                         grouped(offset + *length), grouped(all.size())));
  stride = whole(described, "byteStride").value_or(0);
  return all.substr(offset, *length);
}

inline const char* GltfDocument::elements(std::size_t view_index, std::size_t offset, std::size_t count,
                                          std::size_t bytes, std::size_t& stride) {
  const std::string_view all = view(view_index, stride);
  if (stride == 0) stride = bytes;
  if (stride < bytes) in_.fail(fmt::format("malformed glTF: elements of view {} overlap", grouped(view_index)));
  const bool fits =
      offset <= all.size() &&
      (count == 0 || (all.size() - offset >= bytes && count - 1 <= (all.size() - offset - bytes) / stride));
  if (!fits)
    in_.fail(fmt::format("malformed glTF: {} elements of {} bytes are more than view {} has ({} bytes)", grouped(count),
                         bytes, grouped(view_index), grouped(all.size())));
  return all.data() + offset;
}

inline GltfNumbers GltfDocument::accessor(std::size_t index, std::string_view user) {
  const nlohmann::json& described = object("accessors", index, user);
  std::optional<GltfNumbers>& known = accessors_[index];
  if (known) return *known;
  GltfNumbers numbers;
  numbers.count = whole(described, "count").value_or(0);
  const auto type = gltf_detail::number_type(whole(described, "componentType").value_or(0));
  const nlohmann::json* const kind = member(described, "type", JsonKind::text);
  numbers.components = kind ? gltf_detail::components_of(kind->get_ref<const std::string&>()) : 0;
  if (!type || numbers.components == 0)
    in_.fail(fmt::format("malformed glTF: accessor {} has an unknown type", grouped(index)));
  numbers.first.type = *type;
  if (const nlohmann::json* const normalized = member(described, "normalized", JsonKind::flag);
      normalized && normalized->get<bool>())
    numbers.scale = 1 / gltf_detail::largest_of(*type);
  const std::size_t bytes = numbers.components * size_of(*type);
  const auto view_index = whole(described, "bufferView");
  if (view_index) {
    numbers.first.at =
        elements(*view_index, whole(described, "byteOffset").value_or(0), numbers.count, bytes, numbers.first.stride);
  } else {
    numbers.first.at = make(numbers.count, bytes).data(), numbers.first.stride = bytes;
  }
  if (const nlohmann::json* const sparse = member(described, "sparse", JsonKind::object))
    apply_sparse(*sparse, numbers);
  known = numbers;
  return numbers;
}

inline std::vector<char>& GltfDocument::make(std::size_t count, std::size_t bytes) {
  const std::size_t most = std::max(gltf_detail::kMostMade, gltf_detail::kMostMadeOfSize * size_);
  if (count > (most - made_) / bytes)
    in_.fail(fmt::format("malformed glTF: {} elements of accessors have no data of their own", grouped(count)));
  made_ += count * bytes;
  return owned_.emplace_back(count * bytes);
}

inline void GltfDocument::apply_sparse(const nlohmann::json& sparse, GltfNumbers& numbers) {
  const nlohmann::json* const places = member(sparse, "indices", JsonKind::object);
  const nlohmann::json* const values = member(sparse, "values", JsonKind::object);
  const std::size_t count = whole(sparse, "count").value_or(0),
                    bytes = numbers.components * size_of(numbers.first.type);
  const auto type = places ? gltf_detail::number_type(whole(*places, "componentType").value_or(0)) : std::nullopt;
  if (!type || !values || *type == NumberType::f32 || count > numbers.count)
    in_.fail("malformed glTF: a sparse accessor is incomplete");
  const auto start = [&](const nlohmann::json& part, std::size_t size, std::size_t& stride) {
    const auto where = whole(part, "bufferView");
    if (!where) in_.fail("malformed glTF: a sparse accessor has no data");
    return elements(*where, whole(part, "byteOffset").value_or(0), count, size, stride);
  };
  Column index{nullptr, 0, *type};
  index.at = start(*places, size_of(*type), index.stride);
  std::size_t stride = 0;
  const char* const from = start(*values, bytes, stride);
  std::vector<char>& dense = make(numbers.count, bytes);
  for (std::size_t i = 0; i < numbers.count; ++i)
    std::copy_n(numbers.first.at + i * numbers.first.stride, bytes, dense.data() + i * bytes);
  for (std::size_t i = 0; i < count; ++i) {
    const double to = index[i];
    if (!(to >= 0 && to < static_cast<double>(numbers.count)))
      in_.fail("malformed glTF: a sparse accessor replaces an element that does not exist");
    std::copy_n(from + i * stride, bytes, dense.data() + static_cast<std::size_t>(to) * bytes);
  }
  numbers.first.at = dense.data(), numbers.first.stride = bytes;
}

}  // namespace sansmesh::inline v1::io
