#pragma once

#include <microhttpd.h>

#include <memory>
#include <string>
#include <string_view>

namespace flexarm {

/// An answer that is complete.
struct HttpReply {
  unsigned status = MHD_HTTP_OK;
  std::string type = "application/json";
  std::string body{};
  std::string allow{};         ///< header Allow, of a method that is not
  unsigned retry_after_s = 0;  ///< header Retry-After; 0: none
  bool closes = false;         ///< the connection
};

/// {"ok": false, "error": .., "remedy": ..}; "remedy" null if it is empty.
HttpReply Refusal(unsigned status, std::string_view error, std::string_view remedy = "");

/// A response of the library, destroyed at the end.
using HttpResponse = std::unique_ptr<MHD_Response, decltype(&MHD_destroy_response)>;

/// Adds the headers that every answer has: it is not stored, it runs no code but that of this page,
/// it is shown in no frame of another page, and no other site reads it.
void AddSecurityHeaders(MHD_Response* response);

/// Queues the answer for the connection.
MHD_Result Send(MHD_Connection* connection, const HttpReply& reply);

}  // namespace flexarm
