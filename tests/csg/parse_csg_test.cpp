#include "sansmesh/csg/parse_csg.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "csg/catalogue.h"
#include "sansmesh/error.h"
#include "sansmesh/field/piece_expression.h"
#include "support/clean_text.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;
using namespace csg;

const Solid kA = sphere({0.3, 0, 0}, 1), kB = box({-0.5, -0.6, -0.7}, {0.8, 0.9, 1}), kC = torus({}, {0, 0, 1}, 1, 0.3);

Solid load(const std::string& name) {
  if (name == "a" || name == "a.smf" || name == "scans/a_1.smf" || name == "my-scan.smf" || name == "my scan.smf" ||
      name == "größe.smf" || name == "2.smf" || name == "x")
    return kA;
  if (name == "b" || name == "b.smf" || name == "../b.smf") return kB;
  if (name == "c") return kC;
  throw FileError(name, "no such file");
}

// One table of texts and the solids that they mean.
TEST(ParseCsg, MeansWhatTheFunctionsDo) {
  struct Case {
    const char* text;
    Solid solid;
  };
  const std::vector<Case> cases = {
      {"a", kA},
      {" a.smf\n", kA},
      {"scans/a_1.smf", kA},
      {"größe.smf", kA},
      {"'my-scan.smf'", kA},
      {"\"my scan.smf\"", kA},
      {"2.smf", kA},
      {"x", kA},
      {"a | b", unite(kA, kB)},
      {"a+b", unite(kA, kB)},
      {"a & b", intersect(kA, kB)},
      {"a - b", subtract(kA, kB)},
      {"a -b", subtract(kA, kB)},
      {"a.smf - ../b.smf", subtract(kA, kB)},
      {"'a.smf'-'b.smf'", subtract(kA, kB)},
      {"a-(b)", subtract(kA, kB)},
      {"(a)-b", subtract(kA, kB)},
      {"~a", complement(kA)},
      {"~~a", kA},
      {"~~~a", complement(kA)},
      {"~a & b", intersect(complement(kA), kB)},
      {"~(a & b)", complement(intersect(kA, kB))},
      // & binds stronger than | + -, which associate to the left
      {"a | b & c", unite(kA, intersect(kB, kC))},
      {"a & b | c", unite(intersect(kA, kB), kC)},
      {"a - b & c", subtract(kA, intersect(kB, kC))},
      {"a - b - c", subtract(subtract(kA, kB), kC)},
      {"a - b | c", unite(subtract(kA, kB), kC)},
      {"a | b - c", subtract(unite(kA, kB), kC)},
      {"a - (b | c)", subtract(kA, unite(kB, kC))},
      {"a - (b - c)", subtract(kA, subtract(kB, kC))},
      {"a + b | c - a + b", unite(subtract(unite(unite(kA, kB), kC), kA), kB)},
      {"sphere(1)", sphere({}, 1)},
      {"sphere(r=0.5, center=(1, -2, 3e-1))", sphere({1, -2, 0.3}, 0.5)},
      {"sphere(.5, 1, -2, 3)", sphere({1, -2, 3}, 0.5)},
      {"box(size=(1,2,3), center=(0.1,0.2,0.3), r=0.1)", box({-0.4, -0.8, -1.2}, {0.6, 1.2, 1.8}, 0.1)},
      {"box(1)", box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5})},
      {"box(1, 2, 3)", box({-0.5, -1, -1.5}, {0.5, 1, 1.5})},
      {"box(size=2, r=0.2)", box({-1, -1, -1}, {1, 1, 1}, 0.2)},
      {"box(from=(0,0,0), to=(1,2,1))", box({0, 0, 0}, {1, 2, 1})},
      {"cylinder(axis=z, r=0.1)", cylinder({}, {0, 0, 1}, 0.1)},
      {"cylinder(r=0.5, h=2, axis=(1,1,0), center=(0,0,1))", cylinder({0, 0, 1}, {1, 1, 0}, 0.5, 2)},
      {"cylinder(0.5, 2, y)", cylinder({}, {0, 1, 0}, 0.5, 2)},
      {"cone(r=1, h=2)", cone({}, {0, 0, 1}, 1, 0, 2)},
      {"cone(r=1, h=2, top=0.5, axis=-x)", cone({}, {-1, 0, 0}, 1, 0.5, 2)},
      {"torus(R=1, r=0.3)", kC},
      {"torus(1, 0.3, axis=y)", torus({}, {0, 1, 0}, 1, 0.3)},
      {"capsule(r=0.2, from=(0,0,0), to=(1,0,0))", capsule({0, 0, 0}, {1, 0, 0}, 0.2)},
      {"plane(normal=-x, offset=0.5)", half_space({-1, 0, 0}, 0.5)},
      {"plane(z)", half_space({0, 0, 1}, 0)},
      {"plane((0,3,4), through=(0,1,1))", half_space({0, 0.6, 0.8}, 1.4)},
      {"union(a, b, c)", unite(unite(kA, kB), kC)},
      {"union(a, b, r=0.2)", unite(kA, kB, 0.2)},
      {"union(a, b, c, r=0.2)", unite(unite(kA, kB, 0.2), kC, 0.2)},
      {"intersection(a, b, r=0.1)", intersect(kA, kB, 0.1)},
      {"difference(a, b, c)", subtract(kA, unite(kB, kC))},
      {"difference(a, b, r=0.1)", subtract(kA, kB, 0.1)},
      {"complement(a)", complement(kA)},
      {"offset(a, 0.1)", offset(kA, 0.1)},
      {"offset(a - b, d=-0.1)", offset(subtract(kA, kB), -0.1)},
      {"shell(a, 0.1)", shell(kA, 0.1)},
      {"shell(b, t=0.1, side=inside)", shell(kB, 0.1, ShellSide::inside)},
      {"shell(b, 0.1, outside)", shell(kB, 0.1, ShellSide::outside)},
      {"translate(a, 1, 2, -0.3)", translate(kA, {1, 2, -0.3})},
      {"translate(a, (1, 2, -0.3))", translate(kA, {1, 2, -0.3})},
      {"translate(a, by=(1, 2, +3))", translate(kA, {1, 2, 3})},
      {"rotate(b, axis=z, angle=30)", rotate(kB, {0, 0, 1}, 30)},
      {"rotate(b, -30, (1,1,0), center=(1,0,0))", rotate(kB, {1, 1, 0}, -30, {1, 0, 0})},
      {"scale(b, 2)", scale(kB, 2)},
      {"scale(b, 0.5, center=(1,1,1))", scale(kB, 0.5, {1, 1, 1})},
      {"mirror(b, x)", mirror(kB, {1, 0, 0})},
      {"mirror(b, normal=(1,1,0), offset=0.2)", mirror(kB, {1, 1, 0}, 0.2)},
      {"offset(union(a - b, ~(c), r=0.1), 0.05) & box(2)",
       intersect(offset(unite(subtract(kA, kB), complement(kC), 0.1), 0.05), box({-1, -1, -1}, {1, 1, 1}))},
  };
  const std::vector<Vec3> x = random_points(500);
  for (const Case& c : cases) {
    std::vector<double> expected = values_of(c.solid, x), found;
    ASSERT_NO_THROW(found = values_of(parse_csg(c.text, load), x)) << c.text;
    for (std::size_t i = 0; i < x.size(); ++i) ASSERT_NEAR(found[i], expected[i], 1e-12) << c.text;
  }
}

TEST(ParseCsg, BlanksDoNotMatter) {
  const std::vector<Vec3> x = random_points(100);
  EXPECT_EQ(
      values_of(parse_csg("difference(a,rotate(b,30,axis=-x),r=.1)|sphere(r=1e-1)", load), x),
      values_of(parse_csg("  difference ( a , rotate(b ,30 , axis = - x ) ,\tr = .1 )\n| sphere ( r = 1e-1 ) ", load),
                x));
}

TEST(ParseCsg, ErrorsNamePlaceAndRemedy) {
  struct Case {
    const char* text;
    const char* error;  ///< beginning of the message
  };
  const Case cases[] = {
      {"", "expression: empty"},
      {"  ", "expression: empty"},
      {"a -", "expression at 4: expected a solid, found the end"},
      {"a b", "expression at 3: expected an operator (| + & -) or the end, found 'b'"},
      {"a | | b", "expression at 5: expected a solid, found '|'"},
      {"(a | b", "expression at 7: expected an operator (| + & -) or ')' for the '(' at 1, found the end"},
      {"a)", "expression at 2: ')' without a '(' before it"},
      {"()", "expression at 2: expected a solid, found ')'"},
      {"-a", "expression at 1: expected a solid, found '-'; ~ is the complement"},
      {"a * b", "expression at 3: '*' has no meaning: & is the intersection"},
      {"a.smf-b.smf", "expression at 1: is 'a.smf-b.smf' one name or a difference? Put quotes around"},
      {"c | my-long-scan.smf", "expression at 5: is 'my-long-scan.smf' one name or a difference?"},
      {"~/scan.smf", "expression at 1: ~/ is not the home folder here but a complement"},
      {"'a.smf", "expression at 1: the quote that opens here is not closed"},
      {"''", "expression at 1: there is no name between the quotes"},
      {"a ^ b", "expression at 3: unexpected '^'; file names with it need quotes"},
      {"a \x01", "expression at 3: unexpected control character"},
      {"ä | ü ^", "expression at 7: unexpected '^'"},
      {"sphere", "expression at 1: expected '(' after sphere"},
      {"spere(1)", "expression at 1: there is no function 'spere'; known are sphere, box, cylinder"},
      {"sphere()", "expression at 1: sphere needs r=: it takes r, center"},
      {"sphere(r=0)", "expression at 1: sphere: r must be positive, not 0"},
      {"a | sphere(r=-2)", "expression at 5: sphere: r must be positive, not -2"},
      {"sphere(r=nan)", "expression at 10: sphere: expected a number for r, found 'nan'"},
      {"sphere(r=inf)", "expression at 10: sphere: expected a number for r, found 'inf'"},
      {"sphere(r=1e999)", "expression at 10: the number 1e999 is too large or small"},
      {"sphere(r=)", "expression at 10: sphere: expected a number for r, found ')'"},
      {"sphere(r=1, r=2)", "expression at 13: sphere: r is given twice"},
      {"sphere(1, r=2)", "expression at 11: sphere: r is given twice"},
      {"sphere(r=1, q=2)", "expression at 13: sphere has no argument 'q': it takes r, center"},
      {"sphere(r=1", "expression at 11: expected ',' or ')' in sphere(…), found the end"},
      {"sphere(r=1 center=(0,0,0))", "expression at 12: expected ',' or ')' in sphere(…), found 'center'"},
      {"sphere(1, (0,0))", "expression at 15: sphere: center has three numbers: expected ',', found ')'"},
      {"sphere(1, center=2)", "expression at 18: sphere: expected (x, y, z) for center, found the number 2"},
      {"sphere(1, 0, 0)", "expression at 15: sphere: center has three numbers: expected ',', found ')'"},
      {"sphere(1, (0,0,0), 4)", "expression at 20: sphere: too many arguments: it takes r, center"},
      {"sphere(r=1, (0,0,0))", "expression at 13: sphere: arguments without a name come before those with one"},
      {"box()", "expression at 1: box: needs size= and optionally center=, or both from= and to="},
      {"box(1, from=(0,0,0))", "expression at 1: box: needs size= and optionally center=, or both from= and to="},
      {"box(1, r=0.6)", "expression at 1: box: r must lie between 0 and half the shortest edge"},
      {"torus(R=1, r=2)", "expression at 1: torus: r must be less than R"},
      {"cylinder(1, axis=w)", "expression at 18: cylinder: axis is x, y, z, -x, … or (x, y, z), not 'w'"},
      {"cylinder(1, axis=(0,0,0))", "expression at 1: cylinder: axis must have a direction"},
      {"union()", "expression at 1: union needs 1 solid, as in union(a, …)"},
      {"difference(a)", "expression at 1: difference needs 2 solids"},
      {"union(a, b, 0.1)", "expression at 13: expected a solid, found the number 0.1; numbers may need a name (r=0.1)"},
      {"union(a, b, r=-1)", "expression at 1: union: r must be positive, not -1"},
      {"offset(a)", "expression at 1: offset needs d=: it takes a solid, d"},
      {"offset(a, b)", "expression at 11: offset: expected a number for d, found 'b'"},
      {"shell(a, 0)", "expression at 1: shell: t must be positive, not 0"},
      {"shell(a, 1, side=left)", "expression at 18: shell: side is both, inside or outside, not 'left'"},
      {"scale(a, 0)", "expression at 1: scale: factor must be positive, not 0"},
      {"rotate(a)", "expression at 1: rotate needs angle=: it takes a solid, angle, axis, center"},
  };
  for (const Case& c : cases) {
    try {
      parse_csg(c.text, load);
      ADD_FAILURE() << c.text << " was accepted";
    } catch (const ArgumentError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.substr(0, std::string(c.error).size()), c.error) << c.text;
      EXPECT_EQ(message.find('\n'), std::string::npos);
    }
  }
}

TEST(ParseCsg, ErrorsOfTheLoaderPass) { EXPECT_THROW(parse_csg("a | missing.smf", load), FileError); }

TEST(ParseCsg, NothingIsLoadedForAnExpressionThatIsWrong) {
  int loads = 0;
  const SolidLoader counting = [&](const std::string& name) {
    ++loads;
    return load(name);
  };
  for (const char* text : {"a - (b", "a - cylinder(r=-1)", "shell(a, 0.1) - cylinder", "a.smf | sphere(1) b", "a & ~"})
    EXPECT_THROW(parse_csg(text, counting, counting), ArgumentError) << text;
  EXPECT_EQ(loads, 0);
}

TEST(ParseCsg, LoadsEachNameOnce) {
  int loads = 0;
  const Solid s = parse_csg("a - 'a' | offset(a, 0.1) & a", [&](const std::string& name) {
    ++loads;
    return load(name);
  });
  EXPECT_EQ(loads, 1);
}

TEST(ParseCsg, HugeAndDeepInputsEndWell) {
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += '(';
  EXPECT_THROW(parse_csg(deep, load), ArgumentError);
  deep.clear();
  for (int i = 0; i < 100000; ++i) deep += "offset(";
  EXPECT_THROW(parse_csg(deep, load), ArgumentError);
  EXPECT_NO_THROW(parse_csg(std::string(100000, '~') + "a", load));
  EXPECT_THROW(parse_csg(std::string(2000000, 'a'), load), ArgumentError);

  // Long sums are not deep trees; alternating ones are, and are rejected.
  std::string sum = "sphere(1)", mixed = "a";
  for (int i = 0; i < 20000; ++i) sum += " | sphere(1, center=(" + std::to_string(i) + ", 0, 0))";
  const Solid many = parse_csg(sum, load);
  EXPECT_NEAR(value_at(many, {10000.5, 0, 0}), -0.5, 1e-9);
  for (int i = 0; i < 5000; ++i) mixed += " | sphere(1) - box(1)";
  EXPECT_THROW(parse_csg(mixed, load), ArgumentError);

  // Every part of a valid expression is either valid or an error.
  const std::string text =
      "difference(a.smf, rotate(box(size=(1,2,3), r=.1), angle=-3e1, axis=(1,1,0)), r=0.2) | ~'my-scan.smf' & "
      "plane(-x)";
  int solids = 0, errors = 0;
  for (std::size_t first = 0; first < text.size(); ++first)
    for (std::size_t last = first; last <= text.size(); ++last) {
      try {
        parse_csg(text.substr(first, last - first), load);
        ++solids;
      } catch (const Error&) {
        ++errors;
      }
    }
  EXPECT_GT(solids, 10);
  EXPECT_GT(errors, 1000);
}

/// Each change of the operator, and each parenthesis, is one more level of the tree.
TEST(ParseCsg, DeepExpressionsTakeNoLongerThanTheirParts) {
  std::string turns = "box(1)", nested(900, '(');
  for (int i = 0; i < 480; ++i) turns += " - box(2) | box(3)";
  nested += "sphere(1)";
  for (int i = 0; i < 900; ++i) nested += i % 2 ? " | box(0.5))" : " - sphere(0.9))";
  const std::vector<Vec3> x = random_points(500);
  EXPECT_EQ(values_of(parse_csg(turns, load), x), values_of(parse_csg("box(3)", load), x));
  EXPECT_EQ(values_of(parse_csg(nested, load), x),
            values_of(parse_csg("(sphere(1) - sphere(0.9)) | box(0.5)", load), x));
  // Each nesting of shells doubles the number of surfaces.
  std::string shells = "sphere(1)";
  for (int i = 0; i < 24; ++i) shells = "shell(" + shells + ", 0.01)";
  EXPECT_EQ(parse_csg(shells, load).expression(1e-9), nullptr);
}

TEST(ParseCsg, MessagesQuoteAnythingInOnePrintableLine) {
  for (const std::string& text :
       {std::string("sphere(1) 'a\x05\n\xff'"), "sphere(1e9" + std::string(10000, '9') + ")"}) {
    try {
      parse_csg(text, load);
      FAIL();
    } catch (const ArgumentError& error) {
      EXPECT_TRUE(test::is_clean(error.what()));
      EXPECT_LT(std::string(error.what()).size(), 1000u);
    }
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
