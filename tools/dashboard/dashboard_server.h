#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "tools/dashboard/access_token.h"
#include "tools/dashboard/experiment_list.h"
#include "tools/dashboard/listen_address.h"

namespace flexarm {

/// What a dashboard serves, and to whom.
struct DashboardOptions {
  ListenAddress address{};
  std::string socket;                  ///< of the daemon
  double period_s = 0.1;               ///< between two looks at the daemon
  std::optional<AccessToken> token{};  ///< with it commands are taken; empty: read only
  ExperimentList experiments{{}};      ///< that the page offers
};

/// The live page of one daemon: an HTTP server that passes the daemon's status on to any number of
/// browsers, and their commands to the daemon. docs/dashboard.md has its requests and its rules.
///
/// One thread serves all browsers and never waits; one asks the daemon, two give commands.
class DashboardServer {
 public:
  /// Streams at a time; one more gets the status 503.
  static constexpr std::size_t kMostStreams = 256;
  /// Connections at a time that have all requests answered; beyond, all but commands get 503.
  static constexpr unsigned kMostConnections = 512;
  /// Connections at a time; more wait until one ends.
  static constexpr unsigned kAllConnections = 600;
  static constexpr unsigned kIdle_s = 5;               ///< a connection that is idle ends
  static constexpr std::size_t kMostBodyBytes = 4096;  ///< of a request

  /// Listens and serves until the end of this object.
  /// @throws InputError: it cannot listen; std::runtime_error
  explicit DashboardServer(DashboardOptions options);
  ~DashboardServer();
  DashboardServer(const DashboardServer&) = delete;
  DashboardServer& operator=(const DashboardServer&) = delete;

  /// With the port that the kernel has chosen, if it was 0.
  const ListenAddress& address() const;

 private:
  class Service;
  std::unique_ptr<Service> service_;
};

}  // namespace flexarm
