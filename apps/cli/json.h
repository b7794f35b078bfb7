// Results for programs, put together as they will be printed.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sansmesh::cli {

/// Version of the keys that --json prints. It grows when a key goes or changes its meaning.
inline constexpr int kReportVersion = 1;

/// A value of JSON; objects keep the order of their fields. Written in braces: a list of pairs that begin with a text
/// is an object, `{{"file", name}, {"samples", n}}`, any other list an array, `{x, y, z}`.
class Json {
 public:
  Json() = default;  ///< null
  Json(std::nullptr_t) {}
  template <std::same_as<bool> T>
  Json(T value) : kind_(Kind::truth), whole_(value ? 1 : 0) {}
  template <std::integral T>
  requires(!std::same_as<T, bool>) Json(T value)
      : kind_(std::signed_integral<T> ? Kind::whole : Kind::natural), whole_(static_cast<std::uint64_t>(value)) {}
  template <std::floating_point T>
  Json(T value) : kind_(Kind::real), real_(static_cast<double>(value)) {}
  Json(const char* text) : Json(std::string(text)) {}
  Json(std::string_view text) : Json(std::string(text)) {}
  Json(std::string text) : kind_(Kind::text), text_(std::move(text)) {}
  Json(std::initializer_list<Json> list);
  template <class T>
  Json(const std::vector<T>& list) : kind_(Kind::array), items_(list.begin(), list.end()) {}
  template <class T, std::size_t n>
  Json(const std::array<T, n>& list) : kind_(Kind::array), items_(list.begin(), list.end()) {}
  /// Null where there is none.
  template <class T>
  Json(const std::optional<T>& value) {
    if (value) *this = Json(*value);
  }
  Json(const Json&);
  Json(Json&&) noexcept;
  Json& operator=(const Json&);
  Json& operator=(Json&&) noexcept;
  ~Json();

  /// An empty array.
  static Json array();
  static Json object();

  bool is_null() const { return kind_ == Kind::null; }
  /// The field of an object, added if it is not there. Null becomes an object.
  Json& operator[](std::string_view key);
  /// The same of objects within objects, "output.file". Null where `add` is false and one of these is null.
  Json* at(std::string_view path, bool add);
  /// Null becomes an array.
  void push_back(Json value);

  /// Indented by two blanks. Bytes that are not UTF-8, as names of files can have, are replaced.
  std::string text() const;

 private:
  enum class Kind : std::uint8_t { null, truth, whole, natural, real, text, array, object };
  struct Writer;

  Kind kind_ = Kind::null;
  std::uint64_t whole_ = 0;
  double real_ = 0;
  std::string text_;
  std::vector<std::string> keys_;  // of an object, one for each item
  std::vector<Json> items_;
};

}  // namespace sansmesh::cli
