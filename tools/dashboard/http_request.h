#pragma once

#include <microhttpd.h>

#include <cstdint>
#include <optional>
#include <string>

#include "tools/dashboard/origin_rules.h"

namespace flexarm {

/// What the server looks at of a request, but its body.
struct HttpRequest {
  std::string method, path;
  RequestSource source{};
  std::optional<std::string> authorization{}, content_type{};
  std::string repeated{};         ///< one of these headers that is there twice; empty: none is
  bool has_unknown_size = false;  ///< its body has no Content-Length
  std::uint64_t body_bytes = 0;   ///< header Content-Length; UINT64_MAX: it is no number

  /// Of "Authorization: Bearer TOKEN"; empty: there is none.
  std::string Token() const;
  /// Its Content-Type is application/json, with or without a charset.
  bool IsJson() const;
};

/// Reads the headers of a request whose body may still come.
HttpRequest ReadRequest(MHD_Connection* connection, const char* path, const char* method);

}  // namespace flexarm
