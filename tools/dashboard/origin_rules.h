#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/dashboard/listen_address.h"

namespace flexarm {

/// Headers of a request that say which page of which site a browser sends it for. Empty: the
/// request has no such header.
struct RequestSource {
  std::optional<std::string> host{};            ///< Host
  std::optional<std::string> origin{};          ///< Origin
  std::optional<std::string> sec_fetch_site{};  ///< Sec-Fetch-Site
};

/// Refuses requests that a page of another site makes in the user's browser: also one whose name
/// its owner has pointed at this computer (DNS rebinding), because then Host has that name.
/// Pure functions. Thread: any.
class OriginRules {
 public:
  /// @param address  on which the server listens, with its port
  explicit OriginRules(const ListenAddress& address);

  /// Whether a request may be answered at all. @returns why not; empty: it may
  std::string WhyNotAnswered(const RequestSource& source) const;

  /// Whether a request may have values of the arm: also Origin, if it is there, is this page.
  std::string WhyNotShown(const RequestSource& source) const;

  /// Whether a request may give a command: Origin is there, and is this page.
  std::string WhyNotCommanded(const RequestSource& source) const;

  /// "127.0.0.1:8080, localhost:8080": what Host may be.
  std::string HostsText() const;

 private:
  bool IsHost(std::string_view host) const;

  std::vector<std::string> hosts_;
};

}  // namespace flexarm
