#include "sansmesh/csg/parse_csg.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <vector>

#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/csg/csg_functions.h"
#include "sansmesh/csg/csg_tokens.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

using Token = CsgToken;
using Kind = CsgParameter::Kind;

/// Limit of nested parentheses, which the parser handles recursively; solids have the same limit (solid_node.cpp).
constexpr int kMaxParentheses = 1000;

std::string shown(const Token& t) {
  if (t.kind == Token::Kind::end) return "the end";
  const std::string text = t.text.size() > 40 ? t.text.substr(0, 40) + "…" : t.text;
  return t.kind == Token::Kind::number ? "the number " + text : "'" + text + "'";
}

class Parser {
 public:
  Parser(const std::string& text, const SolidLoader& loader, const SolidLoader& distance_loader)
      : tokens_(csg_tokens(text)), loader_(loader), distance_loader_(distance_loader) {}

  Solid run() {
    if (token().kind == Token::Kind::end) throw ArgumentError("expression: empty");
    Solid result = sum();
    if (token().is(')')) csg_error(token().at, "')' without a '(' before it");
    if (token().kind != Token::Kind::end)
      csg_error(token().at, fmt::format("expected an operator (| + & -) or the end, found {}", shown(token())));
    return result;
  }

 private:
  const Token& token(std::size_t ahead = 0) const { return tokens_[std::min(next_ + ahead, tokens_.size() - 1)]; }
  bool accept(char symbol) {
    if (!token().is(symbol)) return false;
    ++next_;
    return true;
  }

  /// Runs of one operator become balanced trees: a − b − c is a without the union of b and c.
  Solid sum() {
    Solid result = product();
    while (token().is('|') || token().is('+') || token().is('-')) {
      const bool minus = token().is('-');
      const std::size_t at = token().at;
      std::vector<Solid> run;
      if (!minus) run.push_back(result);
      while (minus ? token().is('-') : token().is('|') || token().is('+')) {
        ++next_;
        run.push_back(product());
      }
      result = made(at, [&] {
        const Solid all = combine_all(run, false);
        return minus ? csg::subtract(result, all) : all;
      });
    }
    return result;
  }

  Solid product() {
    const std::size_t at = token().at;
    std::vector<Solid> run{unary()};
    while (accept('&')) run.push_back(unary());
    return made(at, [&] { return combine_all(run, true); });
  }

  Solid unary() {
    bool turned = false;
    const std::size_t at = token().at;
    while (accept('~')) turned = !turned;
    Solid result = primary();
    return turned ? made(at, [&] { return csg::complement(result); }) : result;
  }

  Solid primary() {
    check_cancelled();
    const Token& t = token();
    if (t.is('(')) {
      descend(t);
      ++next_;
      Solid result = sum();
      if (!accept(')')) not_closed(t);
      --depth_;
      return result;
    }
    if (t.kind == Token::Kind::name && token(1).is('(')) return call();
    if (t.kind == Token::Kind::name || t.kind == Token::Kind::quoted) {
      ++next_;
      return load(t);
    }
    no_solid(t);
  }

  // Recursive functions keep error texts out of their stack frames, because there may be a thousand frames.

  [[noreturn, gnu::noinline]] void not_closed(const Token& open) const {
    csg_error(token().at, fmt::format("expected an operator (| + & -) or ')' for the '(' at {}, found {}", open.at,
                                      shown(token())));
  }
  [[noreturn, gnu::noinline]] static void no_solid(const Token& t) {
    if (t.is('-')) csg_error(t.at, "expected a solid, found '-'; ~ is the complement");
    if (t.kind == Token::Kind::number)
      csg_error(t.at, fmt::format("expected a solid, found {}; numbers may need a name (r={}), file names quotes",
                                  shown(t), t.text));
    csg_error(t.at, fmt::format("expected a solid, found {}", shown(t)));
  }
  [[noreturn, gnu::noinline]] void no_argument(const CsgFunction& f) const {
    csg_error(token().at, fmt::format("expected ',' or ')' in {}(…), found {}", f.name, shown(token())));
  }
  [[noreturn, gnu::noinline]] void no_name(const CsgFunction& f) const {
    csg_error(token().at, fmt::format("{}: arguments without a name come before those with one", f.name));
  }
  [[noreturn, gnu::noinline]] void too_many(const CsgFunction& f) const {
    csg_error(token().at, fmt::format("{}: too many arguments: {}", f.name, takes(f)));
  }

  [[gnu::noinline]] void descend(const Token& t) {
    if (++depth_ > kMaxParentheses) csg_error(t.at, fmt::format("nested more than {} deep", kMaxParentheses));
  }

  [[gnu::noinline]] Solid load(const Token& t) {
    const bool far = distances_ > 0 && distance_loader_;
    std::map<std::string, Solid>& loaded = far ? loaded_distances_ : loaded_;
    if (const auto known = loaded.find(t.text); known != loaded.end()) return known->second;
    if (t.kind == Token::Kind::name)
      for (const CsgFunction& f : csg_functions())
        if (t.text == f.name) csg_error(t.at, fmt::format("expected '(' after {}", t.text));
    return loaded.emplace(t.text, (far ? distance_loader_ : loader_)(t.text)).first->second;
  }

  // ---- calls -------------------------------------------------------------------------------------------------------

  [[gnu::noinline]] static const CsgFunction& function_of(const Token& name) {
    std::string known;
    for (const CsgFunction& f : csg_functions()) {
      if (name.text == f.name) return f;
      known += (known.empty() ? "" : ", ") + std::string(f.name);
    }
    csg_error(name.at, fmt::format("there is no function {}; known are {}", shown(name), known));
  }

  Solid call() {
    const Token& name = token();
    const CsgFunction* const function = &function_of(name);
    descend(name);
    next_ += 2;
    CsgArguments arguments(*function);
    distances_ += function->distances;
    bool named = false;
    for (std::size_t i = 0, positional = 0; !accept(')'); ++i) {
      if (i > 0 && !accept(',')) no_argument(*function);
      if (token().kind == Token::Kind::name && token(1).is('=')) {
        named = true;
        named_argument(*function, arguments);
      } else if (named) {
        no_name(*function);
      } else if (arguments.solids.size() < function->most_solids) {
        arguments.solids.push_back(sum());
      } else if (positional < function->parameters.size()) {
        value(*function, positional, arguments, false);
        ++positional;
      } else {
        too_many(*function);
      }
    }
    check(*function, name, arguments);
    distances_ -= function->distances;
    --depth_;
    return made(name.at, [&] { return function->make(arguments); });
  }

  bool number_next() const {
    return token().kind == Token::Kind::number ||
           ((token().is('-') || token().is('+')) && token(1).kind == Token::Kind::number);
  }

  [[gnu::noinline]] void check(const CsgFunction& f, const Token& name, CsgArguments& arguments) const {
    if (arguments.solids.size() < f.least_solids)
      csg_error(name.at, fmt::format("{} needs {}, as in {}(a, …)", f.name, counted(f.least_solids, "solid"), f.name));
    for (std::size_t i = 0; i < f.parameters.size(); ++i)
      if (f.parameters[i].required && !arguments.values()[i].given)
        csg_error(name.at, fmt::format("{} needs {}=: {}", f.name, f.parameters[i].name, takes(f)));
  }

  static std::string takes(const CsgFunction& f) {
    std::string list = f.least_solids == 0 ? "" : f.most_solids == 1 ? "a solid" : "solids";
    for (const CsgParameter& p : f.parameters) list += (list.empty() ? "" : ", ") + std::string(p.name);
    return "it takes " + list;
  }

  [[gnu::noinline]] void named_argument(const CsgFunction& f, CsgArguments& arguments) {
    const Token& name = token();
    for (std::size_t i = 0; i < f.parameters.size(); ++i) {
      if (name.text != f.parameters[i].name) continue;
      if (arguments.values()[i].given) csg_error(name.at, fmt::format("{}: {} is given twice", f.name, name.text));
      next_ += 2;
      return value(f, i, arguments, true);
    }
    csg_error(name.at, fmt::format("{} has no argument {}: {}", f.name, shown(name), takes(f)));
  }

  /// Without a name, a vector may also be three arguments.
  [[gnu::noinline]] void value(const CsgFunction& f, std::size_t i, CsgArguments& arguments, bool named) {
    const CsgParameter& p = f.parameters[i];
    CsgArgument& a = arguments.values()[i];
    a.given = true;
    switch (p.kind) {
      case Kind::number:
        a.number = number(f, p);
        return;
      case Kind::vector:
        a.vector = vector(f, p, named);
        return;
      case Kind::size:
        if (token().is('(')) {
          a.vector = vector(f, p, named);
        } else {
          const double first = number(f, p);
          a.vector = {first, first, first};
          if (!named && token().is(',') && token(1).kind == Token::Kind::number) {
            ++next_;
            a.vector.y = number(f, p);
            comma(f, p);
            a.vector.z = number(f, p);
          }
        }
        return;
      case Kind::direction:
        a.vector = direction(f, p, named);
        return;
      case Kind::side:
        a.side = side(f);
        return;
    }
  }

  double number(const CsgFunction& f, const CsgParameter& p) {
    double sign = 1;
    const Token& first = token();
    if (accept('-')) {
      sign = -1;
    } else {
      accept('+');
    }
    if (token().kind != Token::Kind::number)
      csg_error(first.at, fmt::format("{}: expected a number for {}, found {}", f.name, p.name, shown(token())));
    return sign * tokens_[next_++].number;
  }

  void comma(const CsgFunction& f, const CsgParameter& p) {
    if (!accept(','))
      csg_error(token().at,
                fmt::format("{}: {} has three numbers: expected ',', found {}", f.name, p.name, shown(token())));
  }

  Vec3 vector(const CsgFunction& f, const CsgParameter& p, bool named) {
    const bool parentheses = token().is('(');
    if (!parentheses && named)
      csg_error(token().at, fmt::format("{}: expected (x, y, z) for {}, found {}", f.name, p.name, shown(token())));
    if (parentheses) ++next_;
    Vec3 v;
    v.x = number(f, p);
    comma(f, p);
    v.y = number(f, p);
    comma(f, p);
    v.z = number(f, p);
    if (parentheses && !accept(')'))
      csg_error(token().at,
                fmt::format("{}: {} has three numbers: expected ')', found {}", f.name, p.name, shown(token())));
    return v;
  }

  Vec3 direction(const CsgFunction& f, const CsgParameter& p, bool named) {
    const std::size_t sign = token().is('-') || token().is('+') ? 1 : 0;
    const Token& word = token(sign);
    if (word.kind == Token::Kind::name && (word.text == "x" || word.text == "y" || word.text == "z")) {
      Vec3 v;
      v[static_cast<std::size_t>(word.text[0] - 'x')] = token().is('-') ? -1 : 1;
      next_ += sign + 1;
      return v;
    }
    if (token().is('(') || (!named && number_next())) return vector(f, p, named);
    csg_error(token().at, fmt::format("{}: {} is x, y, z, -x, … or (x, y, z), not {}", f.name, p.name, shown(token())));
  }

  csg::ShellSide side(const CsgFunction& f) {
    const Token& word = token();
    ++next_;
    if (word.kind == Token::Kind::name && word.text == "both") return csg::ShellSide::both;
    if (word.kind == Token::Kind::name && word.text == "inside") return csg::ShellSide::inside;
    if (word.kind == Token::Kind::name && word.text == "outside") return csg::ShellSide::outside;
    csg_error(word.at, fmt::format("{}: side is both, inside or outside, not {}", f.name, shown(word)));
  }

  /// Adds the position to errors of the solids.
  template <class Make>
  static Solid made(std::size_t at, Make&& make) {
    try {
      return make();
    } catch (const ArgumentError& error) {
      csg_error(at, error.what());
    }
  }

  std::vector<Token> tokens_;
  const SolidLoader &loader_, &distance_loader_;
  std::map<std::string, Solid> loaded_, loaded_distances_;
  std::size_t next_ = 0;
  int depth_ = 0;
  int distances_ = 0;  ///< enclosing calls that need distances
};

}  // namespace

Solid parse_csg(const std::string& text, const SolidLoader& loader, const SolidLoader& distance_loader) {
  // Loading may take long: errors that can be found without it are found first, with a placeholder for each name.
  const SolidLoader stand_in = [](const std::string&) { return csg::sphere({}, 1); };
  Parser(text, stand_in, {}).run();
  return Parser(text, loader, distance_loader).run();
}

}  // namespace sansmesh::inline v1
