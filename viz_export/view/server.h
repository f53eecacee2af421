/// @file server.h  Gives the page and a run's data to the browsers of this machine: HTTP 1.1 on 127.0.0.1, GET only,
/// one answer per connection. Requests that name another host are refused, so that no page from elsewhere can read a
/// run.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "viz_export/view/view_source.h"

namespace epafi {

struct HttpAnswer {
  int status = 200;
  std::string type, body;
};

class LocalServer {
 public:
  /// port 0: any free one. Throws FileError where it is taken.
  explicit LocalServer(std::uint16_t port);
  ~LocalServer();
  LocalServer(const LocalServer&) = delete;
  LocalServer& operator=(const LocalServer&) = delete;
  std::uint16_t port() const { return port_; }
  std::string address() const;
  /// Answers until `stop` says so (asked four times a second). answer(path) may throw FileError: then 503 with its
  /// text.
  void serve(const std::function<HttpAnswer(const std::string& path)>& answer, const std::function<bool()>& stop) const;

 private:
  int socket_ = -1;
  std::uint16_t port_ = 0;
};

/// Answers the requests of the page: "/", "/mark" (changes with the run's files), "/manifest", "/bodies", "/chunk-N".
/// Reads the run again when its files have changed.
class RunServer {
 public:
  explicit RunServer(std::filesystem::path folder);
  explicit RunServer(std::unique_ptr<ViewSource> still);
  ~RunServer();
  HttpAnswer answer(const std::string& path);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace epafi
