#include "command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>

namespace sansmesh::cli {
namespace {

/// "--output" of "-o,--output".
std::string long_name(const std::string& names) {
  const std::size_t at = names.find("--");
  return at == std::string::npos ? names : names.substr(at);
}

template <class T>
Option with_function(CLI::App& app, const std::string& names, std::function<void(const T&)> use,
                     const std::string& what) {
  return Option(*app.add_option_function<T>(
      names,
      [use = std::move(use), name = long_name(names)](const T& value) {
        try {
          use(value);
        } catch (const ValueError& error) {
          throw CLI::ValidationError(name, error.what());
        }
      },
      what));
}

}  // namespace

Option Option::type_name(const std::string& name) const { return Option(*option_->type_name(name)); }
Option Option::group(const std::string& name) const { return Option(*option_->group(name)); }
Option Option::required() const { return Option(*option_->required()); }
Option Option::one_of(const std::vector<std::string>& words) const {
  return Option(*option_->check(CLI::IsMember(words).description("")));
}
Option Option::within(int least, int most) const {
  return Option(*option_->check(CLI::Range(least, most).description("")));
}
Option Option::positive() const { return Option(*option_->check(CLI::PositiveNumber.description(""))); }
Option Option::numbers(int count) const { return Option(*option_->delimiter(',')->expected(count)); }
Option Option::without_value(const std::string& value) const {
  return Option(*option_->expected(0, 1)->default_str(value));
}
Option Option::repeated() const {
  return Option(*option_->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll));
}

CommandLine::CommandLine(const std::string& what, const std::string& name)
    : own_(std::make_unique<CLI::App>(what, name)), app_(own_.get()) {}
CommandLine::CommandLine(CLI::App& app) : app_(&app) {}
CommandLine::~CommandLine() = default;

template <class T>
Option CommandLine::add_option(const std::string& names, T& variable, const std::string& what) {
  return Option(*app_->add_option(names, variable, what));
}
template Option CommandLine::add_option(const std::string&, int&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::size_t&, const std::string&);
template Option CommandLine::add_option(const std::string&, float&, const std::string&);
template Option CommandLine::add_option(const std::string&, double&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::string&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::vector<double>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::optional<int>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::optional<std::size_t>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::optional<double>&, const std::string&);

Option CommandLine::add_option_function(const std::string& names, std::function<void(const std::string&)> use,
                                        const std::string& what) {
  return with_function<std::string>(*app_, names, std::move(use), what);
}
Option CommandLine::add_option_function(const std::string& names, std::function<void(const std::vector<double>&)> use,
                                        const std::string& what) {
  return with_function<std::vector<double>>(*app_, names, std::move(use), what);
}
Option CommandLine::add_flag(const std::string& names, bool& variable, const std::string& what) {
  return Option(*app_->add_flag(names, variable, what));
}
Option CommandLine::add_flag_callback(const std::string& names, std::function<void()> use, const std::string& what) {
  return Option(*app_->add_flag_callback(names, std::move(use), what));
}

Option CommandLine::add_words(const std::string& names, std::vector<std::string> words,
                              const std::function<void(std::size_t)>& use, const std::string& what) {
  const auto find = [words](const std::string& text) {
    return static_cast<std::size_t>(std::find(words.begin(), words.end(), text) - words.begin());
  };
  CLI::Option* const option = app_->add_option_function<std::string>(
      names, [find, use](const std::string& text) { use(find(text)); }, what);
  return Option(*option->check(CLI::Validator(
      [find, words = std::move(words)](const std::string& text) {
        if (find(text) < words.size()) return std::string();
        std::string known;
        for (const std::string& word : words) known += (known.empty() ? "" : ", ") + word;
        return "must be one of " + known + ", not " + text;
      },
      "")));
}

void CommandLine::footer(const std::string& text) { app_->footer(text); }

CommandLine& CommandLine::add_subcommand(const std::string& name, const std::string& what) {
  commands_.push_back(std::unique_ptr<CommandLine>(new CommandLine(*app_->add_subcommand(name, what))));
  return *commands_.back();
}

const CommandLine& CommandLine::subcommand(const std::string& name) const {
  const CLI::App* const wanted = app_->get_subcommand(name);
  return **std::find_if(commands_.begin(), commands_.end(), [&](const auto& c) { return c->app_ == wanted; });
}

void CommandLine::require_subcommand() { app_->require_subcommand(1); }

bool CommandLine::chosen() const { return app_->parsed(); }

bool CommandLine::has(const std::string& flag) const { return app_->get_option_no_throw(flag) != nullptr; }

}  // namespace sansmesh::cli
