#include "sansmesh/meshing/component_words.h"

#include <charconv>

#include "sansmesh/core/error.h"

namespace sansmesh {

std::string text_of_option(const ComponentChoice& choice) {
  switch (choice.kind) {
    case ComponentChoice::Kind::automatic:
      return "auto";
    case ComponentChoice::Kind::all:
      return "all";
    case ComponentChoice::Kind::count:
      break;
  }
  return choice.count == 1 ? "largest" : std::to_string(choice.count);
}

void option_of_text(std::string_view word, ComponentChoice& choice) {
  using Kind = ComponentChoice::Kind;
  choice = {};
  if (word == "auto") return;
  choice.kind = word == "all" ? Kind::all : Kind::count;
  if (word == "all" || word == "largest") return;
  const std::string text(word);
  const char* const end = text.data() + text.size();
  const auto [read, error] = std::from_chars(text.data(), end, choice.count);
  if (error != std::errc() || read != end || choice.count < 1)
    throw ArgumentError(ArgumentFault{.field = {},
                                      .value = "'" + printable(word, 60) + "'",
                                      .allowed = "auto, all, largest or a number of at least 1",
                                      .remedy = {}});
}

}  // namespace sansmesh
