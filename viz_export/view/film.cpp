#include "viz_export/view/film.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <vector>

#include "engine/units/error.h"

namespace epafi {
namespace {

constexpr int not_installed = 127;

[[noreturn]] void become_ffmpeg(int from, const std::string& target, int width, int height, double rate) {
  dup2(from, STDIN_FILENO);
  const std::string size = fmt::format("{}x{}", width, height);
  const std::string in_thirds = fmt::format("{}/3", std::lround(3 * rate));  // exact, as ffmpeg wants it
  const bool webm = target.ends_with(".webm");
  const char* codec = webm ? "libvpx-vp9" : "libx264";
  const std::vector<const char*> words{"ffmpeg",
                                       "-y",
                                       "-loglevel",
                                       "error",
                                       "-f",
                                       "rawvideo",
                                       "-pix_fmt",
                                       "rgb24",
                                       "-s",
                                       size.c_str(),
                                       "-r",
                                       in_thirds.c_str(),
                                       "-i",
                                       "-",
                                       "-an",
                                       "-vf",
                                       "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                       "-c:v",
                                       codec,
                                       "-pix_fmt",
                                       "yuv420p",
                                       "-crf",
                                       webm ? "30" : "18",
                                       "--",
                                       target.c_str(),
                                       nullptr};
  std::vector<char*> arguments;
  for (const char* word : words) arguments.push_back(const_cast<char*>(word));
  execvp("ffmpeg", arguments.data());
  _exit(not_installed);
}

}  // namespace

Film::Film(std::filesystem::path target, int width, int height, double rate) : target_(std::move(target)) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw FileError("cannot make a pipe for ffmpeg");
  std::signal(SIGPIPE, SIG_IGN);  // a write then fails instead
  process_ = fork();
  if (process_ == 0) become_ffmpeg(ends[0], std::filesystem::absolute(target_).string(), width, height, rate);
  close(ends[0]);
  pipe_ = ends[1];
  if (process_ < 0) throw FileError("cannot start ffmpeg");
}

Film::~Film() {
  if (pipe_ >= 0) close(pipe_);
  if (process_ > 0) waitpid(process_, nullptr, 0);
}

void Film::add(const Image& image) {
  std::size_t written = 0;
  while (written < image.rgb.size()) {
    const ssize_t now = write(pipe_, image.rgb.data() + written, image.rgb.size() - written);
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) return finish();
    written += static_cast<std::size_t>(now);
  }
}

void Film::finish() {
  if (pipe_ < 0) return;
  close(pipe_);
  pipe_ = -1;
  int status = 0;
  waitpid(process_, &status, 0);
  process_ = -1;
  if (WIFEXITED(status) && WEXITSTATUS(status) == not_installed)
    throw FileError(
        "films are coded by ffmpeg, which is not installed: apt-get install ffmpeg; pictures need nothing: --out "
        "FILE.png");
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw FileError(target_.string() + ": ffmpeg could not write it");
}

}  // namespace epafi
