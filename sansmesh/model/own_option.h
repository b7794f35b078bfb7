// Options of a single surface method, which a program adds together with the method.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "sansmesh/option.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {

/// A name as a template argument.
template <std::size_t n>
struct OptionName {
  char text[n] = {};
  // NOLINTNEXTLINE(google-explicit-constructor): written as a literal
  constexpr OptionName(const char (&literal)[n]) { std::copy_n(literal, n, text); }
  constexpr operator std::string_view() const { return {text, n - 1}; }
};

/// An option of a surface, stored in SurfaceOptions::own under its name, which begins with the surface's. `usual` is
/// its default and determines its type: a bool, a whole or a real number, or an enumerator, whose words are the
/// `choices`.
///
///   constexpr OwnOption<"shepard_neighbours", 10> kNeighbours({.text = "Samples in a mean", .range = {3, 50}});
///   constexpr OptionRow kOwn[] = {kNeighbours};  // SurfaceMethod::own
///   const int n = kNeighbours.of(options);
template <OptionName name, auto usual>
class OwnOption {
 public:
  using Value = std::remove_const_t<decltype(usual)>;

  constexpr explicit OwnOption(const OptionFacts& facts) {
    static_cast<OptionFacts&>(row_) = facts;
    row_.name = name;
    row_.kind = Field::kind;
    row_.get = get;
    row_.set = [](void* o, const OptionValue& value) {
      static_cast<SurfaceOptions*>(o)->own.insert_or_assign(std::string(row_name()), value);
    };
  }
  // NOLINTNEXTLINE(google-explicit-constructor): a row of SurfaceMethod::own
  constexpr operator OptionRow() const { return row_; }

  /// The value in valid options.
  Value of(const SurfaceOptions& options) const {
    OptionValue value = get(&options);
    if constexpr (std::is_enum_v<Value>) {
      if (const auto* const word = std::get_if<std::string>(&value))
        value = std::int64_t{std::find(row_.choices.begin(), row_.choices.end(), *word) - row_.choices.begin()};
    }
    if (const auto* const whole = std::get_if<std::int64_t>(&value); whole && std::is_floating_point_v<Value>)
      value = static_cast<double>(*whole);
    return Field::from(value);
  }

 private:
  using Field = schema_detail::Field<Value>;

  static constexpr std::string_view row_name() { return name; }
  static OptionValue get(const void* o) {
    const auto& own = static_cast<const SurfaceOptions*>(o)->own;
    const auto found = own.find(row_name());
    return found == own.end() ? Field::get(usual) : found->second;
  }

  OptionRow row_;
};

}  // namespace sansmesh::inline v1
