// Edit scripts: writing, reading back, and errors that name the cause.
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/function/edit_function.h"
#include "sansmesh/function_edits.h"

namespace sansmesh::inline v1 {
namespace {

TEST(EditScript, EveryFieldThereAndBack) {
  std::vector<Edit> edits;
  const auto add = [&](const decltype(Edit::action)& action) -> EditSelection& {
    edits.push_back({{}, action});
    return edits.back().select;
  };
  add(SetDegree{0}).ball = {{1.5, -2.25, 1e-7}, 0.1};
  add(SetDegree{4}).box = Box3{{-1, -2, -3}, {4, 5, 6e10}};
  add(Refit{}).half_space = {{1, 2, 3}, {0, 0.1, -0.7}};
  add(Refit{3, 9, 0.001, 1.75, true}).coverage_below = 0.4;
  add(Refit{{}, {}, {}, {}, false}).error_above = 0.0123456789012345;
  add(SetConstant{1}).samples_below = 12;
  add(SetConstant{-0.25}).level_from = 3;
  add(RemoveSupports{}).level_to = 7;
  add(RemoveSupports{}).sheet_at = Vec3{431234.5, 5812345.25, 812};
  add(RemoveSupports{}).spurious_sheets = true;
  add(RemoveSupports{}).all_but_largest = true;
  add(Undo{3});
  EditSelection& all = add(SetDegree{2});
  all.ball = {{0, 0, 0}, 1}, all.box = Box3{{0, 0, 0}, {1, 1, 1}}, all.half_space = {{0, 0, 0}, {1, 0, 0}};
  all.coverage_below = 1, all.error_above = 0, all.samples_below = 0, all.level_from = 0, all.level_to = 20;
  all.sheet_at = Vec3{}, all.spurious_sheets = true;
  const std::string script = edit_script(edits);
  const std::vector<Edit> read = parse_edit_script(script);
  ASSERT_EQ(read.size(), edits.size());
  EXPECT_EQ(edit_script(read), script);
  EXPECT_EQ(read[0].select.ball->center, edits[0].select.ball->center);
  EXPECT_EQ(read[1].select.box->upper, edits[1].select.box->upper);
  EXPECT_EQ(read[2].select.half_space->normal, edits[2].select.half_space->normal);
  EXPECT_EQ(read[3].select.coverage_below, 0.4);
  EXPECT_EQ(std::get<Refit>(read[3].action).max_depth, 9);
  EXPECT_EQ(std::get<Refit>(read[3].action).sharp, true);
  EXPECT_EQ(std::get<Refit>(read[2].action).sharp, std::nullopt);
  EXPECT_EQ(read[4].select.error_above, 0.0123456789012345);
  EXPECT_EQ(read[5].select.samples_below, 12);
  EXPECT_EQ(std::get<SetConstant>(read[6].action).value, -0.25);
  EXPECT_EQ(read[6].select.level_from, 3);
  EXPECT_EQ(read[7].select.level_to, 7);
  EXPECT_EQ(read[8].select.sheet_at, edits[8].select.sheet_at);
  EXPECT_TRUE(read[9].select.spurious_sheets && !read[9].select.all_but_largest);
  EXPECT_TRUE(read[10].select.all_but_largest && !read[10].select.spurious_sheets);
  EXPECT_EQ(std::get<Undo>(read[11].action).steps, 3);
  EXPECT_EQ(read[12].select.level_to, 20);
  EXPECT_EQ(read[12].select.samples_below, 0);
  // Selection by coverage.
  edits.resize(0);
  add(SetDegree{kAutomaticDegree}).coverage_fails = kThesisCoverage;
  add(SetConstant{1, true}).coverage_fails = PaperCoverage{0.1, 0.2, 0.3};
  const std::vector<Edit> automatic = parse_edit_script(edit_script(edits));
  ASSERT_EQ(automatic.size(), 2u);
  EXPECT_EQ(std::get<SetDegree>(automatic[0].action).degree, kAutomaticDegree);
  EXPECT_TRUE(std::get<SetConstant>(automatic[1].action).automatic);
  EXPECT_EQ(automatic[1].select.coverage_fails, edits[1].select.coverage_fails);
  const std::vector<Edit> words = parse_edit_script(
      R"({"version":1,"steps":[{"select":{"coverage":"fails"},"degree":"auto"},{"select":{},"constant":"auto"}]})");
  EXPECT_EQ(words[0].select.coverage_fails, kThesisCoverage);
  EXPECT_TRUE(std::get<SetConstant>(words[1].action).automatic);
  edits.resize(1);
  // Spurious sheets are a subset of those that are not the largest.
  edits.resize(1);
  edits[0].select.spurious_sheets = edits[0].select.all_but_largest = true;
  EXPECT_TRUE(parse_edit_script(edit_script(edits))[0].select.spurious_sheets);
}

TEST(EditScript, WordsNotesAndNoSteps) {
  const auto edits = parse_edit_script(R"({"version": 1, "function": "scan.smf", "note": "by hand", "steps": [
    {"select": {}, "constant": "outside", "note": "all of it"}, {"select": {}, "constant": "inside"}, {"undo": 2}]})");
  ASSERT_EQ(edits.size(), 3u);
  EXPECT_EQ(std::get<SetConstant>(edits[0].action).value, 1);
  EXPECT_EQ(std::get<SetConstant>(edits[1].action).value, -1);
  for (const char* value : {"0.001", "-0.001", "1000", "-1e3"})
    EXPECT_NO_THROW(
        parse_edit_script(R"({"version":1,"steps":[{"select":{},"constant":)" + std::string(value) + "}]}"));
  EXPECT_TRUE(parse_edit_script(R"({"version": 1, "steps": []})").empty());
  EXPECT_TRUE(parse_edit_script(edit_script({})).empty());
}

// One table of wrong scripts.
TEST(EditScript, WhatIsWrongIsNamed) {
  struct Case {
    std::string script;
    const char *where, *what;
  };
  const auto step = [](const std::string& text) {
    return R"({"version":1,"steps":[{"select":{},"degree":1},)" + text + "]}";
  };
  const auto select = [&](const std::string& text) { return step(R"({"degree":1,"select":{)" + text + "}}"); };
  const Case cases[] = {
      {"", "not JSON", ""},
      {"{", "not JSON", "line 1"},
      {"version 1", "not JSON", "line 1, column 1"},
      {std::string(1 << 20, '['), "not JSON", "line 1"},
      {std::string(100000, '[') + std::string(100000, ']'), "the script", "object"},
      {"null", "the script", "object"},
      {"[]", "the script", "object"},
      {"{}", "the script", "version"},
      {R"({"version":1})", "the script", "steps"},
      {R"({"version":2,"steps":[]})", "the script", "version 2"},
      {R"({"version":"1","steps":[]})", "the script", "version"},
      {R"({"version":1.5,"steps":[]})", "the script", "version"},
      {R"({"version":99999999999999999999,"steps":[]})", "the script", "version"},
      {R"({"version":1,"steps":{}})", "the script", "steps"},
      {R"({"version":1,"steps":[],"stesp":[]})", "the script", "stesp"},
      {R"({"version":1,"steps":[],"a\nb\u00e4":[]})", "the script", R"(a\x0abä)"},
      {R"({"version":2,"steps":[],"version":1})", "the script", "'version' is given twice"},
      {R"({"steps":[{"undo":1}],"version":1,"steps":[]})", "the script", "'steps' is given twice"},
      {step(R"({"degree":1,"select":{},"degree":2})"), "step 2", "'degree' is given twice"},
      {step(R"({"degree":1,"select":{},"note":{"a":[1,{"b":2,"b":2}]}})"), "step 2.note.a", "'b' is given twice"},
      {step(R"({"degree":1,"select":{},"d\u0065gree":1})"), "step 2", "'degree' is given twice"},
      {step(R"({"degree":1,"select":{},"\u001b[31m":1,"\u001b[31m":1})"), "step 2", R"('\x1b[31m' is given twice)"},
      {select(R"("level_to":3,"level_from":1,"level_to":4)"), "step 2.select", "'level_to' is given twice"},
      {select(R"("ball":{"center":[0,0,0],"radius":1,"radius":2})"), "step 2.select.ball", "'radius' is given twice"},
      {step("1"), "step 2", "object"},
      {step("{}"), "step 2", "needs one of"},
      {step(R"({"select":{}})"), "step 2", "needs one of"},
      {step(R"({"degree":1})"), "step 2", "'select' is missing"},
      {step(R"({"undo":1,"select":{}})"), "step 2", "'undo' takes no 'select'"},
      {step(R"({"degree":1,"remove":true,"select":{}})"), "step 2", "needs one of"},
      {step(R"({"degree":1,"select":{},"colour":3})"), "step 2", "colour"},
      {step(R"({"degree":7,"select":{}})"), "step 2", "'degree'"},
      {step(R"({"degree":1,"select":{"coverage":"low"}})"), "step 2.select", "'coverage'"},
      {step(R"({"degree":1,"select":{"coverage":[1,2]}})"), "step 2.select", "'coverage'"},
      {step(R"({"degree":1,"select":{"coverage":[1,2,3]}})"), "step 2.select", "coverage must lie in 0..2"},
      {step(R"({"degree":-1,"select":{}})"), "step 2", "'degree'"},
      {step(R"({"degree":1.0,"select":{}})"), "step 2", "'degree'"},
      {step(R"({"degree":"1","select":{}})"), "step 2", "'degree'"},
      {step(R"({"degree":NaN,"select":{}})"), "not JSON", "line 1"},
      {step(R"({"degree":1e999,"select":{}})"), "number", "too large"},
      {step(R"({"degree":18446744073709551615,"select":{}})"), "step 2", "'degree'"},
      {step(R"({"undo":0})"), "step 2", "'undo'"},
      {step(R"({"undo":-1})"), "step 2", "'undo'"},
      {step(R"({"undo":true})"), "step 2", "'undo'"},
      {step(R"({"remove":false,"select":{}})"), "step 2", "'remove'"},
      {step(R"({"remove":1,"select":{}})"), "step 2", "'remove'"},
      {step(R"({"constant":"left","select":{}})"), "step 2", "'constant'"},
      {step(R"({"constant":0,"select":{}})"), "step 2", "'constant'"},
      {step(R"({"constant":1e30,"select":{}})"), "step 2", "'constant'"},
      {step(R"({"constant":null,"select":{}})"), "step 2", "'constant'"},
      {step(R"({"refit":true,"select":{}})"), "step 2.refit", "object"},
      {step(R"({"refit":{"depth":3},"select":{}})"), "step 2.refit", "'depth'"},
      {step(R"({"refit":{"max_degree":5},"select":{}})"), "step 2.refit", "max_degree"},
      {step(R"({"refit":{"max_depth":1},"select":{}})"), "step 2.refit", "max_depth"},
      {step(R"({"refit":{"error":0},"select":{}})"), "step 2.refit", "error"},
      {step(R"({"refit":{"support":3},"select":{}})"), "step 2.refit", "support"},
      {step(R"({"refit":{"sharp":1},"select":{}})"), "step 2.refit", "'sharp'"},
      {step(R"({"degree":1,"select":[]})"), "step 2.select", "object"},
      {select(R"("sphere":1)"), "step 2.select", "'sphere'"},
      {select(R"("ball":1)"), "step 2.select.ball", "object"},
      {select(R"("ball":{"center":[0,0,0]})"), "step 2.select.ball", "'radius'"},
      {select(R"("ball":{"radius":1})"), "step 2.select.ball", "'center'"},
      {select(R"("ball":{"center":[0,0],"radius":1})"), "step 2.select.ball", "'center'"},
      {select(R"("ball":{"center":[0,0,"0"],"radius":1})"), "step 2.select.ball", "'center'"},
      {select(R"("ball":{"center":{"x":0},"radius":1})"), "step 2.select.ball", "'center'"},
      {select(R"("ball":{"center":[0,0,0],"radius":0})"), "step 2.select", "ball"},
      {select(R"("ball":{"center":[0,0,0],"radius":-1})"), "step 2.select", "ball"},
      {select(R"("ball":{"center":[0,0,0],"radius":1,"diameter":2})"), "step 2.select.ball", "'diameter'"},
      {select(R"("box":{"lower":[0,0,0]})"), "step 2.select.box", "'upper'"},
      {select(R"("box":{"lower":[0,0,0],"upper":[1,-1,1]})"), "step 2.select", "box"},
      {select(R"("half_space":{"point":[0,0,0]})"), "step 2.select.half_space", "'normal'"},
      {select(R"("half_space":{"point":[0,0,0],"normal":[0,0,0]})"), "step 2.select", "half_space"},
      {select(R"("half_space":{"point":[0,0,0],"normal":[1e300,1e300,0]})"), "step 2.select", "half_space"},
      {select(R"("coverage_below":0)"), "step 2.select", "coverage_below"},
      {select(R"("coverage_below":"0.4")"), "step 2.select", "coverage_below"},
      {select(R"("error_above":-1)"), "step 2.select", "error_above"},
      {select(R"("samples_below":2.5)"), "step 2.select", "samples_below"},
      {select(R"("samples_below":-1)"), "step 2.select", "samples_below"},
      {select(R"("level_from":21)"), "step 2.select", "level_from"},
      {select(R"("level_to":-1)"), "step 2.select", "level_to"},
      {select(R"("level_from":5,"level_to":4)"), "step 2.select", "level_from"},
      {select(R"("sheet_at":[1,2])"), "step 2.select", "'sheet_at'"},
      {select(R"("sheets":"small")"), "step 2.select", "'sheets'"},
      {select(R"("sheets":true)"), "step 2.select", "'sheets'"},
  };
  for (const Case& c : cases) {
    const std::string shown = c.script.substr(0, 120);
    try {
      parse_edit_script(c.script);
      ADD_FAILURE() << shown;
    } catch (const ArgumentError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(c.where), std::string::npos) << shown << ": " << text;
      EXPECT_NE(text.find(c.what), std::string::npos) << shown << ": " << text;
      EXPECT_EQ(text.find('\n'), std::string::npos) << shown;
      EXPECT_LT(text.size(), 300u);
    }
  }
}

TEST(EditScript, DamagedTextEndsInAnErrorOrAScript) {
  const std::string good = R"({"version":1,"steps":[{"select":{"ball":{"center":[0,0,1],"radius":0.2}},"degree":1},)"
                           R"({"select":{"sheets":"spurious","level_to":5},"refit":{"error":0.1}},{"undo":1}]})";
  ASSERT_EQ(parse_edit_script(good).size(), 3u);
  std::mt19937 random(1);
  for (int round = 0; round < 5000; ++round) {
    std::string text = good;
    for (unsigned k = random() % 3 + 1; k-- > 0;) {
      const std::size_t at = random() % text.size();
      if (random() % 2)
        text[at] = static_cast<char>(random());
      else
        text.erase(at, random() % 8);
    }
    try {
      edit_script(parse_edit_script(text));
    } catch (const ArgumentError& e) {
      EXPECT_STRNE(e.what(), "");
    }
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
