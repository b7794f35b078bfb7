#include "sansmesh/csg/csg_tokens.h"

#include <fmt/core.h>

#include <charconv>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMaxLength = std::size_t{1} << 20;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Characters of unquoted names. Bytes of non-ASCII characters count as letters.
bool is_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '_' || c == '.' || c == '/' ||
         static_cast<unsigned char>(c) >= 0x80;
}

class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  std::vector<CsgToken> run() {
    std::vector<CsgToken> tokens;
    do {
      while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
      tokens.push_back(next());
    } while (tokens.back().kind != CsgToken::Kind::end);
    return tokens;
  }

 private:
  char peek(std::size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }

  /// Counts characters, not bytes.
  std::size_t position() {
    for (; counted_ < at_; ++counted_) characters_ += (static_cast<unsigned char>(text_[counted_]) & 0xC0) != 0x80;
    return characters_ + 1;
  }

  CsgToken next() {
    CsgToken token;
    token.at = position();
    if (at_ == text_.size()) return token;
    const char c = peek();
    if (c == '\'' || c == '"') return quoted(token);
    if (is_name(c)) return name_or_number(token);
    if (c == '~' && peek(1) == '/')
      csg_error(token.at, "~/ is not the home folder here but a complement: write the path in full, or ~ '/…'");
    if (c == '*') csg_error(token.at, "'*' has no meaning: & is the intersection, scale(…, 2) scales");
    if (std::string_view("()|+-&~=,").find(c) == std::string_view::npos)
      csg_error(token.at, c > ' ' && c < 0x7F ? fmt::format("unexpected '{}'; file names with it need quotes", c)
                                              : std::string("unexpected control character"));
    token.kind = CsgToken::Kind::symbol;
    token.text = c;
    ++at_;
    return token;
  }

  CsgToken quoted(CsgToken token) {
    const std::size_t end = text_.find(text_[at_], at_ + 1);
    if (end == std::string_view::npos) csg_error(token.at, "the quote that opens here is not closed");
    token.kind = CsgToken::Kind::quoted;
    token.text = text_.substr(at_ + 1, end - at_ - 1);
    if (token.text.empty()) csg_error(token.at, "there is no name between the quotes");
    at_ = end + 1;
    return token;
  }

  CsgToken name_or_number(CsgToken token) {
    const char* const first = text_.data() + at_;
    const char* const last = text_.data() + text_.size();
    if (is_digit(*first) || *first == '.') {
      const auto [end, error] = std::from_chars(first, last, token.number);
      if (error != std::errc::invalid_argument && (end == last || !is_name(*end))) {
        token.text = std::string(first, end);
        if (error != std::errc()) csg_error(token.at, fmt::format("the number {} is too large or small", token.text));
        token.kind = CsgToken::Kind::number;
        at_ += static_cast<std::size_t>(end - first);
        return token;
      }
    }
    const std::size_t begin = at_;
    while (is_name(peek())) ++at_;
    if (peek() == '[') {  // data.vtu[Temp=300], a surface in a volume
      const std::size_t close = text_.find(']', at_);
      if (close == std::string_view::npos) csg_error(token.at, "the bracket of this name is not closed");
      at_ = close + 1;
    }
    token.kind = CsgToken::Kind::name;
    token.text = text_.substr(begin, at_ - begin);
    // Neither a difference nor a hyphen in the name would be unambiguous.
    if (peek() == '-' && is_name(peek(1))) {
      std::size_t end = at_ + 1;
      while (end < text_.size() && (is_name(text_[end]) || text_[end] == '-')) ++end;
      csg_error(token.at, fmt::format("is '{}' one name or a difference? Put quotes around a file name with a dash, or "
                                      "blanks around the minus of a difference",
                                      text_.substr(begin, end - begin)));
    }
    return token;
  }

  std::string_view text_;
  std::size_t at_ = 0, counted_ = 0, characters_ = 0;
};

}  // namespace

std::vector<CsgToken> csg_tokens(std::string_view text) {
  if (text.size() > kMaxLength) throw ArgumentError("expression: longer than a million characters");
  return Lexer(text).run();
}

void csg_error(std::size_t at, const std::string& cause) {
  throw ArgumentError(fmt::format("expression at {}: {}", at, printable(cause, 400)));
}

}  // namespace sansmesh::inline v1
