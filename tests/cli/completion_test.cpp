// Tests of completion in the real shells, and of manual pages in groff.
#include <cstdlib>

#include "run_tool.h"

namespace sansmesh::test {
namespace {

/// Completion of zsh works only in a terminal: prints the completion of each line.
constexpr const char* kZshTerminal = R"(zmodload zsh/zpty || exit 9
zpty shell zsh -f -i
zpty -w shell "PROMPT= RPROMPT= PS2=; fpath=($PWD/zsh \$fpath); autoload -Uz compinit; compinit -u -D; stty -echo"
zpty -w shell 'show() { print -r -- "<<<$BUFFER>>>"; BUFFER= }; zle -N show; bindkey "^X" show; print REA""DY'
zpty -r -m shell line '*READY*' || exit 8
for typed in "$@"; do
  zpty -w -n shell "$typed"$'\t\x18'
  zpty -r -m shell line '*<<<*>>>*' || exit 7
  print -r -- "${${line##*<<<}%%>>>*}"
done
zpty -d shell
)";

constexpr const char* kBashWords = R"(source sansmesh.bash
while IFS= read -r line; do
  read -ra COMP_WORDS <<<"$line"
  [[ $line == *' ' ]] && COMP_WORDS+=('')
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
  _sansmesh
  echo "${COMPREPLY[*]}"
done
)";

class Completion : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    for (const char* file : {"owl.ply", "owl.smf", "owl.PLY.gz", "owl.txt", "owl.tar"}) write(file, "");
    std::filesystem::create_directory(path("owls"));
  }
  static bool installed(const std::string& program) {
    return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
  }
  /// Lines printed by a shell command in the folder.
  std::vector<std::string> lines_of(const std::string& command, int* status = nullptr) const {
    const std::string out = path("captured-shell");
    const int code = std::system(("cd '" + folder_.string() + "' && (" + command + ") >" + out + " 2>&1").c_str());
    if (status) *status = code;
    if (!status) {
      EXPECT_EQ(code, 0) << command << "\n" << slurp(out);
    }
    std::istringstream text(slurp(out));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    return lines;
  }
  static std::string sorted_words(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    std::sort(words.begin(), words.end());
    std::string sorted;
    for (const std::string& word : words) sorted += (sorted.empty() ? "" : " ") + word;
    return sorted;
  }
};

TEST_F(Completion, OfBash) {
  write("sansmesh.bash", run({"completion", "bash"}).out);
  write("words.bash", kBashWords);
  const std::vector<std::pair<std::string, std::string>> expected{
      {"sansmesh recon", "reconstruct"},
      {"sansmesh volume pr", "probe"},
      {"sansmesh --threads 2 volume r", "render resample"},
      {"sansmesh reconstruct --fa", "--faces"},
      {"sansmesh reconstruct --faces ", "auto ignore sample vertices"},
      {"sansmesh reconstruct --faces = s", "sample"},
      {"sansmesh reconstruct owl.ply --surface a", "adamson alexa amls apss"},
      {"sansmesh reconstruct owl.p", "owl.ply"},
      {"sansmesh reconstruct ow", "owl.PLY.gz owl.ply owl.smf owl.txt owls"},
      {"sansmesh mesh ow", "owl.smf owls"},
      {"sansmesh mesh owl.smf -o ow", "owl.PLY.gz owl.ply owls"},
      {"sansmesh mesh owl.smf --output = owl.t", "owl.tar owl.txt"},
      {"sansmesh mesh owl.smf --block-depth ", ""},
      {"sansmesh completion ", "bash fish zsh"},
      {"sansmesh info --js", "--json"}};
  std::string typed;
  for (const auto& [line, words] : expected) typed += line + "\n";
  write("typed.txt", typed);
  const auto lines = lines_of("bash words.bash <typed.txt");
  ASSERT_EQ(lines.size(), expected.size());
  for (std::size_t i = 0; i < lines.size(); ++i)
    EXPECT_EQ(sorted_words(lines[i]), expected[i].second) << expected[i].first;
}

// bash, help and the manual page list the same options.
TEST_F(Completion, OffersWhatHelpLists) {
  write("sansmesh.bash", run({"completion", "bash"}).out);
  write("words.bash", kBashWords);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"reconstruct"}, {"volume", "render"}, {"simulate"}, {"flow", "lines"}}) {
    std::vector<std::string> asked{"help"}, paged{"manual"};
    asked.insert(asked.end(), command.begin(), command.end());
    paged.insert(paged.end(), command.begin(), command.end());
    asked.emplace_back("--all");
    std::istringstream help(run(asked).out);
    const std::string page = run(paged).out;
    std::string flags, typed = "sansmesh";
    for (std::string line; std::getline(help, line);) {
      if (!line.starts_with("  -")) continue;
      std::istringstream words(line);
      for (std::string word; words >> word && word[0] == '-';) {
        const bool more = word.back() == ',';
        if (more) word.pop_back();
        flags += word + " ";
        std::string dashed;
        for (const char c : word) dashed += c == '-' ? std::string("\\-") : std::string(1, c);
        EXPECT_NE(page.find("\\fB" + dashed + "\\fR"), std::string::npos) << command.back() << " " << word;
        if (!more) break;
      }
    }
    for (const std::string& word : command) typed += " " + word;
    write("typed.txt", typed + " -\n");
    EXPECT_EQ(sorted_words(lines_of("bash words.bash <typed.txt").at(0)), sorted_words(flags));
  }
}

TEST_F(Completion, OfZsh) {
  if (!installed("zsh"))
    GTEST_SKIP() << "zsh is not installed (scripts/install-deps test): its completion is not tested";
  std::filesystem::create_directory(path("zsh"));
  write("zsh/_sansmesh", run({"completion", "zsh"}).out);
  write("terminal.zsh", kZshTerminal);
  const std::vector<std::pair<std::string, std::string>> expected{
      {"sansmesh recon", "sansmesh reconstruct "},
      {"sansmesh volume pr", "sansmesh volume probe "},
      {"sansmesh --threads 2 volume render --ver", "sansmesh --threads 2 volume render --verbose "},
      {"sansmesh reconstruct --fac", "sansmesh reconstruct --faces="},
      {"sansmesh reconstruct --faces ign", "sansmesh reconstruct --faces ignore "},
      {"sansmesh mesh owl.", "sansmesh mesh owl.smf "},
      {"sansmesh completion z", "sansmesh completion zsh "}};
  std::string typed;
  for (const auto& [line, completed] : expected) typed += " '" + line + "'";
  const auto lines = lines_of("TERM=dumb timeout 60 zsh -f terminal.zsh" + typed);
  ASSERT_EQ(lines.size(), expected.size());
  for (std::size_t i = 0; i < lines.size(); ++i) EXPECT_EQ(lines[i], expected[i].second);
}

TEST_F(Completion, OfFish) {
  if (!installed("fish"))
    GTEST_SKIP() << "fish is not installed (scripts/install-deps test): its completion is not tested";
  write("sansmesh.fish", run({"completion", "fish"}).out);
  const std::vector<std::pair<std::string, std::string>> expected{
      {"sansmesh recon", "reconstruct"},
      {"sansmesh volume pr", "probe"},
      {"sansmesh --threads 2 volume render --ver", "--verbose"},
      {"sansmesh reconstruct --fac", "--faces"},
      {"sansmesh reconstruct --faces ign", "ignore"},
      {"sansmesh mesh owl", "owl.smf owls/"},
      {"sansmesh completion z", "zsh"}};
  std::string script = "source sansmesh.fish\n";
  for (const auto& [line, words] : expected)
    script += "echo (complete -C '" + line + "' | string replace -r '\\t.*' '')\n";
  write("words.fish", script);
  const auto lines = lines_of("HOME=$PWD XDG_CONFIG_HOME=$PWD XDG_DATA_HOME=$PWD fish --no-config words.fish");
  ASSERT_EQ(lines.size(), expected.size());
  for (std::size_t i = 0; i < lines.size(); ++i)
    EXPECT_EQ(sorted_words(lines[i]), expected[i].second) << expected[i].first;
}

TEST_F(Completion, ManualPagesAreSetWithoutWarnings) {
  EXPECT_EQ(run({"manual", "--folder", "."}).code, 0);
  std::size_t pages = 0;
  for (const std::string& name : listing()) pages += name.ends_with(".1") ? 1 : 0;
  EXPECT_GT(pages, 25u);
  EXPECT_NE(slurp(path("sansmesh.1")).find("\\fBreconstruct\\fR"), std::string::npos);
  const std::string page = slurp(path("sansmesh-volume-probe.1"));
  for (const char* part :
       {".TH SANSMESH\\-VOLUME\\-PROBE 1", ".SH SYNOPSIS", "\\fB\\-\\-at\\fR \\fIPOINT\\fR", ".SH EXAMPLES"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_TRUE(std::all_of(page.begin(), page.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; }));
  if (!installed("groff")) GTEST_SKIP() << "groff is not installed (scripts/install-deps test): pages are not set";
  for (const std::string& line : lines_of("for page in *.1; do groff -man -Tutf8 -ww -z $page; done"))
    ADD_FAILURE() << line;
  EXPECT_NE(lines_of("groff -man -Tutf8 -P-cbou sansmesh-volume-probe.1 | head -n 4").at(0).find("User Commands"),
            std::string::npos);
}

}  // namespace
}  // namespace sansmesh::test
