#include "tools/plot/gnuplot.h"

#include <array>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace flexarm {
namespace {

constexpr std::array<const char*, 8> kColours = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                 "#56B4E9", "#E69F00", "#000000", "#7F7F7F"};

}  // namespace

const char* Colour(std::size_t i) { return kColours[i % kColours.size()]; }

std::string QuotedPath(const std::string& path) {
  std::string quoted = "'";
  for (const char c : path) quoted += c == '\'' ? "''" : std::string(1, c == '\n' ? ' ' : c);
  return quoted + "'";
}

std::string Quoted(const std::string& text) {
  std::string plain;
  for (const char c : text) {
    if (std::strchr("\\_^{}@&~", c) != nullptr) plain += '\\';
    plain += c;
  }
  return QuotedPath(plain);
}

std::string TerminalFor(const std::filesystem::path& output, int width, int height) {
  const std::string size = std::to_string(width) + "," + std::to_string(height);
  const std::string font = "enhanced font 'DejaVu Sans,12'";
  const std::string kind = output.extension() == ".svg"
                               ? "svg size " + size + " dynamic " + font + " background '#ffffff'"
                               : "pngcairo size " + size + " " + font;
  return "set encoding utf8\nset terminal " + kind + "\nset output " + QuotedPath(output.string()) +
         "\n";
}

void RunGnuplot(const std::string& script) {
  std::signal(SIGPIPE, SIG_IGN);  // a missing gnuplot must give a message, not end the process
  std::FILE* pipe = ::popen("gnuplot", "w");
  if (pipe == nullptr) throw std::runtime_error("gnuplot cannot be started");
  const bool written = std::fwrite(script.data(), 1, script.size(), pipe) == script.size();
  const int status = ::pclose(pipe);
  if (!written || status != 0) {
    throw std::runtime_error(
        "gnuplot failed or is missing; it is in the Debian package gnuplot-nox");
  }
}

}  // namespace flexarm
