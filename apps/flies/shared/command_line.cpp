#include "shared/command_line.hpp"

#include <memory>
#include <string>

#include "flies/core/error.hpp"

namespace {

class WrappingFormatter : public CLI::Formatter {
 public:
  std::string make_option_desc(const CLI::Option* option) const override {
    constexpr std::size_t kLine = 100;
    std::string text = option->get_description();
    for (std::size_t start = 0; text.size() - start > kLine - column_width_;) {
      std::size_t space = text.rfind(' ', start + kLine - column_width_);
      if (space == std::string::npos || space <= start) break;
      text[space] = '\n';  // the formatter indents what follows
      start = space + 1;
    }
    return text;
  }

  /// One to two of a thing as "THING [THING]".
  std::string make_option_usage(const CLI::Option* option) const override {
    const int most = option->get_expected_max();
    if (most <= 1 || most >= CLI::detail::expected_max_vector_size) return Formatter::make_option_usage(option);
    const std::string name = make_option_name(option, true);
    std::string usage = name;
    for (int i = 1; i < most; ++i) usage += i < option->get_expected_min() ? " " + name : " [" + name + "]";
    return option->get_required() ? usage : "[" + usage + "]";
  }
};

/// What an option takes, for errors.
std::string expectation(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (type.find("MODEL") != std::string::npos) return "the name of a model or of its file";
  for (const char* file : {"FILE", "PNG"})
    if (type.find(file) != std::string::npos) return "the name of a file";
  return type == "DIR" ? "the name of a folder" : "a value";
}

void check_values_of(CLI::App& command) {
  for (CLI::Option* option : command.get_options()) {
    if (option->get_items_expected_max() == 0) continue;
    const bool may_be_empty = option->get_items_expected_min() == 0;
    // A transformation comes before all checks, whose complaints of an empty value say less.
    option->transform(CLI::Validator(
        [&command, option, may_be_empty](const std::string& value) {
          if (value.empty()) return may_be_empty ? std::string() : "is empty, expected " + expectation(*option);
          const auto* other = value.starts_with("--") ? command.get_option_no_throw(value) : nullptr;
          return other == nullptr ? std::string() : "expects a value, found the option " + value;
        },
        ""));
  }
}

}  // namespace

void wrap_help(CLI::App& app) {
  const auto formatter = std::make_shared<WrappingFormatter>();
  app.formatter(formatter);
  for (CLI::App* command : app.get_subcommands({})) command->formatter(formatter);
}

void check_values(CLI::App& app) {
  check_values_of(app);
  for (CLI::App* command : app.get_subcommands({})) check_values_of(*command);
}

int times_given(const CLI::Option& option, int argc, const char* const* argv) {
  int times = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    for (const auto& name : option.get_lnames()) times += word == "--" + name || word.starts_with("--" + name + "=");
    for (const auto& name : option.get_snames()) times += word.starts_with("-" + name);
  }
  return times;
}

void refuse_empty_assignments(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.starts_with("--") && word.find('=') == word.size() - 1)
      throw flies::InputError("command line", word.substr(0, word.size() - 1), "is empty, expected a value");
  }
}
