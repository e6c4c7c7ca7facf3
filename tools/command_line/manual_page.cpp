#include "tools/command_line/manual_page.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "tools/command_line/option_value.h"
#include "tools/command_line/other_programs.h"

namespace flexarm {
namespace {

// Text as roff prints it: a hyphen that can be copied, no request at the start of a line.
std::string Roff(const std::string& text) {
  std::string out;
  bool at_start = true;
  for (const char c : text) {
    if (at_start && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
    at_start = c == '\n';
  }
  return out;
}

std::string Bold(const std::string& text) { return "\\fB" + Roff(text) + "\\fR"; }
std::string Italic(const std::string& text) { return "\\fI" + Roff(text) + "\\fR"; }

// Lines as they are: a text with line ends of its own.
std::string Verbatim(const std::string& text) { return ".nf\n" + Roff(text) + "\n.fi\n"; }

std::string Paragraph(const std::string& text) {
  return text.find('\n') == std::string::npos ? Roff(text) + "\n" : Verbatim(text);
}

std::vector<const CLI::App*> VerbsOf(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<const CLI::Option*> OptionsOf(const CLI::App& app, bool positional) {
  return app.get_options(
      [positional](const CLI::Option* o) { return o->nonpositional() != positional; });
}

std::string Upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) {
    return c == ' ' ? '-' : static_cast<char>(std::toupper(c));
  });
  return text;
}

std::string Dashed(std::string command) {
  std::replace(command.begin(), command.end(), ' ', '-');
  return command;
}

std::string Synopsis(const CLI::App& app, const std::string& command) {
  std::string line = Bold(command);
  if (!OptionsOf(app, false).empty()) line += " [" + Italic("OPTIONS") + "]";
  for (const CLI::Option* argument : OptionsOf(app, true)) {
    const std::string name = Italic(argument->get_name(true));
    line += argument->get_required() ? " " + name : " [" + name + "]";
  }
  if (!VerbsOf(app).empty()) line += " " + Italic("VERB") + " ...";
  return line + "\n";
}

std::string OptionText(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option.get_snames()) {
    names += (names.empty() ? "" : ", ") + Bold("-" + name);
  }
  for (const std::string& name : option.get_lnames()) {
    names += (names.empty() ? "" : ", ") + Bold("--" + name);
  }
  if (names.empty()) {
    names = Italic(option.get_name(true)) + " " + Roff(option.get_type_name());
  } else if (TakesValue(option)) {
    names += " " + Italic(option.get_type_name());
  }
  std::string text = option.get_description();
  if (!option.get_default_str().empty()) text += "; default: " + option.get_default_str();
  if (option.get_required()) text += "; required";
  return ".TP\n" + names + "\n" + Paragraph(text);
}

std::string OptionsText(const CLI::App& app) {
  std::string text;
  for (const bool positional : {true, false}) {
    for (const CLI::Option* option : OptionsOf(app, positional)) text += OptionText(*option);
  }
  return text;
}

// A verb below the one of the page, with those below it.
std::string VerbText(const CLI::App& app, const std::string& command) {
  std::string text = ".SS " + Roff(command) + "\n" + Synopsis(app, command) + ".PP\n" +
                     Paragraph(app.get_description()) + OptionsText(app);
  if (!app.get_footer().empty()) text += ".PP\n" + Verbatim(app.get_footer());
  for (const CLI::App* verb : VerbsOf(app)) {
    text += VerbText(*verb, command + " " + verb->get_name());
  }
  return text;
}

// The verbs of a program: a line each, for each has a page of its own.
std::string VerbList(const CLI::App& program) {
  std::string text = ".SH VERBS\nEach has a page of its own.\n";
  for (const CLI::App* verb : VerbsOf(program)) {
    text += ".TP\n\\fB" + Roff("flexarm-" + verb->get_name()) + "\\fR(1)\n" +
            Paragraph(verb->get_description());
  }
  return text;
}

void Write(const std::filesystem::path& file, const std::string& page) {
  std::ofstream out(file, std::ios::binary);
  out << page;
  out.close();
  if (!out) throw std::runtime_error(file.string() + ": cannot be written");
}

std::string FileOf(const ManualTitle& title) {
  return Dashed(title.command) + "." + std::to_string(title.section);
}

}  // namespace

std::string ManualPage(const CLI::App& app, const ManualTitle& title) {
  const bool is_program = title.command.find(' ') == std::string::npos;
  std::string page = ".\\\" Written by " + Roff(title.command) + " from its --help.\n";
  page += ".TH " + Roff(Upper(title.command)) + " " + std::to_string(title.section) +
          " \"\" \"flexarm " + title.version + "\" \"flexarm\"\n";
  page += ".SH NAME\n" + Roff(Dashed(title.command)) + " \\- " + Roff(app.get_description()) + "\n";
  page += ".SH SYNOPSIS\n" + Synopsis(app, title.command);
  if (const std::string options = OptionsText(app); !options.empty()) {
    page += ".SH OPTIONS\n" + options;
  }
  if (is_program && !VerbsOf(app).empty()) {
    page += VerbList(app);
  } else if (!VerbsOf(app).empty()) {
    page += ".SH VERBS\n";
    for (const CLI::App* verb : VerbsOf(app)) {
      page += VerbText(*verb, title.command + " " + verb->get_name());
    }
  }
  if (!app.get_footer().empty()) page += ".SH NOTES\n" + Verbatim(app.get_footer());
  page +=
      ".SH EXIT STATUS\n0: done. 1: a run, replay or check failed. 2: bad usage, config or "
      "input.\n";
  page += ".SH SEE ALSO\n\\fBflexarm\\fR(1), \\fBflexarmd\\fR(8)\n";
  return page;
}

void WriteManual(const CLI::App& program, const ManualTitle& title,
                 const std::filesystem::path& folder) {
  const std::filesystem::path pages = folder / ("man" + std::to_string(title.section));
  std::filesystem::create_directories(pages);
  Write(pages / FileOf(title), ManualPage(program, title));
  for (const CLI::App* verb : VerbsOf(program)) {
    if (ProgramOf(verb->get_name()) != title.command) continue;
    ManualTitle of_verb = title;
    of_verb.command = "flexarm " + verb->get_name();
    Write(pages / FileOf(of_verb), ManualPage(*verb, of_verb));
  }
}

}  // namespace flexarm
