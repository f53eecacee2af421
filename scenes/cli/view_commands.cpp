#include "scenes/cli/view_commands.h"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "scenes/about.h"
#include "scenes/cli/commands.h"
#include "scenes/cli/library.h"
#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/stop.h"
#include "viz_export/view/page.h"
#include "viz_export/view/render_run.h"
#include "viz_export/view/server.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

void print_line(const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); }

void print_view_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) print_line("epafi: note: " + note);
}

void print_view_warnings(const ViewSource& source) {
  for (const std::string& warning : source.warnings()) print_line("epafi: warning: " + warning);
}

/// The first state of a scene. The assembly and its surfaces stay as long as the source.
class FirstState {
 public:
  FirstState(const std::string& path, const std::vector<std::string>& overrides) {
    ReadResult read = read_scene(path, overrides, full_registry());
    if (!read.scene) throw SceneError(read.problems);
    assembly_ = assemble(std::move(*read.scene));
    surfaces_ = std::make_unique<SurfaceCache>(*assembly_->shapes);
  }
  std::unique_ptr<ViewSource> source() {
    const World& world = assembly_->simulation->world;
    ViewFrame frame{world.time, world.rotates(), world.has_orientation(), body_records(world, *surfaces_), {}};
    return still_source(assembly_->scene.title, about_of(*assembly_), std::move(frame));
  }

 private:
  std::unique_ptr<Assembly> assembly_;
  std::unique_ptr<SurfaceCache> surfaces_;
};

/// Where there is a screen and a program that opens addresses.
void open_browser(const std::string& address) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  const pid_t child = fork();
  if (child != 0) return;
  std::freopen("/dev/null", "w", stderr);
  execlp("xdg-open", "xdg-open", address.c_str(), static_cast<char*>(nullptr));
  _exit(1);
}

int write_file(const ViewSource& source, const std::string& target) {
  const WrittenPage page = write_page(source, target);
  print_view_notes(page.notes);
  print_view_warnings(source);
  print_line(
      fmt::format("{}: {} frames, {:.1f} MB", target, source.times().size(), 1e-6 * static_cast<double>(page.bytes)));
  return exit_done;
}

/// A file that is no scene is no scene with mistakes: the message then is what the command takes.
void refuse_no_scene(const fs::path& file) {
  const std::string takes = "`epafi view` takes the output folder of a run, or a scene file (TOML)";
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (looks_like_scene(file)) return;
  if (fs::exists(folder / "run.h5"))
    throw SceneError("'" + file.string() + "' is a file of a run; `epafi view " + folder.string() + "` shows the run");
  throw SceneError("'" + file.string() + "' is no scene; " + takes);
}

/// "1280x720"
void set_size(const std::string& text, RenderOptions& options) {
  const std::size_t cross = text.find('x');
  const auto number = [&](std::size_t begin, std::size_t end, int& out) {
    const auto result = std::from_chars(text.data() + begin, text.data() + end, out);
    return result.ec == std::errc() && result.ptr == text.data() + end && out >= 16 && out <= 16384;
  };
  if (cross != text.npos && number(0, cross, options.width) && number(cross + 1, text.size(), options.height)) return;
  throw SceneError("--size " + text + ": expected WIDTHxHEIGHT in pixels, 16 to 16384 each, as 1280x720");
}

std::size_t nearest_frame(const std::vector<double>& times, double wanted) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < times.size(); ++k)
    if (std::abs(times[k] - wanted) < std::abs(times[best] - wanted)) best = k;
  return best;
}

/// Of a film of one frame.
std::string why_one(const ViewSource& source, const RenderRequest& request) {
  const std::size_t frames = source.times().size();
  if (frames == 1) return ", as the run has no more";
  return fmt::format(" of {}, as --every {} leaves out the others", frames, request.every.value_or(1));
}

}  // namespace

int command_render(const RenderRequest& request) {
  const auto source = open_run(request.directory, "render");
  const std::vector<double>& times = source->times();
  if (times.empty()) throw FileError("the run in '" + request.directory + "' has no frame yet");
  RenderOptions options;
  options.camera = request.camera;
  options.field = request.field;
  options.contacts = request.contacts;
  set_size(request.size, options);
  const fs::path target = request.out.empty() ? fs::path(request.directory) / "picture.png" : fs::path(request.out);
  const std::string ending = target.extension().string();
  const bool is_film = ending == ".mp4" || ending == ".webm";
  if (!is_film && ending != ".png")
    throw SceneError("--out " + target.string() + ": expected an ending .png, .mp4 or .webm");
  if (is_film && request.time) throw SceneError("--time is for a picture (.png), not for a film");
  if (!is_film && request.every) throw SceneError("--every is for a film (.mp4, .webm), not for a picture");
  if (is_film) {
    const auto [pictures, rate, notes] = render_film(*source, options, request.every.value_or(1), target);
    print_view_notes(notes);
    if (pictures == 1) print_line("epafi: note: the film stands still: it shows one frame" + why_one(*source, request));
    print_view_warnings(*source);
    print_line(fmt::format("{}: {} picture{}, {:.3g} s at {:.3g} per second", target.string(), pictures,
                           pictures > 1 ? "s" : "", static_cast<double>(pictures) / rate, rate));
    return exit_done;
  }
  const std::size_t frame = request.time ? nearest_frame(times, *request.time) : times.size() - 1;
  if (request.time && (*request.time < times.front() || *request.time > times.back()))
    print_line(fmt::format("epafi: note: the run has frames from {:.4g} to {:.4g} s", times.front(), times.back()));
  print_view_notes(render_picture(*source, options, frame, target));
  print_view_warnings(*source);
  print_line(fmt::format("{}: t = {} s", target.string(), time_text(times, times[frame])));
  return exit_done;
}

int command_view(const ViewOptions& options) {
  require_page_library();
  const bool is_run = fs::is_directory(options.what);
  const std::string file = is_run ? options.what : scene_file(options.what);
  if (is_run && !options.overrides.empty())
    throw SceneError("--set is for a scene file; '" + options.what + "' is a run");
  if (!fs::exists(file)) throw FileError("there is no run and no scene '" + options.what + "'");
  if (!is_run) refuse_no_scene(file);
  std::unique_ptr<FirstState> scene;
  if (!is_run) scene = std::make_unique<FirstState>(file, options.overrides);
  if (!options.out.empty()) return write_file(*(is_run ? open_run(options.what) : scene->source()), options.out);
  const std::unique_ptr<RunServer> run =
      is_run ? std::make_unique<RunServer>(fs::path(options.what)) : std::make_unique<RunServer>(scene->source());
  const SignalWatch signals;
  const LocalServer server(options.port);
  std::printf("%s\n", server.address().c_str());
  std::fflush(stdout);
  print_line("open this address in a browser of this machine; Ctrl-C ends");
  if (!options.no_browser) open_browser(server.address());
  server.serve([&](const std::string& path) { return run->answer(path); }, [] { return SignalWatch::received() != 0; });
  return exit_done;
}

}  // namespace epafi
