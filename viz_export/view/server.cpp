#include "viz_export/view/server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "engine/units/error.h"

namespace epafi {
namespace {

constexpr std::size_t longest_request = 16384;
constexpr std::size_t most_waiting = 64;
constexpr int patience = 2000;  // ms for a piece of an answer to leave

bool waits_for(int socket, short what, int milliseconds) {
  pollfd one{socket, what, 0};
  return poll(&one, 1, milliseconds) > 0;
}

void send_all(int socket, const std::string& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size() && waits_for(socket, POLLOUT, patience)) {
    const ssize_t now = send(socket, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (now <= 0) return;
    sent += static_cast<std::size_t>(now);
  }
}

std::string header_of(const std::string& request, const std::string& name) {
  const std::size_t at = request.find("\r\n" + name + ": ");
  if (at == request.npos) return "";
  const std::size_t begin = at + name.size() + 4;
  return request.substr(begin, request.find("\r\n", begin) - begin);
}

const char* reason(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    default:
      return "Service Unavailable";
  }
}

HttpAnswer answer_to(const std::string& request, std::uint16_t port,
                     const std::function<HttpAnswer(const std::string&)>& answer) {
  const std::size_t first = request.find(' '), second = request.find(' ', first + 1);
  if (request.empty() || first == request.npos || second == request.npos) return {400, "text/plain", "no request"};
  if (request.compare(0, first, "GET") != 0) return {405, "text/plain", "GET only"};
  std::string host = header_of(request, "Host");
  if (host.empty()) host = header_of(request, "host");
  if (host != fmt::format("127.0.0.1:{}", port) && host != fmt::format("localhost:{}", port))
    return {403, "text/plain", "this server speaks to its own machine only"};
  std::string path = request.substr(first + 1, second - first - 1);
  path = path.substr(0, path.find('?'));
  try {
    return answer(path);
  } catch (const FileError& e) {  // a run may be read while it is written
    return {503, "text/plain", e.what()};
  }
}

void send_answer(int connection, const HttpAnswer& a) {
  send_all(connection,
           fmt::format("HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n"
                       "X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
                       a.status, reason(a.status), a.type, a.body.size()));
  send_all(connection, a.body);
  shutdown(connection, SHUT_WR);
}

/// Connections with an incomplete request. Browsers open some in advance: these may wait for any time without blocking
/// others.
class OpenConnections {
 public:
  ~OpenConnections() {
    for (const Connection& c : all_) close(c.socket);
  }

  /// Waits up to `milliseconds` for data at `listening` or from a connection.
  void wait(int listening, int milliseconds) {
    polled_.assign(1, {listening, POLLIN, 0});
    for (const Connection& c : all_) polled_.push_back({c.socket, POLLIN, 0});
    if (poll(polled_.data(), polled_.size(), milliseconds) <= 0) {
      for (pollfd& p : polled_) p.revents = 0;
    }
  }

  /// Calls whole(socket, request) for every request that is complete or too long, closes its connection, and
  /// accepts a new one at `listening`.
  template <class F>
  void read(int listening, const F& whole) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < all_.size(); ++i) {
      const bool spoke = polled_[i + 1].revents != 0, open = !spoke || receive(all_[i]);
      const bool complete = all_[i].text.find("\r\n\r\n") != std::string::npos;
      if (complete || all_[i].text.size() > longest_request) {
        whole(all_[i].socket, complete ? all_[i].text : "");
      } else if (open) {
        if (kept != i) all_[kept] = std::move(all_[i]);
        ++kept;
        continue;
      }
      close(all_[i].socket);
    }
    all_.resize(kept);
    if (polled_[0].revents != 0) accept_from(listening);
  }

 private:
  struct Connection {
    int socket = -1;
    std::string text;
  };

  /// false where the other side has closed.
  static bool receive(Connection& c) {
    char piece[2048];
    const ssize_t got = recv(c.socket, piece, sizeof piece, MSG_DONTWAIT);
    if (got > 0) c.text.append(piece, static_cast<std::size_t>(got));
    return got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR));
  }

  void accept_from(int listening) {
    const int connection = accept4(listening, nullptr, nullptr, SOCK_CLOEXEC);
    if (connection < 0) return;
    if (all_.size() >= most_waiting) {
      close(all_.front().socket);
      all_.erase(all_.begin());
    }
    all_.push_back({connection, ""});
  }

  std::vector<Connection> all_;
  std::vector<pollfd> polled_;
};

}  // namespace

LocalServer::LocalServer(std::uint16_t port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(port);
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int on = 1;
  setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  socklen_t size = sizeof place;
  const bool ready = socket_ >= 0 && bind(socket_, reinterpret_cast<const sockaddr*>(&place), size) == 0 &&
                     listen(socket_, 16) == 0 && getsockname(socket_, reinterpret_cast<sockaddr*>(&place), &size) == 0;
  if (!ready) {
    const std::string cause = std::strerror(errno);
    if (socket_ >= 0) close(socket_);
    throw FileError(
        fmt::format("cannot listen on 127.0.0.1:{}: {}; choose another with --port, 0 takes a free one", port, cause));
  }
  port_ = ntohs(place.sin_port);
}

LocalServer::~LocalServer() { close(socket_); }

std::string LocalServer::address() const { return fmt::format("http://127.0.0.1:{}/", port_); }

void LocalServer::serve(const std::function<HttpAnswer(const std::string&)>& answer,
                        const std::function<bool()>& stop) const {
  OpenConnections connections;
  while (!stop()) {
    connections.wait(socket_, 250);
    connections.read(socket_, [&](int connection, const std::string& request) {
      send_answer(connection, answer_to(request, port_, answer));
    });
  }
}

}  // namespace epafi
