#include "tools/dashboard/origin_rules.h"

#include <algorithm>
#include <cctype>

namespace flexarm {
namespace {

constexpr std::string_view kScheme = "http://";

bool SameButForCase(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) ==
           std::tolower(static_cast<unsigned char>(y));
  });
}

}  // namespace

OriginRules::OriginRules(const ListenAddress& address) {
  std::vector<ListenAddress> all{address};
  if (address.IsLoopback()) {
    for (const char* name : {"localhost", "127.0.0.1", "::1"}) {
      all.push_back({.ip = name, .port = address.port});
    }
  }
  for (const ListenAddress& one : all) {
    const std::string text = one.Text();
    if (std::find(hosts_.begin(), hosts_.end(), text) == hosts_.end()) hosts_.push_back(text);
    // A browser leaves the port of the scheme out.
    constexpr std::string_view kUsualPort = ":80";
    if (one.port == 80) hosts_.push_back(text.substr(0, text.size() - kUsualPort.size()));
  }
}

bool OriginRules::IsHost(std::string_view host) const {
  return std::any_of(hosts_.begin(), hosts_.end(),
                     [host](const std::string& one) { return SameButForCase(one, host); });
}

std::string OriginRules::HostsText() const {
  std::string text;
  for (const std::string& host : hosts_) text += (text.empty() ? "" : ", ") + host;
  return text;
}

std::string OriginRules::WhyNotAnswered(const RequestSource& source) const {
  if (source.host && IsHost(*source.host)) return {};
  return "the header Host is not one of " + HostsText();
}

std::string OriginRules::WhyNotShown(const RequestSource& source) const {
  if (std::string why = WhyNotAnswered(source); !why.empty()) return why;
  if (source.origin && !SameButForCase(*source.origin, std::string(kScheme) + *source.host)) {
    return "the header Origin is not this page, " + std::string(kScheme) + *source.host;
  }
  const bool of_another_site = source.sec_fetch_site && *source.sec_fetch_site != "same-origin" &&
                               *source.sec_fetch_site != "none";
  return of_another_site ? "the header Sec-Fetch-Site says that another site asks" : "";
}

std::string OriginRules::WhyNotCommanded(const RequestSource& source) const {
  if (std::string why = WhyNotShown(source); !why.empty()) return why;
  return source.origin ? "" : "the header Origin is missing: a command comes from this page";
}

}  // namespace flexarm
