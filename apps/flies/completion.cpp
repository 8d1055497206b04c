#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "shared/commands.hpp"
#include "shared/standard_output.hpp"

namespace {

/// The long names of a command's options, with their dashes.
std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// For single quotes: the shell's own closing, escaped and opening again.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c == '\n' ? ' ' : c);
  return result + "'";
}

/// What zsh shows beside a name; a colon in the name would end it.
std::string described(const std::string& name, const std::string& description) {
  return quoted(name + ":" + description);
}

std::string bash_script(const CLI::App& app) {
  std::string cases;
  std::vector<std::string> commands;
  for (const CLI::App* command : app.get_subcommands({})) {
    commands.push_back(command->get_name());
    cases += fmt::format("    {}) words='{}' ;;\n", command->get_name(), fmt::join(option_names(*command), " "));
  }
  return fmt::format(
      "# bash completion for flies; flies completion bash prints it.\n"
      "_flies() {{\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}} words\n"
      "  COMPREPLY=()\n"
      "  if [[ $COMP_CWORD -eq 1 ]]; then\n"
      "    COMPREPLY=($(compgen -W '{} --help --version' -- \"$current\"))\n"
      "    return\n"
      "  fi\n"
      "  if [[ ${{COMP_WORDS[1]}} == completion && $current != -* ]]; then\n"
      "    COMPREPLY=($(compgen -W 'bash zsh' -- \"$current\"))\n"
      "    return\n"
      "  fi\n"
      "  [[ $current == -* ]] || return 0  # files, by -o default\n"
      "  case ${{COMP_WORDS[1]}} in\n{}"
      "  esac\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
      "}}\n"
      "complete -o default -F _flies flies\n",
      fmt::join(commands, " "), cases);
}

std::string zsh_script(const CLI::App& app) {
  std::string commands, cases;
  for (const CLI::App* command : app.get_subcommands({})) {
    commands += "    " + described(command->get_name(), command->get_description()) + "\n";
    cases += fmt::format("    {}) options=(\n", command->get_name());
    for (const CLI::Option* option : command->get_options())
      for (const auto& name : option->get_lnames())
        cases += "      " + described("--" + name, option->get_description()) + "\n";
    cases += "    ) ;;\n";
  }
  return fmt::format(
      "#compdef flies\n"
      "# zsh completion for flies; flies completion zsh prints it.\n"
      "_flies() {{\n"
      "  local -a commands options\n"
      "  commands=(\n{}  )\n"
      "  if (( CURRENT == 2 )); then\n"
      "    _describe command commands\n"
      "    return\n"
      "  fi\n"
      "  case $words[2] in\n{}"
      "  esac\n"
      "  if [[ $words[CURRENT] == -* ]]; then\n"
      "    _describe option options\n"
      "  elif [[ $words[2] == completion ]]; then\n"
      "    compadd bash zsh\n"
      "  else\n"
      "    _files\n"
      "  fi\n"
      "}}\n"
      "# From a folder of fpath this is the body of _flies itself; sourced, it is told to zsh.\n"
      "if [[ $funcstack[1] == _flies ]]; then _flies \"$@\"; else compdef _flies flies; fi\n",
      commands, cases);
}

}  // namespace

void setup_completion(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("completion", "print the script by which a shell completes commands and options");
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "bash or zsh")->required()->check(CLI::IsMember({"bash", "zsh"}));
  command->footer(
      "\nExamples:\n"
      "  source <(flies completion bash)\n"
      "  flies completion zsh > ~/.zfunc/_flies    # where ~/.zfunc is in fpath\n"
      "\nExit status: 0 done, 2 an unknown shell.");
  command->callback([&app, shell] { print(*shell == "bash" ? bash_script(app) : zsh_script(app)); });
}
