// Tokens of CSG expressions.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::inline v1 {

struct CsgToken {
  enum class Kind { name, quoted, number, symbol, end };
  Kind kind = Kind::end;
  std::string text;    ///< as written; for quoted tokens the text between the quotes
  double number = 0;   ///< value of a number token, without sign
  std::size_t at = 0;  ///< position of its first character, counted from 1
  bool is(char symbol) const { return kind == Kind::symbol && text[0] == symbol; }
};

/// All tokens, the last one of kind end. Throws ArgumentError.
std::vector<CsgToken> csg_tokens(std::string_view text);

/// Throws ArgumentError "expression at AT: CAUSE".
[[noreturn]] void csg_error(std::size_t at, const std::string& cause);

}  // namespace sansmesh::inline v1
