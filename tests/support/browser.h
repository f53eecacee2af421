/// @file browser.h  A headless Chromium driven through a pair of pipes (DevTools protocol): pages are opened, clicked
/// and asked as a user and a script would, without a network. What the page complains of is kept.
#pragma once
#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>
#include <chrono>
#include <thread>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/files/json_writer.h"

namespace epafi::support {

inline std::string find_browser() {
  for (const char* name : {"/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"})
    if (std::filesystem::exists(name)) return name;
  return "";
}

class Browser {
 public:
  Browser(int width, int height) {
    int to[2], from[2];
    if (::pipe2(to, O_CLOEXEC) != 0 || ::pipe2(from, O_CLOEXEC) != 0) throw std::runtime_error("no pipes");
    process_ = ::fork();
    if (process_ == 0) become_browser(to[0], from[1], width, height);
    ::close(to[0]);
    ::close(from[1]);
    to_ = to[1];
    from_ = from[0];
    const FlatJson target = call("Target.createTarget", R"({"url":"about:blank"})");
    const FlatJson attached = call("Target.attachToTarget",
                                   R"({"flatten":true,"targetId":)" + json_text(target.text("result.targetId")) + "}");
    session_ = attached.text("result.sessionId");
    for (const char* domain : {"Runtime.enable", "Log.enable", "Page.enable"}) call(domain, "{}");
  }
  ~Browser() {
    ::close(to_);
    ::close(from_);
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
    // its helpers write into the profile until they have ended too
    ::kill(-process_, SIGKILL);
    for (int k = 0; k < 500 && ::kill(-process_, 0) == 0; ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::error_code trouble;
    for (int k = 0; k < 100; ++k) {
      std::filesystem::remove_all(profile_ / "profile", trouble);
      if (!trouble) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  void go(const std::string& address) { call("Page.navigate", "{\"url\":" + json_text(address) + "}"); }
  /// Runs in each page that is opened from now on, before its own scripts.
  void before_pages(const std::string& script) {
    call("Page.addScriptToEvaluateOnNewDocument", "{\"source\":" + json_text(script) + "}");
  }
  /// Opens a page and waits until it says that its first picture stands.
  bool open(const std::string& address) {
    go(address);
    return wait_for("document.body && document.body.dataset.ready === 'true'");
  }
  /// Asks until the expression is true: 30 s at most.
  bool wait_for(const std::string& expression) {
    for (int k = 0; k < 600; ++k) {
      if (text("String(Boolean(" + expression + "))") == "true") return true;
      ::usleep(50000);
    }
    return false;
  }
  /// The value of an expression (or promise) that is a text.
  std::string text(const std::string& expression) {
    return call("Runtime.evaluate",
                "{\"returnByValue\":true,\"awaitPromise\":true,\"expression\":" + json_text(expression) + "}")
        .text("result.result.value");
  }
  double number(const std::string& expression) {
    const std::string value = text("String(" + expression + ")");
    return value.empty() ? std::nan("") : std::strtod(value.c_str(), nullptr);
  }
  void click(double x, double y) {
    for (const char* kind : {"mousePressed", "mouseReleased"})
      call("Input.dispatchMouseEvent", "{\"type\":\"" + std::string(kind) + "\",\"x\":" + json_number(x) +
                                           ",\"y\":" + json_number(y) + ",\"button\":\"left\",\"clickCount\":1}");
  }
  /// The left button goes down at one place, is held over a few others and comes up at the last.
  void drag(double x0, double y0, double x1, double y1) {
    mouse("mousePressed", x0, y0);
    for (int k = 1; k <= 4; ++k) mouse("mouseMoved", x0 + 0.25 * k * (x1 - x0), y0 + 0.25 * k * (y1 - y0));
    mouse("mouseReleased", x1, y1);
  }
  /// Fingers at these places: "touchStart", "touchMove", or "touchEnd" with none.
  void touch(const std::string& kind, const std::vector<std::pair<double, double>>& fingers) {
    std::string points;
    for (std::size_t k = 0; k < fingers.size(); ++k)
      points += (k > 0 ? "," : "") + ("{\"x\":" + json_number(fingers[k].first)) +
                ",\"y\":" + json_number(fingers[k].second) + ",\"id\":" + std::to_string(k) + "}";
    call("Input.dispatchTouchEvent", "{\"type\":" + json_text(kind) + ",\"touchPoints\":[" + points + "]}");
  }
  /// The page's area, as that of a phone.
  void resize(int width, int height) {
    call("Emulation.setDeviceMetricsOverride", "{\"width\":" + std::to_string(width) +
                                                   ",\"height\":" + std::to_string(height) +
                                                   ",\"deviceScaleFactor\":1,\"mobile\":false}");
  }
  /// Fingers in place of a mouse, from the next page on.
  void take_touch() { call("Emulation.setTouchEmulationEnabled", "{\"enabled\":true,\"maxTouchPoints\":2}"); }
  void prefer(const std::string& scheme) {
    call("Emulation.setEmulatedMedia",
         "{\"features\":[{\"name\":\"prefers-color-scheme\",\"value\":" + json_text(scheme) + "}]}");
  }
  void press(const std::string& key) {
    for (const char* kind : {"keyDown", "keyUp"})
      call("Input.dispatchKeyEvent", "{\"type\":\"" + std::string(kind) + "\",\"key\":" + json_text(key) + "}");
  }
  /// Errors and warnings of the page's console, and exceptions.
  const std::vector<std::string>& complaints() const { return complaints_; }

 private:
  [[noreturn]] void become_browser(int in, int out, int width, int height) {
    const std::string browser = find_browser();
    ::setpgid(0, 0);
    const std::string profile = "--user-data-dir=" + (profile_ / "profile").string();
    const std::string size = "--window-size=" + std::to_string(width) + "," + std::to_string(height);
    ::dup2(in, 13);
    ::dup2(out, 14);
    ::dup2(13, 3);
    ::dup2(14, 4);
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, 2);
    ::execl(browser.c_str(), browser.c_str(), "--headless=new", "--no-sandbox", "--remote-debugging-pipe",
            "--hide-scrollbars", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run",
            "--disable-extensions", "--disable-background-networking",
            "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1", "--force-device-scale-factor=1",
            profile.c_str(), size.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
  }

  void mouse(const char* kind, double x, double y) {
    call("Input.dispatchMouseEvent", "{\"type\":\"" + std::string(kind) + "\",\"x\":" + json_number(x) + ",\"y\":" +
                                         json_number(y) + ",\"button\":\"left\",\"buttons\":1,\"clickCount\":1}");
  }

  FlatJson call(const std::string& method, const std::string& parameters) {
    const int id = ++last_;
    std::string message = "{\"id\":" + std::to_string(id) + ",\"method\":\"" + method + "\",\"params\":" + parameters;
    if (!session_.empty()) message += ",\"sessionId\":" + json_text(session_);
    message += "}";
    message += '\0';
    for (std::size_t sent = 0; sent < message.size();) {
      const ssize_t now = ::write(to_, message.data() + sent, message.size() - sent);
      if (now <= 0) throw std::runtime_error("the browser has gone");
      sent += static_cast<std::size_t>(now);
    }
    for (;;) {
      const FlatJson answer = flat_json(next_message());
      if (answer.number("id") == id) return answer;
      keep_complaint(answer);
    }
  }

  void keep_complaint(const FlatJson& event) {
    const std::string method = event.text("method");
    if (method == "Runtime.exceptionThrown")
      complaints_.push_back(event.text("params.exceptionDetails.text") + " " +
                            event.text("params.exceptionDetails.exception.description"));
    const std::string type = event.text("params.type"), level = event.text("params.entry.level");
    if (method == "Runtime.consoleAPICalled" && (type == "error" || type == "warning"))
      complaints_.push_back(type + ": " + event.text("params.args.0.value"));
    if (method == "Log.entryAdded" && level == "error")
      complaints_.push_back(level + ": " + event.text("params.entry.text"));
  }

  std::string next_message() {
    for (;;) {
      const std::size_t end = received_.find('\0');
      if (end != received_.npos) {
        std::string message = received_.substr(0, end);
        received_.erase(0, end + 1);
        return message;
      }
      pollfd one{from_, POLLIN, 0};
      char piece[65536];
      const ssize_t got = ::poll(&one, 1, 60000) > 0 ? ::read(from_, piece, sizeof piece) : -1;
      if (got <= 0) throw std::runtime_error("the browser does not answer");
      received_.append(piece, static_cast<std::size_t>(got));
    }
  }

  TemporaryFolder profile_;
  int process_ = -1, to_ = -1, from_ = -1, last_ = 0;
  std::string session_, received_;
  std::vector<std::string> complaints_;
};

}  // namespace epafi::support
