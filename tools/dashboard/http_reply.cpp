#include "tools/dashboard/http_reply.h"

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

namespace flexarm {
namespace {

constexpr std::array kSecurityHeaders = {
    std::pair{"Cache-Control", "no-store"},
    std::pair{"Content-Security-Policy",
              "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
              "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    std::pair{"Cross-Origin-Opener-Policy", "same-origin"},
    std::pair{"Cross-Origin-Resource-Policy", "same-origin"},
    std::pair{"Referrer-Policy", "no-referrer"},
    std::pair{"X-Content-Type-Options", "nosniff"},
    std::pair{"X-Frame-Options", "DENY"},
};

}  // namespace

HttpReply Refusal(unsigned status, std::string_view error, std::string_view remedy) {
  using Json = nlohmann::ordered_json;
  const Json json{
      {"ok", false}, {"error", error}, {"remedy", remedy.empty() ? Json(nullptr) : Json(remedy)}};
  HttpReply reply{.status = status};
  reply.body = json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  return reply;
}

void AddSecurityHeaders(MHD_Response* response) {
  for (const auto& [name, value] : kSecurityHeaders) {
    MHD_add_response_header(response, name, value);
  }
}

MHD_Result Send(MHD_Connection* connection, const HttpReply& reply) {
  std::string body = reply.body;  // copied by the library
  const HttpResponse response(
      MHD_create_response_from_buffer(body.size(), body.data(), MHD_RESPMEM_MUST_COPY),
      &MHD_destroy_response);
  if (response == nullptr) return MHD_NO;
  AddSecurityHeaders(response.get());
  MHD_add_response_header(response.get(), "Content-Type", reply.type.c_str());
  if (!reply.allow.empty()) MHD_add_response_header(response.get(), "Allow", reply.allow.c_str());
  if (reply.retry_after_s > 0) {
    MHD_add_response_header(response.get(), "Retry-After",
                            std::to_string(reply.retry_after_s).c_str());
  }
  if (reply.status == MHD_HTTP_UNAUTHORIZED) {
    MHD_add_response_header(response.get(), "WWW-Authenticate", "Bearer");
  }
  if (reply.closes) MHD_add_response_header(response.get(), "Connection", "close");
  return MHD_queue_response(connection, reply.status, response.get());
}

}  // namespace flexarm
