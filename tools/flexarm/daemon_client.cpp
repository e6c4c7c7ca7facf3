#include "tools/flexarm/daemon_client.h"

#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

#include "controller/operator/operator_socket.h"
#include "controller/runlog/errors.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

std::string SocketOf(const DaemonClient& client) {
  if (!client.socket.empty()) return client.socket;
  if (client.config.given()) return client.config.Load().daemon.socket;
  const char* named = std::getenv("FLEXARM_SOCKET");
  return named != nullptr ? named : "/run/flexarm/flexarmd.sock";
}

}  // namespace

CLI::App* DaemonClient::AddVerb(CLI::App& app, const char* name, const char* what) {
  CLI::App* verb = app.add_subcommand(name, what);
  config.AddTo(verb, false);
  verb->add_option("--socket", socket,
                   "Socket of the daemon (default: daemon.socket of --config, else "
                   "$FLEXARM_SOCKET, else /run/flexarm/flexarmd.sock)")
      ->type_name("PATH");
  AddJson(verb, &json);
  return verb;
}

nlohmann::ordered_json DaemonClient::Ask(const nlohmann::ordered_json& command,
                                         double within_s) const {
  const std::string reply = AskDaemon(SocketOf(*this), command.dump(), within_s);
  nlohmann::ordered_json answer = nlohmann::ordered_json::parse(reply, nullptr, false);
  if (!answer.is_object()) throw InputError("the answer of the daemon is not JSON");
  return answer;
}

int DaemonClient::Conclude(const nlohmann::ordered_json& answer) const {
  const bool ok = answer.value("ok", false);
  if (json) {
    std::cout << answer.dump(2) << '\n';
  } else if (ok) {
    std::cout << answer.value("command", "done") << ": ok, state " << answer.value("state", "-")
              << '\n';
  }
  if (!ok) {
    std::cerr << "flexarm: " << answer.value("error", "refused");
    if (answer.contains("remedy")) std::cerr << "; " << answer.value("remedy", "");
    std::cerr << '\n';
  }
  return ok ? Exit::kDone : Exit::kFailed;
}

}  // namespace flexarm
