#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "controller/files/input_error.h"
#include "tools/command_line/options.h"
#include "tools/command_line/other_programs.h"
#include "tools/command_line/verbs.h"
#include "tools/daemon_client/daemon_client.h"
#include "tools/dashboard/dashboard_server.h"

namespace flexarm {
namespace {

struct VerbOptions {
  DaemonClient daemon;
  std::string bind = "127.0.0.1";
  std::uint16_t port = 8080;
  double period_s = 0.1;
  bool allow_control = false;
  std::filesystem::path token_file;
  std::filesystem::path experiments;
};

/// SIGINT, SIGTERM and SIGHUP as something to wait for. The threads that are made later do not get
/// them either.
class EndSignals {
 public:
  EndSignals() {
    sigemptyset(&signals_);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals_, number);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  }
  void Await() const {
    int number = 0;
    sigwait(&signals_, &number);
  }

 private:
  sigset_t signals_{};
};

// Beyond this computer values and commands pass through a network, and others can ask.
void CheckReach(const VerbOptions& options, const ListenAddress& address) {
  if (address.IsLoopback()) return;
  if (options.allow_control && !options.token_file.empty()) {
    std::cerr << "flexarm: dashboard: warning: " << address.ip
              << " is reached by other computers, and what passes is not encrypted: the network "
                 "must be one that you trust\n";
    return;
  }
  throw InputError("--bind: " + address.ip +
                   " is reached by other computers, which needs --allow-control and --token-file; "
                   "better leave --bind out, and tunnel from the other computer: ssh -L " +
                   std::to_string(address.port) + ":127.0.0.1:" + std::to_string(address.port) +
                   " USER@HOST");
}

std::optional<AccessToken> TokenOf(const VerbOptions& options) {
  if (!options.allow_control) return std::nullopt;
  return options.token_file.empty() ? AccessToken::Fresh()
                                    : AccessToken::OfFile(options.token_file);
}

// Without the folder the page works, but offers no experiment.
std::filesystem::path ExperimentsOf(const VerbOptions& options) {
  if (!options.experiments.empty()) {
    if (std::filesystem::is_directory(options.experiments)) return options.experiments;
    throw InputError(options.experiments.string() + ": is no folder");
  }
  try {
    return ExperimentsFolder(options.daemon.config, "square-30deg.toml");
  } catch (const InputError&) {
    return {};
  }
}

// The token of a file is never printed.
void PrintUrl(const VerbOptions& options, const ListenAddress& address,
              const std::optional<AccessToken>& token) {
  const bool shows_token = token && options.token_file.empty();
  const std::string url =
      "http://" + address.Text() + "/" + (shows_token ? "#token=" + token->text() : "");
  if (options.daemon.json) {
    std::cout << nlohmann::ordered_json{{"url", url},
                                        {"port", address.port},
                                        {"control", options.allow_control}}
                     .dump()
              << '\n'
              << std::flush;
    return;
  }
  std::cout << (options.allow_control ? "dashboard, with control: " : "dashboard, read only: ")
            << url << '\n'
            << std::flush;
}

int Serve(const VerbOptions& options) {
  const EndSignals signals;  // before any thread
  DashboardOptions served{.address = {.ip = options.bind, .port = options.port},
                          .socket = options.daemon.SocketPath(),
                          .period_s = options.period_s,
                          .token = TokenOf(options),
                          .experiments = ExperimentList(ExperimentsOf(options))};
  CheckReach(options, served.address);
  const std::optional<AccessToken> token = served.token;
  const DashboardServer server(std::move(served));
  PrintUrl(options, server.address(), token);
  signals.Await();
  return Exit::kDone;
}

}  // namespace

void RegisterDashboard(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<VerbOptions>();
  const OtherVerb& row = RowOf("dashboard");
  CLI::App* verb = options->daemon.AddVerb(app, std::string(row.verb).c_str(),
                                           std::string(row.description).c_str());
  verb->add_option("--port", options->port, "TCP port; 0: a free one")
      ->capture_default_str()
      ->type_name("N");
  verb->add_option("--bind", options->bind,
                   "Address to listen on. Another than of this computer alone needs "
                   "--allow-control and --token-file")
      ->capture_default_str()
      ->type_name("ADDRESS");
  verb->add_option("--period", options->period_s,
                   "Seconds between two looks at the daemon, 0.05 to 1")
      ->check(NumberWithin(0.05, 1.0))
      ->capture_default_str()
      ->type_name("SECONDS");
  CLI::Option* control =
      verb->add_flag("--allow-control", options->allow_control,
                     "Also take commands, with a token, as the user who runs this");
  verb->add_option("--token-file", options->token_file,
                   "File, of mode 600, whose first line is the token; without it a new one is made "
                   "and printed in the URL")
      ->needs(control)
      ->type_name("FILE");
  verb->add_option("--experiments", options->experiments,
                   "Folder of the experiments that the page offers (default: the shipped ones)")
      ->type_name("DIR");
  verb->footer(
      "Prints the URL to open, and serves until Ctrl-C. Any number of browsers share one "
      "connection\n"
      "to the daemon. Read only unless --allow-control is given. From another computer:\n"
      "ssh -L 8080:127.0.0.1:8080 USER@HOST, and the same URL there. docs/dashboard.md has the\n"
      "page, its keys, and who can do what.\n"
      "Examples: flexarm dashboard\n"
      "          flexarm dashboard --allow-control --port 0");
  verb->callback([options, &exit] { exit.code = Serve(*options); });
}

}  // namespace flexarm
