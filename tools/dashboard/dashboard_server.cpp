#include "tools/dashboard/dashboard_server.h"

#include <microhttpd.h>

#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "controller/files/input_error.h"
#include "controller/runlog/build_info.h"
#include "tools/advice/advice_page.h"
#include "tools/dashboard/command_desk.h"
#include "tools/dashboard/command_request.h"
#include "tools/dashboard/delayed_calls.h"
#include "tools/dashboard/http_reply.h"
#include "tools/dashboard/http_request.h"
#include "tools/dashboard/newest_message.h"
#include "tools/dashboard/origin_rules.h"
#include "tools/dashboard/page_file.h"
#include "tools/dashboard/status_link.h"
#include "tools/dashboard/wrong_tokens.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kConnectionBytes = 32
                                         << 10;  // of memory: its headers, and a piece of a stream
constexpr std::size_t kPieceBytes = 16 << 10;    // of a stream
constexpr std::chrono::milliseconds kWrongTokenDelay{1000};
constexpr std::size_t kMostDelayed = 32;

constexpr const char* kStream = "/api/stream";
constexpr const char* kCommand = "/api/command";

/// A request from its headers to the end of its answer.
struct Exchange {
  explicit Exchange(HttpRequest read) : request(std::move(read)) {}

  HttpRequest request;
  std::string body{};
  std::optional<HttpReply> reply{};  // set while the connection sleeps, or before
};

/// A stream of events to one browser, counted.
struct Stream {
  Stream(NewestMessage& messages, MHD_Connection* to, std::atomic<std::size_t>& all)
      : reader(messages), connection(to), count(all) {}
  ~Stream() { --count; }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  MessageReader reader;
  MHD_Connection* connection;
  std::atomic<std::size_t>& count;
};

ssize_t ReadStream(void* of, std::uint64_t /*at*/, char* out, std::size_t most) {
  auto* stream = static_cast<Stream*>(of);
  MHD_Connection* connection = stream->connection;
  const std::int64_t count =
      stream->reader.Read(out, most,
                          {.begin = [connection] { MHD_suspend_connection(connection); },
                           .end = [connection] { MHD_resume_connection(connection); }});
  return count == MessageReader::kEnded ? MHD_CONTENT_READER_END_OF_STREAM
                                        : static_cast<ssize_t>(count);
}

void EndStream(void* of) { const std::unique_ptr<Stream> stream(static_cast<Stream*>(of)); }

void EndExchange(void* /*service*/, MHD_Connection* /*connection*/, void** exchange,
                 MHD_RequestTerminationCode /*code*/) {
  const std::unique_ptr<Exchange> ended(static_cast<Exchange*>(*exchange));
  *exchange = nullptr;
}

HttpReply OutcomeReply(const CommandOutcome& outcome) {
  HttpReply reply{.status = MHD_HTTP_OK, .body = outcome.json + "\n"};
  if (!outcome.ok) reply.status = MHD_HTTP_CONFLICT;
  if (!outcome.answered) reply.status = MHD_HTTP_BAD_GATEWAY;
  return reply;
}

}  // namespace

class DashboardServer::Service {
 public:
  explicit Service(DashboardOptions options)
      : options_(std::move(options)),
        needs_token_(!options_.address.IsLoopback()),
        listener_(Listen(&options_.address)),
        rules_(options_.address),
        urgent_(options_.socket),
        ordinary_(options_.socket),
        delayed_(kWrongTokenDelay, kMostDelayed),
        link_(options_.socket, options_.period_s, messages_) {
    Start();
  }

  ~Service() {
    ends_ = true;
    urgent_.Close();
    ordinary_.Close();
    delayed_.Close();
    messages_.Close();
    // No connection sleeps any more. The listening socket is this object's, not the library's.
    MHD_quiesce_daemon(daemon_);
    MHD_stop_daemon(daemon_);
  }
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  const ListenAddress& address() const { return options_.address; }

 private:
  void Start();
  static MHD_Result Answer(void* service, MHD_Connection* connection, const char* path,
                           const char* method, const char* version, const char* upload,
                           std::size_t* upload_bytes, void** exchange);
  static void Count(void* service, MHD_Connection* connection, void** unused,
                    MHD_ConnectionNotificationCode code);

  MHD_Result Begin(MHD_Connection* connection, const char* path, const char* method,
                   void** exchange);
  MHD_Result Continue(MHD_Connection* connection, Exchange* exchange);
  /// Why a request is not answered, by its headers; nothing: it is.
  std::optional<HttpReply> WhyNot(const HttpRequest& request) const;
  std::optional<HttpReply> WhyNotByToken(const HttpRequest& request) const;
  HttpReply Content(const std::string& path) const;
  HttpReply About() const;
  MHD_Result SendStream(MHD_Connection* connection);
  MHD_Result GiveCommand(MHD_Connection* connection, Exchange* exchange);
  MHD_Result DelayRefusal(MHD_Connection* connection, Exchange* exchange, HttpReply refusal);

  DashboardOptions options_;
  bool needs_token_;  // whatever is asked: others than this computer can ask
  FileDescriptor listener_;
  OriginRules rules_;
  std::atomic<bool> ends_ = false;
  std::atomic<std::size_t> streams_ = 0;
  std::atomic<unsigned> connections_ = 0;
  WrongTokens wrong_tokens_;
  NewestMessage messages_;
  CommandDesk urgent_, ordinary_;
  DelayedCalls delayed_;
  StatusLink link_;
  MHD_Daemon* daemon_ = nullptr;
};

void DashboardServer::Service::Start() {
  daemon_ = MHD_start_daemon(
      MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME, 0, nullptr, nullptr, &Answer, this,
      MHD_OPTION_LISTEN_SOCKET, listener_.get(), MHD_OPTION_CONNECTION_LIMIT, kAllConnections,
      MHD_OPTION_CONNECTION_TIMEOUT, kIdle_s, MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionBytes,
      MHD_OPTION_STRICT_FOR_CLIENT, 1, MHD_OPTION_NOTIFY_COMPLETED, &EndExchange, this,
      MHD_OPTION_NOTIFY_CONNECTION, &Count, this, MHD_OPTION_END);
  if (daemon_ == nullptr) throw std::runtime_error("libmicrohttpd does not start");
}

void DashboardServer::Service::Count(void* service, MHD_Connection* /*connection*/,
                                     void** /*unused*/, MHD_ConnectionNotificationCode code) {
  auto* self = static_cast<Service*>(service);
  if (code == MHD_CONNECTION_NOTIFY_STARTED) ++self->connections_;
  if (code == MHD_CONNECTION_NOTIFY_CLOSED) --self->connections_;
}

// Called when the headers are there, for each part of the body, and at its end or after a sleep.
MHD_Result DashboardServer::Service::Answer(void* service, MHD_Connection* connection,
                                            const char* path, const char* method,
                                            const char* /*version*/, const char* upload,
                                            std::size_t* upload_bytes, void** exchange) {
  auto* self = static_cast<Service*>(service);
  if (self->ends_) return MHD_NO;
  if (*exchange == nullptr) return self->Begin(connection, path, method, exchange);
  auto* begun = static_cast<Exchange*>(*exchange);
  if (*upload_bytes == 0) return self->Continue(connection, begun);
  if (begun->body.size() + *upload_bytes > kMostBodyBytes) return MHD_NO;
  begun->body.append(upload, *upload_bytes);
  *upload_bytes = 0;
  return MHD_YES;
}

MHD_Result DashboardServer::Service::Begin(MHD_Connection* connection, const char* path,
                                           const char* method, void** exchange) {
  auto begun = std::make_unique<Exchange>(ReadRequest(connection, path, method));
  auto* kept = begun.get();
  *exchange = begun.release();
  const std::optional<HttpReply> refusal = WhyNot(kept->request);
  return refusal ? Send(connection, *refusal) : MHD_YES;
}

std::optional<HttpReply> DashboardServer::Service::WhyNot(const HttpRequest& request) const {
  const bool is_command = request.path == kCommand;
  const bool is_api = request.path.starts_with("/api/");
  const std::string allowed = is_command ? "POST" : "GET, HEAD";
  const bool method_fits =
      is_command ? request.method == "POST" : request.method == "GET" || request.method == "HEAD";
  if (!request.repeated.empty()) {
    return Refusal(MHD_HTTP_BAD_REQUEST, "the header " + request.repeated + " is there twice");
  }
  if (std::string why = rules_.WhyNotAnswered(request.source); !why.empty()) {
    return Refusal(MHD_HTTP_FORBIDDEN, why,
                   "open http://" + options_.address.Text() +
                       "/; a tunnel has the same port at both of its ends");
  }
  if (!method_fits) {
    HttpReply reply = Refusal(MHD_HTTP_METHOD_NOT_ALLOWED, "expected the method " + allowed);
    reply.allow = allowed;
    return reply;
  }
  if (request.has_unknown_size) {
    return Refusal(MHD_HTTP_LENGTH_REQUIRED, "expected the header Content-Length");
  }
  if (request.body_bytes > kMostBodyBytes) {
    return Refusal(MHD_HTTP_CONTENT_TOO_LARGE, "the body of a request has at most " +
                                                   std::to_string(kMostBodyBytes) + " bytes");
  }
  if (connections_ > kMostConnections && !is_command) {
    HttpReply reply = Refusal(MHD_HTTP_SERVICE_UNAVAILABLE, "too many connections are open",
                              "close pages of the dashboard");
    reply.retry_after_s = kIdle_s;
    reply.closes = true;
    return reply;
  }
  if (is_api) {
    const std::string why =
        is_command ? rules_.WhyNotCommanded(request.source) : rules_.WhyNotShown(request.source);
    if (!why.empty()) return Refusal(MHD_HTTP_FORBIDDEN, why);
  }
  if (is_command && !options_.token) {
    return Refusal(MHD_HTTP_FORBIDDEN, "this dashboard is read only",
                   "start `flexarm dashboard --allow-control`");
  }
  if (is_command && !request.IsJson()) {
    return Refusal(MHD_HTTP_UNSUPPORTED_MEDIA_TYPE, "expected Content-Type: application/json");
  }
  return std::nullopt;
}

std::optional<HttpReply> DashboardServer::Service::WhyNotByToken(const HttpRequest& request) const {
  const bool needs =
      request.path == kCommand || (needs_token_ && request.path.starts_with("/api/"));
  if (!needs || options_.token->Matches(request.Token())) return std::nullopt;
  return Refusal(MHD_HTTP_UNAUTHORIZED,
                 request.Token().empty() ? "the token is missing" : "the token is wrong",
                 "open the URL that `flexarm dashboard` printed, or enter the token of its file");
}

MHD_Result DashboardServer::Service::Continue(MHD_Connection* connection, Exchange* exchange) {
  if (exchange->reply) return Send(connection, *exchange->reply);
  if (std::optional<HttpReply> refusal = WhyNotByToken(exchange->request)) {
    return DelayRefusal(connection, exchange, *std::move(refusal));
  }
  const std::string& path = exchange->request.path;
  if (path == kCommand) return GiveCommand(connection, exchange);
  if (path == kStream && exchange->request.method == "GET") return SendStream(connection);
  return Send(connection, Content(path));
}

// A wrong token is answered late, so that tokens cannot be tried fast on few connections.
MHD_Result DashboardServer::Service::DelayRefusal(MHD_Connection* connection, Exchange* exchange,
                                                  HttpReply refusal) {
  wrong_tokens_.Report(exchange->request.path);
  exchange->reply = std::move(refusal);
  MHD_suspend_connection(connection);
  if (delayed_.Call([connection] { MHD_resume_connection(connection); })) return MHD_YES;
  exchange->reply = Refusal(MHD_HTTP_TOO_MANY_REQUESTS, "too many requests with a wrong token");
  exchange->reply->retry_after_s = 1;
  exchange->reply->closes = true;
  MHD_resume_connection(connection);
  return MHD_YES;
}

HttpReply DashboardServer::Service::Content(const std::string& path) const {
  if (const PageFile* file = FindPageFile(path)) {
    return {.type = std::string(file->type), .body = std::string(file->text)};
  }
  if (path == "/api/about") return About();
  if (path == "/api/explain") return {.body = AdviceJson(AllAdvice()).dump() + "\n"};
  if (path == kStream) return {.type = "text/event-stream"};
  if (path == "/api/status") {
    std::string status = link_.NewestStatus();
    if (status.empty()) return Refusal(MHD_HTTP_BAD_GATEWAY, "the daemon does not answer");
    return {.body = std::move(status) + "\n"};
  }
  return Refusal(MHD_HTTP_NOT_FOUND, "there is nothing at this path");
}

HttpReply DashboardServer::Service::About() const {
  const Json json{
      {"version", ThisBuild().version},       {"control", options_.token.has_value()},
      {"period_s", options_.period_s},        {"experiments", options_.experiments.Names()},
      {"streams", streams_.load()},           {"streams_limit", kMostStreams},
      {"wrong_tokens", wrong_tokens_.count()}};
  return {.body = json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"};
}

MHD_Result DashboardServer::Service::SendStream(MHD_Connection* connection) {
  if (++streams_ > kMostStreams) {
    --streams_;
    HttpReply reply = Refusal(MHD_HTTP_SERVICE_UNAVAILABLE,
                              "too many browsers watch already: " + std::to_string(kMostStreams),
                              "close one, or start another `flexarm dashboard --port N`");
    reply.retry_after_s = kIdle_s;
    reply.closes = true;
    return Send(connection, reply);
  }
  auto stream = std::make_unique<Stream>(messages_, connection, streams_);
  const HttpResponse response(
      MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, kPieceBytes, &ReadStream, stream.get(),
                                        &EndStream),
      &MHD_destroy_response);
  if (response == nullptr) return MHD_NO;
  static_cast<void>(stream.release());  // EndStream deletes it
  AddSecurityHeaders(response.get());
  MHD_add_response_header(response.get(), "Content-Type", "text/event-stream");
  return MHD_queue_response(connection, MHD_HTTP_OK, response.get());
}

MHD_Result DashboardServer::Service::GiveCommand(MHD_Connection* connection, Exchange* exchange) {
  DaemonCommand command;
  try {
    command = ReadCommand(exchange->body, options_.experiments);
  } catch (const std::exception& error) {
    return Send(connection, Refusal(MHD_HTTP_BAD_REQUEST, error.what()));
  }
  CommandDesk& desk = command.is_urgent() ? urgent_ : ordinary_;
  MHD_suspend_connection(connection);
  const bool taken = desk.Take(std::move(command), [=](const CommandOutcome& outcome) {
    exchange->reply = OutcomeReply(outcome);
    MHD_resume_connection(connection);
  });
  if (taken) return MHD_YES;
  exchange->reply = Refusal(MHD_HTTP_SERVICE_UNAVAILABLE, "too many commands wait already");
  exchange->reply->retry_after_s = 1;
  MHD_resume_connection(connection);
  return MHD_YES;
}

DashboardServer::DashboardServer(DashboardOptions options)
    : service_(std::make_unique<Service>(std::move(options))) {}

DashboardServer::~DashboardServer() = default;

const ListenAddress& DashboardServer::address() const { return service_->address(); }

}  // namespace flexarm
