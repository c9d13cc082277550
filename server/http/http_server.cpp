#include "server/http/http_server.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <exception>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "server/base/failure_words.h"
#include "server/base/url.h"
#include "server/http/response_head.h"

namespace trapeze {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
using tcp = net::ip::tcp;
using ErrorCode = beast::error_code;
using Clock = std::chrono::steady_clock;
// Run by a single thread, so that neither locks nor strands are needed.
using Executor = net::io_context::executor_type;
using Socket = net::basic_stream_socket<tcp, Executor>;
using Timer = net::basic_waitable_timer<Clock, net::wait_traits<Clock>, Executor>;

constexpr std::size_t kMaxBuffer = std::size_t{64} << 10;  // of requests read ahead
// Bodies posted to HttpServerOptions::long_body_path stay in memory until they are answered.
constexpr std::size_t kMostLongBodies = 8;       // at the same time
constexpr std::size_t kMostLongBodiesOfOne = 3;  // for one address
constexpr std::size_t kFirstRead = 2048;         // most requests arrive complete
// Closing a connection while the client is still sending would reset it, and the response would be
// lost. So incoming data is read and discarded for a short time.
constexpr auto kLingerTime = std::chrono::seconds(1);
constexpr std::size_t kMaxLingerBytes = std::size_t{256} << 10;
// Connections above the limit that get a response saying so; further ones are closed without any.
constexpr std::size_t kMaxRefusals = 64;
constexpr auto kRefusalPause = std::chrono::seconds(1);
// A client that has closed its sending side has probably gone, but some still read a response that
// comes immediately.
constexpr auto kHalfClosedTime = std::chrono::seconds(1);
constexpr auto kAcceptPause = std::chrono::milliseconds(100);
constexpr auto kWarningPause = std::chrono::seconds(1);
// How often connections are checked for timeouts.
constexpr auto kShortestRound = std::chrono::milliseconds(10);
constexpr auto kLongestRound = std::chrono::milliseconds(500);

bool is_http_error(const ErrorCode& error) {
  return error.category() == http::make_error_code(http::error::bad_version).category();
}

ClientAddress client_address(const net::ip::address& address) {
  ClientAddress client;
  client.bytes = address.is_v4()
                     ? net::ip::make_address_v6(net::ip::v4_mapped, address.to_v4()).to_bytes()
                     : address.to_v6().to_bytes();
  return client;
}

std::string_view view_of(beast::string_view view) {
  return {view.data(), view.size()};
}

/// Joins the values of a header that occurs several times into one list.
std::string list_of(const http::request<http::string_body>& message, beast::string_view name) {
  std::string list;
  const auto [first, last] = message.equal_range(name);
  for (auto field = first; field != last; ++field) {
    if (!list.empty()) list += ',';
    list += view_of(field->value());
  }
  return list;
}

/// Whether the client lets the connection stay open after the response. Beast's keep_alive() reads
/// only the first of several Connection headers.
bool is_kept_alive(const http::request<http::string_body>& message) {
  const std::string list = list_of(message, "Connection");
  http::token_list options{list};
  return !options.exists("close") && (message.version() >= 11 || options.exists("keep-alive"));
}

/// The size of request line and headers, as received except for white space.
std::size_t header_bytes(const http::request<http::string_body>& message) {
  constexpr std::size_t kAroundLine = 13;  // " ", " HTTP/1.1", "\r\n"... and the empty line
  std::size_t bytes = message.method_string().size() + message.target().size() + kAroundLine;
  for (const auto& field : message) bytes += field.name_string().size() + field.value().size() + 4;
  return bytes;
}

/// The interval between checks: short enough that no timeout is exceeded by much.
std::chrono::milliseconds round_for(const HttpServerOptions& options) {
  const auto shortest =
      std::min({options.idle_timeout, options.read_timeout, options.write_timeout});
  return std::clamp<std::chrono::milliseconds>(shortest / 8, kShortestRound, kLongestRound);
}

/// Runs until there is nothing left to do. If memory runs out in a handler, it ends what the
/// handler was for: a connection is closed, as nothing else holds it.
void run_handlers(net::io_context& io) {
  while (true) {
    try {
      io.run();
      return;
    } catch (const std::exception& error) {
      log_failure("a connection is closed", error);
    }
  }
}

tcp::endpoint endpoint_of(const HttpServerOptions& options) {
  ErrorCode error;
  const auto address = net::ip::make_address(options.address, error);
  if (error) {
    throw std::runtime_error(
        fmt::format("cannot listen on \"{}\": an IPv4 or IPv6 address is needed", options.address));
  }
  return {address, options.port};
}

}  // namespace

/// Everything that connections share. It outlives them: connections waiting for a worker hold a
/// reference.
class HttpServer::State : public std::enable_shared_from_this<State> {
 public:
  State(const HttpServerOptions& options, Handler handler, Observer observer);

  void run();
  void stop();
  void stop_on_signals();
  void act_on_hangup(std::function<void()> act);

  std::uint16_t port() const { return port_; }
  const HttpServerOptions& options() const { return options_; }
  const Handler& handler() const { return handler_; }
  const Observer& observer() const { return observer_; }
  bool is_stopping() const { return is_leaving_; }
  /// Whether connections close after the current request.
  bool is_draining() const { return is_draining_; }
  bool is_trusted(const ClientAddress& peer) const;
  std::size_t connections() const;
  std::uint64_t refusals() const { return refusals_; }

  /// Reserves room for another long body of that client, if there is any; leave_room() releases it.
  bool take_room(const ClientAddress& client, bool is_trusted);
  void leave_room(const ClientAddress& client);

  void enter(Connection& connection);
  void leave(Connection& connection);

 private:
  void open();
  void accept();
  void on_accepted(const ErrorCode& error, Socket socket);
  void warn_of_refusal(const ErrorCode& error);
  void admit(Socket socket);
  /// Closes connections that have timed out; repeats while there are connections.
  void begin_rounds();
  void make_round();
  std::vector<std::shared_ptr<Connection>> alive_connections() const;
  void stop_threads();
  void wait_for_signal();
  void wait_for_hangup();
  void begin_draining();
  void finish();

  const HttpServerOptions options_;
  const Handler handler_;
  const Observer observer_;
  std::function<void()> on_hangup_;
  std::uint16_t port_ = 0;
  std::atomic<bool> is_leaving_ = false;
  std::atomic<bool> is_draining_ = false;
  std::atomic<std::uint64_t> refusals_ = 0;

  mutable std::mutex mutex_;  // guards the next five
  std::size_t long_bodies_ = 0;
  std::unordered_map<ClientAddress, std::size_t, ClientAddressHash> long_bodies_of_;
  std::unordered_set<Connection*> connections_;
  std::unordered_map<ClientAddress, std::size_t, ClientAddressHash> connections_of_;
  bool has_run_ = false;

  // Each with one thread and its share of the connections. Last, so that everything else is alive
  // when their remaining work is destroyed.
  struct IoThread {
    net::io_context io{1};
    net::executor_work_guard<Executor> work{io.get_executor()};
  };
  static std::vector<std::unique_ptr<IoThread>> make_io_threads(unsigned count);
  const std::vector<std::unique_ptr<IoThread>> io_threads_;
  std::size_t next_thread_ = 0;  // for the next connection

  const Executor control_;  // of the first I/O thread, for everything below
  net::basic_socket_acceptor<tcp, Executor> acceptor_;
  Timer accept_timer_;
  Clock::time_point next_warning_;  // that connections cannot be accepted
  const std::chrono::milliseconds round_;
  Timer round_timer_;
  bool has_rounds_ = false;
  Timer drain_timer_;
  net::basic_signal_set<Executor> signals_;
  net::basic_signal_set<Executor> hangups_;
};

/// One client. Reads a request, answers it, and only then reads the next, so pipelined requests are
/// answered in order. Everything runs on the thread of its socket.
class HttpServer::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(State& state, Socket socket, const ClientAddress& peer)
      : state_(state),
        peer_(peer),
        is_trusted_(state.is_trusted(peer)),
        socket_(std::move(socket)),
        half_closed_timer_(socket_.get_executor()) {}
  // NOLINTNEXTLINE(bugprone-exception-escape): memory may end
  ~Connection() {
    leave_room();
    state_.leave(*this);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// From any thread, once.
  void start();
  void refuse(const Problem& problem);
  const ClientAddress& peer() const { return peer_; }
  /// Closes the connection if it is waiting for a request; otherwise it closes after the response.
  /// From any thread.
  void drain();
  /// Closes the connection if it has timed out. From any thread.
  void end_if_late();

 private:
  /// Sets the deadline, counted from now; the connection is closed after it.
  void allow(std::chrono::milliseconds time) { deadline_ = Clock::now() + time; }
  void allow_any_time() { deadline_ = Clock::time_point::max(); }
  bool is_late() const { return deadline_.load() < Clock::now(); }

  void read();
  /// Some clients send an empty line behind a body (RFC 9112, section 2.2).
  void skip_empty_lines();
  void await_first_byte();
  void read_request();
  /// Takes all of the request except its body. Fields that a client sends behind a chunked body
  /// (RFC 9110, section 6.5) are therefore never treated as headers: a proxy in front of the server
  /// has not inspected them.
  void take_header();
  void forget_header();
  /// Why the request is refused whatever its body is, if it is.
  std::optional<Problem> problem_of_header() const;
  /// Answers without reading any further.
  void refuse_unread(const Problem& problem);
  /// Answers a client that waits for permission to send its body (RFC 9110, section 10.1.1).
  void ask_for_body();
  void read_body();
  /// Maximum body length of the request whose header was read.
  std::uint64_t body_limit() const;
  /// False if the body is long and there are too many long ones; the request is answered in that
  /// case.
  bool has_room_for_body();
  void leave_room();
  void on_read(const ErrorCode& error);
  void answer_unreadable(const ErrorCode& error);
  /// Whether the request line exceeded the limit, not the fields after it.
  bool is_request_line_too_long() const;
  Problem target_too_long() const;
  Problem header_too_long() const;
  void handle(std::string body);
  ClientAddress client_of(const http::request<http::string_body>& message) const;
  /// Watches for the client to disconnect until the response is sent.
  void watch_for_disconnection();
  void on_readable_while_watching();
  void stop_watching();
  /// Sends a response that does not come from the handler.
  void send_own(HttpResponse response);
  void send(HttpResponse response);
  void write();
  void on_written(const ErrorCode& error);
  void close_gently();
  void discard_input();
  void tell(const HttpResponse& response) const;

  State& state_;
  const ClientAddress peer_;
  const bool is_trusted_;
  Socket socket_;
  std::atomic<Clock::time_point> deadline_{Clock::time_point::max()};
  beast::flat_buffer buffer_{kMaxBuffer};
  std::optional<http::request_parser<http::string_body>> parser_;
  Timer half_closed_timer_;
  bool is_watching_ = false;
  bool is_reading_ = false;  // and no request has begun, if the buffer is empty

  // The request being answered.
  HttpRequest request_;
  std::string referer_;
  std::string user_agent_;
  Clock::time_point begin_;
  unsigned version_ = 11;
  bool keep_alive_ = false;
  bool is_answered_ = false;
  bool has_room_ = false;  // for a long body, see State::take_room()

  // The response being sent.
  std::string head_;
  std::shared_ptr<const std::string> body_;  // null: none

  std::array<char, 4096> discarded_{};
  std::size_t discarded_bytes_ = 0;
};

void HttpServer::Connection::start() {
  state_.enter(*this);
  net::dispatch(socket_.get_executor(), [self = shared_from_this()] { self->read(); });
}

void HttpServer::Connection::refuse(const Problem& problem) {
  state_.enter(*this);
  net::dispatch(socket_.get_executor(), [self = shared_from_this(), problem] {
    self->request_.client = self->peer_;
    self->begin_ = Clock::now();
    self->send_own(problem_response(problem, kRefusalPause));
  });
}

void HttpServer::Connection::drain() {
  net::post(socket_.get_executor(), [self = shared_from_this()] {
    const bool is_idle =
        self->is_reading_ && self->buffer_.size() == 0 && !self->parser_->got_some();
    ErrorCode ignored;  // may be closed already
    if (is_idle) self->socket_.close(ignored);
  });
}

void HttpServer::Connection::end_if_late() {
  if (!is_late()) return;
  net::post(socket_.get_executor(), [self = shared_from_this()] {
    ErrorCode ignored;  // may be closed already
    if (self->is_late()) self->socket_.close(ignored);
  });
}

void HttpServer::Connection::skip_empty_lines() {
  static constexpr std::string_view kEmptyLine = "\r\n";
  const auto begins_with_one = [this] {
    const auto bytes = buffer_.data();
    return std::string_view(static_cast<const char*>(bytes.data()), bytes.size())
        .starts_with(kEmptyLine);
  };
  while (begins_with_one()) buffer_.consume(kEmptyLine.size());
}

void HttpServer::Connection::read() {
  skip_empty_lines();
  if (state_.is_draining() && buffer_.size() == 0) return close_gently();
  parser_.emplace();
  parser_->header_limit(state_.options().header_limit);
  // For any request, until its path is known.
  parser_->body_limit(std::max(state_.options().body_limit, state_.options().long_body_limit));
  is_reading_ = true;
  if (buffer_.size() > 0) return read_request();
  await_first_byte();
}

void HttpServer::Connection::await_first_byte() {
  allow(state_.options().idle_timeout);
  socket_.async_read_some(buffer_.prepare(kFirstRead),
                          [self = shared_from_this()](const ErrorCode& error, std::size_t bytes) {
                            self->buffer_.commit(bytes);
                            self->skip_empty_lines();
                            if (!error && self->buffer_.size() == 0)
                              return self->await_first_byte();
                            if (!error) return self->read_request();
                            self->is_reading_ = false;
                            if (error == net::error::eof) self->close_gently();
                          });
}

// The timeout counts from the first byte, however slowly the rest arrives.
void HttpServer::Connection::read_request() {
  allow(state_.options().read_timeout);
  const auto on_header = [this](const ErrorCode& error) {
    if (error) return on_read(error);
    take_header();
    if (const auto problem = problem_of_header()) return refuse_unread(*problem);
    if (parser_->is_done()) return on_read({});
    ask_for_body();
  };
  ErrorCode error;
  buffer_.consume(parser_->put(buffer_.data(), error));
  if (error != http::error::need_more) return on_header(error);
  http::async_read_header(socket_, buffer_, *parser_,
                          [self = shared_from_this(), on_header](
                              const ErrorCode& failure, std::size_t) { on_header(failure); });
}

std::uint64_t HttpServer::Connection::body_limit() const {
  const HttpServerOptions& options = state_.options();
  const auto& header = parser_->get();
  const auto target = split_target(view_of(header.target()));
  const bool is_long = !options.long_body_path.empty() && header.method() == http::verb::post &&
                       target && target->path == options.long_body_path;
  return is_long ? options.long_body_limit : options.body_limit;
}

bool HttpServer::Connection::has_room_for_body() {
  const std::uint64_t usual = state_.options().body_limit;
  const auto length = parser_->content_length();  // none: chunked
  if (body_limit() <= usual || (length && *length <= usual)) return true;
  has_room_ = state_.take_room(peer_, is_trusted_);
  if (has_room_) return true;
  refuse_unread({503, "Too many large bodies are being posted. Try again."});
  return false;
}

void HttpServer::Connection::refuse_unread(const Problem& problem) {
  is_reading_ = false;
  begin_ = Clock::now();
  keep_alive_ = false;
  send_own(problem_response(problem));
}

void HttpServer::Connection::leave_room() {
  if (std::exchange(has_room_, false)) state_.leave_room(peer_);
}

void HttpServer::Connection::ask_for_body() {
  const auto& header = parser_->get();
  const auto length = parser_->content_length();
  if (length && *length > body_limit()) return on_read(http::error::body_limit);
  parser_->body_limit(body_limit());
  if (!has_room_for_body()) return;
  const bool is_expected = header.version() >= 11 && buffer_.size() == 0 &&
                           beast::iequals(header[http::field::expect], "100-continue");
  if (!is_expected) return read_body();
  static constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
  net::async_write(socket_, net::buffer(kContinue),
                   [self = shared_from_this()](const ErrorCode& error, std::size_t) {
                     if (error) return self->on_read(error);
                     self->read_body();
                   });
}

void HttpServer::Connection::read_body() {
  http::async_read(
      socket_, buffer_, *parser_,
      [self = shared_from_this()](const ErrorCode& error, std::size_t) { self->on_read(error); });
}

void HttpServer::Connection::on_read(const ErrorCode& error) {
  is_reading_ = false;
  begin_ = Clock::now();
  allow_any_time();
  is_answered_ = false;
  if (error) return answer_unreadable(error);
  handle(std::move(parser_->get().body()));
}

void HttpServer::Connection::answer_unreadable(const ErrorCode& error) {
  if (!parser_->is_header_done()) forget_header();
  keep_alive_ = false;
  if (error == http::error::end_of_stream) return close_gently();
  if (error == http::error::partial_message || !is_http_error(error)) return;  // nobody listens
  Problem problem{400, "The request is not well formed HTTP/1.1: " + error.message() + "."};
  if (error == http::error::body_limit) {
    problem = {413, fmt::format("The body of a request can have at most {} bytes.", body_limit())};
  } else if (error == http::error::header_limit || error == http::error::buffer_overflow) {
    problem = header_too_long();
  }
  send_own(problem_response(problem));
}

bool HttpServer::Connection::is_request_line_too_long() const {
  // The parser knows the target only after it has seen the end of the request line.
  const auto target = parser_->get().target();
  return target.empty() || target.size() > state_.options().target_limit;
}

Problem HttpServer::Connection::target_too_long() const {
  return {414,
          fmt::format("Path and query can have at most {} bytes.", state_.options().target_limit)};
}

Problem HttpServer::Connection::header_too_long() const {
  if (is_request_line_too_long()) return target_too_long();
  return {431, fmt::format("Request line and headers can have at most {} bytes.",
                           state_.options().header_limit)};
}

void HttpServer::Connection::take_header() {
  const http::request<http::string_body>& message = parser_->get();
  const auto text = [&message](http::field name) { return std::string(view_of(message[name])); };
  request_ = {std::string(view_of(message.method_string())),
              std::string(view_of(message.target())),
              text(http::field::host),
              list_of(message, "If-None-Match"),
              {},
              client_of(message),
              std::make_shared<Disconnection>(),
              list_of(message, "Accept-Encoding"),
              text(http::field::content_type),
              text(http::field::content_encoding)};
  request_.is_of_proxy = is_trusted_ && request_.client == peer_;
  // The host of an absolute target replaces that of the header (RFC 9112, section 3.2.2).
  const auto target = split_target(request_.target);
  if (target && !target->host.empty()) request_.host = target->host;
  referer_ = text(http::field::referer);
  user_agent_ = text(http::field::user_agent);
  version_ = message.version();
  keep_alive_ = is_kept_alive(message);
}

void HttpServer::Connection::forget_header() {
  request_ = {};
  request_.client = peer_;
  referer_.clear();
  user_agent_.clear();
}

std::optional<Problem> HttpServer::Connection::problem_of_header() const {
  const http::request<http::string_body>& message = parser_->get();
  // The parser applies the limit to single fields only.
  if (header_bytes(message) > state_.options().header_limit) return header_too_long();
  if (version_ >= 11 && message.count(http::field::host) != 1) {
    return Problem{400, "A request needs exactly one Host header."};
  }
  if (message.count(http::field::transfer_encoding) == 0) return std::nullopt;
  // A proxy in front of this server could disagree about where the body ends, and part of the body
  // could be taken for a request (RFC 9112, sections 6.1 and 6.3).
  if (version_ < 11) return Problem{400, "HTTP/1.0 has no Transfer-Encoding."};
  if (beast::iequals(list_of(message, "Transfer-Encoding"), "chunked")) return std::nullopt;
  return Problem{501, "The only supported Transfer-Encoding is chunked."};
}

void HttpServer::Connection::handle(std::string body) {
  request_.body = std::move(body);
  if (request_.target.size() > state_.options().target_limit) {
    return send_own(problem_response(target_too_long()));
  }
  // The pair releases the connection before the state that the connection refers to.
  auto held = std::pair(state_.shared_from_this(), shared_from_this());
  // Request boundary: an error in one request must not end the server.
  try {
    state_.handler()(request_, [held = std::move(held)](HttpResponse response) {
      Connection& connection = *held.second;
      net::dispatch(connection.socket_.get_executor(),
                    [self = held.second, response = std::move(response)]() mutable {
                      self->send(std::move(response));
                    });
    });
  } catch (const std::exception& error) {
    spdlog::error(fmt::format("{} {}: {}", request_.method, request_.target, error.what()));
    send_own(problem_response({500, "The request could not be answered."}));
    return;
  }
  if (!is_answered_ && request_.disconnection->is_awaited()) watch_for_disconnection();
}

void HttpServer::Connection::watch_for_disconnection() {
  is_watching_ = true;
  socket_.async_wait(Socket::wait_read, [self = shared_from_this()](const ErrorCode& error) {
    if (!error && self->is_watching_) self->on_readable_while_watching();
  });
}

void HttpServer::Connection::on_readable_while_watching() {
  char byte = 0;
  const auto received = ::recv(socket_.native_handle(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  if (received > 0) return;  // the next request, which hides everything after it
  if (received < 0) {
    if (errno == EAGAIN || errno == EINTR) return watch_for_disconnection();
    return request_.disconnection->happen();
  }
  half_closed_timer_.expires_after(kHalfClosedTime);
  half_closed_timer_.async_wait([self = shared_from_this()](const ErrorCode& error) {
    if (!error && self->is_watching_) self->request_.disconnection->happen();
  });
}

void HttpServer::Connection::stop_watching() {
  if (!is_watching_) return;
  is_watching_ = false;
  half_closed_timer_.cancel();
  ErrorCode ignored;  // on error, there is nothing to cancel
  socket_.cancel(ignored);
}

ClientAddress HttpServer::Connection::client_of(
    const http::request<http::string_body>& message) const {
  if (!is_trusted_) return peer_;
  return client_behind(peer_, list_of(message, "X-Forwarded-For"),
                       state_.options().trusted_proxies);
}

void HttpServer::Connection::send_own(HttpResponse response) {
  if (state_.options().is_for_every_origin) allow_every_origin(response);
  send(std::move(response));
}

void HttpServer::Connection::send(HttpResponse response) {
  is_answered_ = true;
  stop_watching();
  tell(response);
  request_.body = {};  // it may be long, and the next request may take a while to arrive
  leave_room();
  keep_alive_ = keep_alive_ && !state_.is_draining();
  head_.clear();
  append_response_head(response, version_, keep_alive_, head_);
  body_ = request_.method == "HEAD" ? nullptr : std::move(response.body);
  allow(state_.options().write_timeout);
  write();
}

// Most responses fit into the socket's send buffer and are written immediately.
void HttpServer::Connection::write() {
  using Parts = std::array<net::const_buffer, 2>;
  const Parts parts{net::buffer(head_), body_ == nullptr ? net::const_buffer()
                                                         : net::const_buffer(net::buffer(*body_))};
  ErrorCode error;
  const std::size_t sent = socket_.write_some(parts, error);
  if (error && error != net::error::would_block) return on_written(error);
  beast::buffers_suffix<Parts> rest(parts);
  rest.consume(sent);
  if (beast::buffer_bytes(rest) == 0) return on_written({});
  net::async_write(socket_, rest,
                   [self = shared_from_this()](const ErrorCode& failure, std::size_t) {
                     self->on_written(failure);
                   });
}

void HttpServer::Connection::on_written(const ErrorCode& error) {
  body_ = nullptr;
  if (error) return;  // the client has disconnected
  if (!keep_alive_) return close_gently();
  if (buffer_.size() == 0) return read();
  // Posted, so that the stack does not grow however many requests a client sends.
  net::post(socket_.get_executor(), [self = shared_from_this()] { self->read(); });
}

void HttpServer::Connection::close_gently() {
  ErrorCode ignored;  // may be closed already
  socket_.shutdown(Socket::shutdown_send, ignored);
  allow(kLingerTime);
  discard_input();
}

void HttpServer::Connection::discard_input() {
  socket_.async_read_some(net::buffer(discarded_),
                          [self = shared_from_this()](const ErrorCode& error, std::size_t bytes) {
                            self->discarded_bytes_ += bytes;
                            if (!error && self->discarded_bytes_ < kMaxLingerBytes)
                              self->discard_input();
                          });
}

void HttpServer::Connection::tell(const HttpResponse& response) const {
  if (!state_.observer()) return;
  state_.observer()({request_, response, Clock::now() - begin_, version_, referer_, user_agent_});
}

HttpServer::State::State(const HttpServerOptions& options, Handler handler, Observer observer)
    : options_(options),
      handler_(std::move(handler)),
      observer_(std::move(observer)),
      io_threads_(make_io_threads(options.threads)),
      control_(io_threads_.front()->io.get_executor()),
      acceptor_(control_),
      accept_timer_(control_),
      round_(round_for(options)),
      round_timer_(control_),
      drain_timer_(control_),
      signals_(control_),
      hangups_(control_) {
  open();
}

std::vector<std::unique_ptr<HttpServer::State::IoThread>> HttpServer::State::make_io_threads(
    unsigned count) {
  std::vector<std::unique_ptr<IoThread>> threads(std::max(count, 1u));
  for (auto& thread : threads) thread = std::make_unique<IoThread>();
  return threads;
}

void HttpServer::State::open() {
  const tcp::endpoint endpoint = endpoint_of(options_);
  try {
    acceptor_.open(endpoint.protocol());
    acceptor_.set_option(net::socket_base::reuse_address(true));
    acceptor_.bind(endpoint);
    acceptor_.listen();
    port_ = acceptor_.local_endpoint().port();
  } catch (const boost::system::system_error& error) {
    const std::string port = options_.port == 0 ? "" : fmt::format(" port {}", options_.port);
    throw std::runtime_error(
        fmt::format("cannot listen on {}{}: {}", options_.address, port, error.code().message()));
  }
}

void HttpServer::State::run() {
  net::post(control_, [this] { accept(); });
  std::vector<std::thread> threads;
  try {
    for (std::size_t i = 1; i < io_threads_.size(); ++i) {
      threads.emplace_back([&io = io_threads_[i]->io] { run_handlers(io); });
    }
  } catch (const std::system_error&) {
    stop_threads();
    for (std::thread& thread : threads) thread.join();
    throw;
  }
  run_handlers(io_threads_.front()->io);
  for (std::thread& thread : threads) thread.join();
  const std::lock_guard lock(mutex_);
  has_run_ = true;
}

void HttpServer::State::accept() {
  if (is_draining_) return;
  net::io_context& io = io_threads_[next_thread_]->io;
  acceptor_.async_accept(
      io, [this](const ErrorCode& error, Socket socket) { on_accepted(error, std::move(socket)); });
}

void HttpServer::State::on_accepted(const ErrorCode& error, Socket socket) {
  if (is_draining_) return;
  if (!error) {
    next_thread_ = (next_thread_ + 1) % io_threads_.size();
    // If memory runs out, the connection is closed, and others are accepted nevertheless.
    try {
      admit(std::move(socket));
    } catch (const std::exception& failure) {
      log_failure("a connection is closed", failure);
    }
    begin_rounds();
    return accept();
  }
  // Most likely the file descriptors are exhausted: retrying immediately would only waste time.
  warn_of_refusal(error);
  accept_timer_.expires_after(kAcceptPause);
  accept_timer_.async_wait([this](const ErrorCode& cancelled) {
    if (!cancelled) accept();
  });
}

/// Logs at most once a second, however often it is retried.
void HttpServer::State::warn_of_refusal(const ErrorCode& error) {
  const auto now = Clock::now();
  if (now < next_warning_) return;
  next_warning_ = now + kWarningPause;
  spdlog::warn(fmt::format("cannot accept a connection: {}", error.message()));
}

void HttpServer::State::begin_rounds() {
  if (has_rounds_) return;
  has_rounds_ = true;
  make_round();
}

void HttpServer::State::make_round() {
  // If memory runs out, the next round checks again.
  try {
    const auto connections = alive_connections();
    has_rounds_ = !connections.empty();
    for (const auto& connection : connections) connection->end_if_late();
  } catch (const std::bad_alloc&) {
    has_rounds_ = true;
  }
  if (!has_rounds_) return;
  round_timer_.expires_after(round_);
  round_timer_.async_wait([this](const ErrorCode& cancelled) {
    if (!cancelled) make_round();
  });
}

std::vector<std::shared_ptr<HttpServer::Connection>> HttpServer::State::alive_connections() const {
  std::vector<std::shared_ptr<Connection>> connections;
  const std::lock_guard lock(mutex_);
  connections.reserve(connections_.size());  // otherwise one could be destroyed under the lock
  for (Connection* connection : connections_) {
    if (auto alive = connection->weak_from_this().lock()) connections.push_back(std::move(alive));
  }
  return connections;
}

void HttpServer::State::admit(Socket socket) {
  ErrorCode error;
  const auto remote = socket.remote_endpoint(error);
  if (error) return;  // closed already
  const ClientAddress peer = client_address(remote.address());
  const auto [count, count_of_peer] = [this, &peer] {
    const std::lock_guard lock(mutex_);
    const auto found = connections_of_.find(limited_address(peer));
    return std::pair(connections_.size(), found == connections_of_.end() ? 0 : found->second);
  }();
  const bool is_full = count >= options_.max_connections;
  const bool is_greedy = count_of_peer >= options_.max_connections_per_address && !is_trusted(peer);
  if (is_full || is_greedy) ++refusals_;
  if (count >= options_.max_connections + kMaxRefusals) return;
  if (is_greedy && count_of_peer >= options_.max_connections_per_address + kMaxRefusals) return;
  socket.set_option(tcp::no_delay(true), error);  // only for speed; failure is harmless
  socket.non_blocking(true, error);
  if (error) return;
  auto connection = std::make_shared<Connection>(*this, std::move(socket), peer);
  if (is_full) {
    connection->refuse({503, "There are too many connections. Try again."});
  } else if (is_greedy) {
    connection->refuse({429, "There are too many connections from your address. Try again."});
  } else {
    connection->start();
  }
}

bool HttpServer::State::is_trusted(const ClientAddress& peer) const {
  return std::ranges::any_of(options_.trusted_proxies,
                             [&peer](const AddressRange& range) { return range.contains(peer); });
}

std::size_t HttpServer::State::connections() const {
  const std::lock_guard lock(mutex_);
  return connections_.size();
}

bool HttpServer::State::take_room(const ClientAddress& client, bool is_trusted) {
  const std::lock_guard lock(mutex_);
  const ClientAddress address = limited_address(client);
  if (long_bodies_ == kMostLongBodies) return false;
  std::size_t& of_client = long_bodies_of_[address];
  if (of_client == kMostLongBodiesOfOne && !is_trusted) return false;
  ++of_client;
  ++long_bodies_;
  return true;
}

void HttpServer::State::leave_room(const ClientAddress& client) {
  const std::lock_guard lock(mutex_);
  const auto of_client = long_bodies_of_.find(limited_address(client));
  if (--of_client->second == 0) long_bodies_of_.erase(of_client);
  --long_bodies_;
}

void HttpServer::State::enter(Connection& connection) {
  const std::lock_guard lock(mutex_);
  if (connections_.insert(&connection).second)
    ++connections_of_[limited_address(connection.peer())];
}

void HttpServer::State::leave(Connection& connection) {
  const std::lock_guard lock(mutex_);
  if (connections_.erase(&connection) > 0) {
    const auto found = connections_of_.find(limited_address(connection.peer()));
    if (--found->second == 0) connections_of_.erase(found);
  }
  if (is_draining_ && connections_.empty() && !has_run_) {
    net::post(control_, [this] { finish(); });
  }
}

void HttpServer::State::stop() {
  net::post(control_, [this] {
    if (is_draining_) return stop_threads();
    if (is_leaving_ || options_.drain_delay.count() == 0) {
      is_leaving_ = true;
      return begin_draining();
    }
    is_leaving_ = true;
    drain_timer_.expires_after(options_.drain_delay);
    drain_timer_.async_wait([this](const ErrorCode& cancelled) {
      if (!cancelled) begin_draining();
    });
  });
}

void HttpServer::State::begin_draining() {
  {
    const std::lock_guard lock(mutex_);
    is_draining_ = true;
    if (connections_.empty()) net::post(control_, [this] { finish(); });
  }
  ErrorCode ignored;  // closing cannot fail in a way that matters now
  acceptor_.close(ignored);
  accept_timer_.cancel();
  for (const auto& connection : alive_connections()) connection->drain();
  drain_timer_.expires_after(options_.drain_timeout);
  drain_timer_.async_wait([this](const ErrorCode& cancelled) {
    if (cancelled) return;
    spdlog::warn("some requests did not finish in time and are abandoned");
    stop_threads();
  });
}

void HttpServer::State::finish() {
  drain_timer_.cancel();
  signals_.cancel();
  hangups_.cancel();
  round_timer_.cancel();
  for (const auto& thread : io_threads_) thread->work.reset();
}

void HttpServer::State::stop_threads() {
  for (const auto& thread : io_threads_) thread->io.stop();
}

void HttpServer::State::stop_on_signals() {
  signals_.add(SIGINT);
  signals_.add(SIGTERM);
  wait_for_signal();
}

void HttpServer::State::wait_for_signal() {
  signals_.async_wait([this](const ErrorCode& error, int signal) {
    if (error) return;
    wait_for_signal();  // first: memory may run out below, and the next signal tries again
    spdlog::info(fmt::format("{}: {}", signal == SIGINT ? "SIGINT" : "SIGTERM",
                             is_draining_ ? "stopping at once" : "finishing requests in progress"));
    stop();
  });
}

void HttpServer::State::act_on_hangup(std::function<void()> act) {
  on_hangup_ = std::move(act);
  hangups_.add(SIGHUP);
  wait_for_hangup();
}

void HttpServer::State::wait_for_hangup() {
  hangups_.async_wait([this](const ErrorCode& error, int) {
    if (error) return;
    wait_for_hangup();
    on_hangup_();
  });
}

std::string find_port_problem(const std::string& address, std::uint16_t port) {
  ErrorCode error;
  const tcp::endpoint endpoint(net::ip::make_address(address, error), port);
  if (error) return {};  // the address is the problem
  net::io_context io;
  tcp::acceptor acceptor(io);
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.bind(endpoint, error);
  return error == net::error::access_denied
             ? fmt::format("cannot listen on {} port {}: {}", address, port, error.message())
             : std::string();
}

HttpServer::HttpServer(const HttpServerOptions& options, Handler handler, Observer observer)
    : state_(std::make_shared<State>(options, std::move(handler), std::move(observer))) {}

HttpServer::~HttpServer() = default;

std::uint16_t HttpServer::port() const {
  return state_->port();
}

std::size_t HttpServer::connections() const {
  return state_->connections();
}

std::uint64_t HttpServer::refusals() const {
  return state_->refusals();
}

bool HttpServer::is_stopping() const {
  return state_->is_stopping();
}

void HttpServer::run() {
  state_->run();
}

void HttpServer::stop() {
  state_->stop();
}

void HttpServer::stop_on_signals() {
  state_->stop_on_signals();
}

void HttpServer::act_on_hangup(std::function<void()> act) {
  state_->act_on_hangup(std::move(act));
}

}  // namespace trapeze
