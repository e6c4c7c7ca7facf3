#include "tools/dashboard/http_request.h"

#include <strings.h>

#include <array>
#include <charconv>
#include <limits>
#include <string_view>

namespace flexarm {
namespace {

bool Same(std::string_view a, std::string_view b) {
  return a.size() == b.size() && strncasecmp(a.data(), b.data(), a.size()) == 0;
}

void Keep(std::string_view name, std::string_view value, std::optional<std::string>* header,
          HttpRequest* request) {
  if (header->has_value()) request->repeated = name;
  *header = std::string(value);
}

std::uint64_t CountOf(std::string_view text) {
  std::uint64_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  const bool is_number = error == std::errc() && end == text.data() + text.size() && !text.empty();
  return is_number ? count : std::numeric_limits<std::uint64_t>::max();
}

MHD_Result TakeHeader(void* into, MHD_ValueKind /*kind*/, const char* name, const char* value) {
  auto* request = static_cast<HttpRequest*>(into);
  const std::string_view key(name), text(value != nullptr ? value : "");
  if (Same(key, "Host")) Keep(key, text, &request->source.host, request);
  if (Same(key, "Origin")) Keep(key, text, &request->source.origin, request);
  if (Same(key, "Sec-Fetch-Site")) Keep(key, text, &request->source.sec_fetch_site, request);
  if (Same(key, "Authorization")) Keep(key, text, &request->authorization, request);
  if (Same(key, "Content-Type")) Keep(key, text, &request->content_type, request);
  if (Same(key, "Content-Length")) request->body_bytes = CountOf(text);
  if (Same(key, "Transfer-Encoding")) request->has_unknown_size = true;
  return MHD_YES;
}

}  // namespace

std::string HttpRequest::Token() const {
  constexpr std::string_view kScheme = "Bearer ";
  if (!authorization || authorization->size() < kScheme.size()) return {};
  const std::string_view text = *authorization;
  if (!Same(text.substr(0, kScheme.size()), kScheme)) return {};
  return std::string(text.substr(kScheme.size()));
}

bool HttpRequest::IsJson() const {
  if (!content_type) return false;
  std::string_view type = *content_type;
  type = type.substr(0, type.find(';'));
  while (!type.empty() && type.back() == ' ') type.remove_suffix(1);
  return Same(type, "application/json");
}

HttpRequest ReadRequest(MHD_Connection* connection, const char* path, const char* method) {
  HttpRequest request{.method = method, .path = path};
  MHD_get_connection_values(connection, MHD_HEADER_KIND, TakeHeader, &request);
  return request;
}

}  // namespace flexarm
