// Pictures and films by the program: what ffmpeg coded is measured by ffprobe; residuals of contacts; springs.
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include "tests/support/catch.h"
#include "tests/support/document.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/view/render_run.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

constexpr const char* swinging = R"toml(
title = "Two boxes on each other, one on a spring"
[run]
duration = 0.2
time_step = 0.01
output_interval = 0.02
[world]
gravity = [0, 0, -9.81]
[material.wood]
density = 600.0
[contact]
method = "nonsmooth"
restitution = 0.0
friction = 0.5
[contact.nonsmooth]
solver = "pgs"
iterations = 2
[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "wood"
fixed = true
[[body]]
name = "box"
repeat = 3
shape = { box = { size = [0.2, 0.2, 0.1] } }
material = "wood"
position = [0, 0, "= 0.05 + 0.1*i"]
[[body]]
name = "hook"
shape = { sphere = { radius = 0.02 } }
material = "wood"
fixed = true
position = [0, 0, 1]
[[body]]
name = "bob"
shape = { sphere = { radius = 0.05 } }
material = "wood"
position = [0, 0, 0.6]
[[spring]]
body = "bob"
to = "hook"
stiffness = [100, 100, 100]
)toml";

int call_program(const std::string& arguments, const std::string& before = "") {
  const std::string command = before + std::string(EPAFI_BINARY_DIR) + "/bin/epafi " + arguments;
  return WEXITSTATUS(std::system((command + " > /dev/null").c_str()));
}

struct RenderedRun {
  TemporaryFolder folder;
  fs::path run = folder / "run";
  explicit RenderedRun(const std::string& more = "") {
    std::ofstream(folder / "scene.toml") << swinging;
    REQUIRE(call_program("run " + (folder / "scene.toml").string() + " -q -t 1 -o " + run.string() + " " + more) == 0);
  }
};

/// What ffprobe says of the film's stream: "width,height,rate,frames,duration".
std::vector<std::string> probed(const fs::path& film, const fs::path& said) {
  const std::string command =
      "ffprobe -v error -count_frames -select_streams v -show_entries stream=width,height,r_frame_rate,nb_read_frames"
      ":format=duration -of csv=p=0 " +
      film.string() + " > " + said.string();
  REQUIRE(std::system(command.c_str()) == 0);
  std::string text = support::read_text(said);
  for (char& c : text)
    if (c == '\n') c = ',';
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string word; std::getline(in, word, ',');) out.push_back(word);
  return out;
}

}  // namespace

TEST_CASE("a film has every picture, the size asked for and three seconds at least", "[scenes][view][long]") {
  if (std::system("command -v ffmpeg > /dev/null && command -v ffprobe > /dev/null") != 0) {
    WARN("skipped: no ffmpeg here");
    return;
  }
  const RenderedRun r;
  for (const char* ending : {".mp4", ".webm"}) {
    const fs::path film = r.folder / (std::string("film") + ending);
    REQUIRE(call_program("render " + r.run.string() + " --size 161x120 --out " + film.string() + " 2> /dev/null") == 0);
    const auto all = probed(film, r.folder / "said");
    REQUIRE(all.size() == 5);
    CHECK(all[0] == "162");  // H.264 wants even numbers
    CHECK(all[1] == "120");
    CHECK(all[2] == "11/3");                                // few pictures are shown for 3 s in all
    CHECK(all[3] == "11");                                  // 0, 0.02 ... 0.2 s
    CHECK(std::stod(all[4]) == Approx(3.0).epsilon(0.03));  // WebM counts milliseconds
    REQUIRE(call_program("render " + r.run.string() + " --every 5 --size 64x48 --out " + film.string() +
                         " 2> /dev/null") == 0);
    CHECK(probed(film, r.folder / "said")[3] == "3");
  }
}

TEST_CASE("without ffmpeg a film says what to install, and pictures need nothing", "[scenes][view]") {
  const RenderedRun r;
  const std::string nothing = "PATH=" + r.folder.path().string() + " ", said = (r.folder / "said").string();
  CHECK(call_program(
            "render " + r.run.string() + " --size 64x48 --out " + (r.folder / "film.mp4").string() + " 2> " + said,
            nothing) == 3);
  CHECK(support::read_text(said).find("apt-get install ffmpeg") != std::string::npos);
  CHECK(call_program(
            "render " + r.run.string() + " --size 64x48 --out " + (r.folder / "one.png").string() + " 2> " + said,
            nothing) == 0);
}

TEST_CASE("what render is not asked rightly it refuses as usage, before it writes", "[scenes][view]") {
  const RenderedRun r;
  const std::string said = (r.folder / "said").string();
  const std::vector<std::pair<std::string, std::string>> wrong{{"--field speeed --out a.png", "it has speed"},
                                                               {"--camera frnt --out a.png", "there are scene, iso"},
                                                               {"--time nan --out a.png", "no number"},
                                                               {"--time 0.1 --out a.mp4", "--time is for a picture"},
                                                               {"--every 2 --out a.png", "--every is for a film"},
                                                               {"--size 12 --out a.png", "WIDTHxHEIGHT"},
                                                               {"--out a.gif", ".png, .mp4 or .webm"}};
  const std::string at_home = "cd " + r.folder.path().string() + " && ";
  for (const auto& [options, expected] : wrong) {
    INFO(options);
    CHECK(call_program("render " + r.run.string() + " " + options + " 2> " + said, at_home) == 2);
    CHECK(support::read_text(said).find(expected) != std::string::npos);
  }
  for (const char* name : {"a.png", "a.mp4", "a.gif"}) CHECK(!fs::exists(r.folder / name));
  CHECK(call_program("render " + r.run.string() + " --size 64x48 --time 9 --out a.png 2> " + said, at_home) == 0);
  CHECK(support::read_text(said).find("frames from 0 to 0.2 s") != std::string::npos);
  CHECK(call_program("view " + r.run.string() + " --set params.n=1 --out a.html 2> " + said, at_home) == 2);
}

TEST_CASE("pages are written over pages alone, and no output over its input", "[scenes][view]") {
  const RenderedRun r;
  std::mt19937 random(17);
  const std::string said = (r.folder / "said").string(), scene = (r.folder / "scene.toml").string();
  std::ofstream(r.folder / "notes.html") << std::string(random() % 300 + 1, 'a');  // a page by its name alone
  std::ofstream(r.folder / "noise", std::ios::binary) << std::string(random() % 300 + 1, static_cast<char>(random()));
  fs::create_hard_link(scene, r.folder / "link.toml");
  const std::string run = r.run.string();
  const std::vector<std::string> files{run + "/run.h5",
                                       run + "/summary.json",
                                       run + "/measures.csv",
                                       scene,
                                       (r.folder / "notes.html").string(),
                                       (r.folder / "noise").string()};
  for (const std::string& file : files) {
    const std::string before = support::read_text(file);
    for (const std::string& command : {"report " + run, "view " + run, "view " + scene}) {
      INFO(command + " " + file);
      CHECK(call_program(command + " --out " + file + " 2> " + said) == 2);
      CHECK(support::read_text(said).find("no HTML page") != std::string::npos);
      CHECK(support::read_text(file) == before);
    }
  }
  CHECK(call_program("bench " + scene + " --out " + (r.folder / "link.toml").string() + " > " + said + " 2>&1") == 2);
  CHECK(call_program("view " + scene + " --out " + run + " 2> " + said) == 2);
  // pages, whoever wrote them, and empty files may go
  const std::string page = (r.folder / "page.html").string();
  for (const char* there : {"", "\xEF\xBB\xBF \n<!DOCTYPE html><p>", "<HTML></HTML>"}) {
    std::ofstream(page) << there;
    CHECK(call_program("view " + scene + " --out " + page + " 2> " + said) == 0);
    CHECK(call_program("report " + run + " --out " + page + " 2> " + said) == 0);
  }
}

TEST_CASE("damage beside a whole run.h5 is reported, and the rest shown", "[scenes][view]") {
  const RenderedRun r;
  std::mt19937 random(23);
  const std::string said = (r.folder / "said").string(), run = r.run.string();
  const std::string picture = " --size 64x48 --out " + (r.folder / "a.png").string() + " 2> " + said;
  std::vector<fs::path> contacts;
  for (const auto& file : fs::directory_iterator(r.run / "frames"))
    if (file.path().filename().string().starts_with("contacts")) contacts.push_back(file.path());
  REQUIRE(contacts.size() > 3);
  for (int k = 0; k < 4; ++k) {
    const fs::path damaged = k == 3 ? r.run / "frames.pvd" : contacts[random() % contacts.size()];
    const std::string before = support::read_text(damaged);
    std::ofstream(damaged) << before.substr(0, random() % 60);
    INFO(damaged.string());
    CHECK(call_program("render " + run + picture) == 0);
    const std::string told = support::read_text(said);
    CHECK(told.find(damaged.string()) != std::string::npos);
    CHECK(told.find("shown without contacts") != std::string::npos);
    CHECK(call_program("report " + run + " 2> " + said) == 0);
    CHECK(support::read_text(r.run / "report.html").find("shown without contacts") != std::string::npos);
    std::ofstream(damaged) << before;
  }
  std::shuffle(contacts.begin(), contacts.end(), random);  // several at once have one warning
  const std::ptrdiff_t several = 2 + static_cast<std::ptrdiff_t>(random() % (contacts.size() - 2));
  std::map<fs::path, std::string> whole;
  for (const fs::path& file : std::vector<fs::path>(contacts.begin(), contacts.begin() + several)) {
    whole[file] = support::read_text(file);
    std::ofstream(file) << whole[file].substr(0, 10);
  }
  CHECK(call_program("report " + run + " 2> " + said) == 0);
  const std::string cut_page = support::read_text(r.run / "report.html");
  CHECK(cut_page.find(std::to_string(several) + " files of contacts are damaged") != cut_page.npos);
  CHECK(cut_page.find("this frame is shown without contacts") == cut_page.npos);
  for (const auto& [file, text] : whole) std::ofstream(file) << text;
  const std::string summary = support::read_text(r.run / "summary.json");
  for (const std::string& text : {std::string(), std::string("[]"), std::string("5"), std::string("{\"status\": 5}"),
                                  std::string("\"text\""), summary.substr(0, 1 + random() % (summary.size() - 2))}) {
    std::ofstream(r.run / "summary.json") << text;
    INFO(text);
    CHECK(call_program("report " + run + " 2> " + said) == 0);
    const std::string page = support::read_text(r.run / "report.html");
    CHECK(page.find("summary.json") != std::string::npos);
    CHECK(page.find("comes from the other files of the run") != std::string::npos);
    CHECK(page.find("Two boxes on each other") != std::string::npos);
  }
  std::ofstream(r.run / "summary.json") << summary;
  CHECK(call_program("render " + run + picture) == 0);
  CHECK(support::read_text(said).find("warning") == std::string::npos);
}

TEST_CASE("what contacts have of the residual adds up to that of the step", "[scenes][view]") {
  // two sweeps leave a stack of three open; the only step's residual is the largest of the run
  const RenderedRun r("--set run.duration=0.01 --set run.output_interval=0.01");
  const auto source = open_run(r.run);
  REQUIRE(source->has_residuals());
  const ViewFrame frame = source->frame(source->times().size() - 1);
  double squares = 0;
  for (const StoredContact& c : frame.contacts) squares += static_cast<double>(c.residual) * c.residual;
  const double residual = read_json(r.run / "summary.json").number("residual.max").value_or(-1);
  CHECK(residual > 1e-3);
  CHECK(std::sqrt(squares) == Approx(residual).epsilon(1e-5));  // stored in 24 bits
  const std::vector<float> of_bodies = FrameFields(frame, source->about())("residual");
  CHECK(of_bodies[1] > 0);
  CHECK(of_bodies.back() == 0);  // the bob touches nothing
  CHECK(call_program("render " + r.run.string() + " --field residual --size 64x48 2> /dev/null") == 0);
  CHECK(call_program("render " + r.run.string() + " --field stress --size 64x48 2> /dev/null") == 0);
}

TEST_CASE("a spring is drawn between its bodies", "[scenes][view]") {
  const RenderedRun r;
  const auto source = open_run(r.run);
  RenderOptions options;
  options.camera = "front";
  options.width = 400;
  options.height = 400;
  options.labels = false;
  const Overview overview = look_over(*source);
  RunPainter painter(*source, overview, options);
  Image image = painter.paint(0);
  // the middle column shows dark pixels between bob and hook: look at the rows of 0.7 and 0.9 m
  const Camera camera = choose_camera("front", source->about(), look_over(*source).box, 1.0);
  const double focus = 200 / std::tan(0.5 * camera.angle * 3.14159265 / 180);
  int dark = 0;
  for (const double z : {0.7, 0.8, 0.9}) {
    const double depth = camera.target.y() - camera.eye.y();
    const int row = static_cast<int>(200 - focus * (z - camera.eye.z()) / depth);
    for (int x = 190; x < 211; ++x) dark += image.at(x, row)[0] < 120 ? 1 : 0;
  }
  CHECK(dark >= 3);
}
