// `epafi patch`: cases read, problems named with their place, results and validity.
#include <unistd.h>

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <set>
#include <sstream>

#include "scenes/cli/commands.h"
#include "scenes/patch/evaluate_patch.h"
#include "tests/support/captured.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

const std::string head = "[material.steel]\nshear_modulus = 82e9\npoissons_ratio = 0.28\n[contact]\nfriction = 0.3\n";

std::vector<PatchResult> run(const std::string& patch) {
  const PatchReading r = read_patch_text(head + "[patch]\n" + patch, "case.toml", {});
  for (const auto& p : r.problems) UNSCOPED_INFO(p.to_string());
  REQUIRE(r.patch);
  return evaluate_patch(*r.patch);
}

std::string problems(const std::string& text) {
  const PatchReading r = read_patch_text(text, "case.toml", {});
  CHECK_FALSE(r.patch);
  std::string all;
  for (const auto& p : r.problems) all += p.to_string() + "\n";
  return all;
}

}  // namespace

TEST_CASE("a scene or a study is no patch case, and the answer says which command takes it", "[scenes][wheel_rail]") {
  CHECK(problems("title = \"Bed\"\n[run]\nduration = 1\n[gravity]\n") ==
        "case.toml:2:1: error: 'run': this file is a scene, not a patch case; it is for epafi run\n");
  CHECK_THAT(problems("scene = \"bed.toml\"\n"), Catch::Contains("this file is a study, not a patch case"));
  CHECK_THAT(problems("[run]\nduration = 1\n[patch]\n"), Catch::Contains("unknown table or key 'run'"));
}

TEST_CASE("a given ellipse has Hertz' pressure and the chosen laws' forces", "[scenes][wheel_rail]") {
  const auto results =
      run("semi_axes = { a = \"8 mm\", b = \"4 mm\" }\nload = 82e3\ncreepage = { longitudinal = -0.001 }\ntangential = "
          "[\"kalker-linear\", \"fastsim\", \"half-space\"]\n");
  REQUIRE(results.size() == 3);
  CHECK(results[0].max_pressure == Approx(1.5 * 82e3 / (std::numbers::pi * 8e-3 * 4e-3)).epsilon(1e-12));
  CHECK(results[2].force.fx / (0.3 * 82e3) == Approx(0.4646).epsilon(0.01));  // limit of fine grids
  CHECK(results[2].reasons.empty());
  CHECK(results[2].wear_number == Approx(0.001 * results[2].force.fx).epsilon(1e-6));
  CHECK(results[1].stick_share > 0.5);
  const std::string json = patch_json(results);
  for (const char* key :
       {"\"normal\"", "\"tangential\"", "\"normal_force\"", "\"approach\"",    "\"contacts\"",     "\"y_wheel\"",
        "\"y_rail\"", "\"angle\"",      "\"semi_axes\"",    "\"area\"",        "\"max_pressure\"", "\"fx\"",
        "\"fy\"",     "\"mz\"",         "\"stick_share\"",  "\"wear_number\"", "\"milliseconds\"", "\"error_estimate\"",
        "\"valid\"",  "\"reasons\""})
    CHECK(json.find(key) != std::string::npos);
}

TEST_CASE("boundary elements on the default grid agree with Hertz for radii", "[scenes][wheel_rail]") {
  const auto results =
      run("radii = { x1 = 0.46, x2 = inf, y1 = inf, y2 = 0.3 }\nload = 80e3\nnormal = [\"hertz\", \"multi-hertz\", "
          "\"half-space\"]\n");
  REQUIRE(results.size() == 3);
  for (int k : {1, 2}) {
    CHECK(results[static_cast<std::size_t>(k)].max_pressure == Approx(results[0].max_pressure).epsilon(1e-3));
    CHECK(results[static_cast<std::size_t>(k)].approach == Approx(results[0].approach).epsilon(1e-3));
    CHECK(results[static_cast<std::size_t>(k)].reasons.empty());
  }
  CHECK(results[2].error_estimate < 1e-3);
}

TEST_CASE("laws outside their range say why, and are silent inside", "[scenes][wheel_rail]") {
  const std::string laws =
      "tangential = [\"shen-hedrick-elkins\", \"polach\", \"vermeulen-johnson\", \"fastsim\", \"strip\", \"fastrip\", "
      "\"half-space\"]\nload = 82e3\n";
  const auto invalid = [&](const std::string& rest) {
    std::set<std::string> names;
    for (const auto& r : run(laws + rest))
      if (!r.reasons.empty()) names.insert(r.tangential);
    return names;
  };
  const std::string circle = "semi_axes = { a = 6e-3, b = 6e-3 }\n";
  CHECK(invalid(circle + "creepage = { lateral = 0.001 }\n") == std::set<std::string>{"strip"});
  CHECK(invalid(circle + "creepage = { spin = 2.0 }\n") ==
        std::set<std::string>{"shen-hedrick-elkins", "polach", "vermeulen-johnson", "fastsim", "strip"});
  CHECK(invalid("semi_axes = { a = 1e-3, b = 8e-3 }\ncreepage = { longitudinal = 0.001 }\n").empty());
  const auto coarse = run(circle +
                          "load = 82e3\ncreepage = { longitudinal = 0.001 }\ngrid = { dx = 3e-3, dy = 3e-3 "
                          "}\ntangential = \"half-space\"\n");
  CHECK_FALSE(coarse[0].reasons.empty());
}

TEST_CASE("a shift is Cattaneo's, a start from rest rolls from there to the steady state", "[scenes][wheel_rail]") {
  // a sphere of 50 mm on a plane, rubber without lateral contraction (E* = G), where Cattaneo is exact: Q = mu N / 2 at
  // the shift 3 mu N (2 - nu) / (8 G a) (1 - (1/2)^(2/3))
  const double N = 9.1954, G = 200e6, a = std::cbrt(0.75 * N * 0.05 / G),
               shift = 3.0 * 0.4 * N * 2.0 / (8.0 * G * a) * (1.0 - std::cbrt(0.25));
  const PatchReading sphere = read_patch_text(
      fmt::format("[material.rubber]\nshear_modulus = {}\npoissons_ratio = 0.0\n[contact]\nfriction = 0.4\n[patch]\n"
                  "radii = {{ x1 = 0.05, x2 = inf, y1 = 0.05, y2 = inf }}\nload = {}\ncreepage = {{ longitudinal = "
                  "-0.001 }}\ndistance = {}\ntangential = \"half-space-shift\"\n",
                  G, N, 1e3 * shift),
      "case.toml", {});
  REQUIRE(sphere.patch);
  const PatchResult q = evaluate_patch(*sphere.patch).front();
  CHECK(q.force.fx == Approx(0.5 * 0.4 * N).epsilon(2e-3));
  CHECK(std::sqrt(q.stick_share) == Approx(std::cbrt(0.5)).margin(0.02));
  CHECK(q.reasons.empty());

  const auto of = [](const char* distance) {
    return run(std::string("semi_axes = { a = 8e-3, b = 4e-3 }\nload = 82e3\ncreepage = { longitudinal = -0.001 }\n"
                           "grid = { dx = 5e-4, dy = 5e-4 }\ndistance = ") +
               distance + "\ntangential = [\"half-space-start\", \"half-space-shift\", \"half-space\"]\n");
  };
  const auto early = of("1e-4"), late = of("40e-3");
  CHECK(early[0].force.fx == Approx(early[1].force.fx).epsilon(0.04));  // what has rolled off is of second order
  CHECK(early[0].force.fx < 0.02 * early[2].force.fx);
  CHECK(late[0].force.fx == Approx(late[2].force.fx).epsilon(6e-3));  // fades as the inverse of the distance
  CHECK(late[0].reasons.empty());
}

TEST_CASE("profiles hardly touching are refused at once by every model, and solved from a nanometre on",
          "[scenes][wheel_rail]") {
  const auto of = [](const char* target) {
    const PatchReading r = read_patch_text(
        head +
            "[shape.wheel]\nwheel_profile = { name = \"s1002\", radius = 0.46 }\n[shape.rail]\nrail_profile = "
            "{ name = \"uic60\", cant = \"= 1/40\" }\n[patch]\nside = \"left\"\nlateral_shift = 3e-3\n"
            "normal = [\"hertz\", \"multi-hertz\", \"kik-piotrowski\", \"semi-hertz\", \"half-space\"]\n" +
            target,
        "case.toml", {});
    REQUIRE(r.patch);
    return evaluate_patch(*r.patch);
  };
  for (const char* target : {"approach = 1e-16", "approach = 1e-11", "load = 1e-14"})
    for (const PatchResult& r : of(target)) {
      INFO(target << ", " << r.normal);
      CHECK(r.normal_force == 0.0);
      REQUIRE(r.reasons.size() == 1);
      CHECK(r.reasons[0].find("rounding") != std::string::npos);
    }
  const auto least = of("approach = 1e-9");
  CHECK(least[4].normal_force == Approx(least[0].normal_force).epsilon(0.02));  // Hertz: 1 % of it is the shape
  CHECK(least[4].reasons.empty());
}

TEST_CASE("a line contact is Carter's problem", "[scenes][wheel_rail]") {
  const auto r =
      run("radii = { x1 = 1.0, x2 = 1.0, y1 = inf, y2 = inf }\nlength = 0.1\nload = 50e3\ncreepage = { longitudinal = "
          "-0.0002 }\ntangential = \"strip\"\n");
  const double E = 82e9 / 0.72, a = std::sqrt(4.0 * 5e5 * 0.5 / (std::numbers::pi * E));  // R = 1/2
  CHECK(r[0].contacts[0].semi_axes.a == Approx(a).epsilon(1e-9));
  const double q = 1.0 - 0.0002 * 0.5 / (0.3 * a);  // 1 - xi R / (mu a)
  CHECK(r[0].force.fx / 15e3 == Approx(1.0 - q * q).epsilon(1e-3));
  CHECK(r[0].reasons.empty());
}

TEST_CASE("a map says slip where the traction is at its bound, and nowhere else", "[scenes][wheel_rail]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int k = 0; k < 6; ++k) {
    const std::string text =
        head + "[patch]\nload = 82e3\nradii = { x1 = 0.46, x2 = inf, y1 = inf, y2 = 0.3 }\nnormal = \"half-space\"\n" +
        fmt::format("creepage = {{ longitudinal = {}, lateral = {}, spin = {} }}\n", 1e-3 * unit(random),
                    1e-3 * unit(random), 0.3 * unit(random)) +
        "tangential = [\"fastsim-elliptic\", \"strip\", \"fastrip\", \"half-space\"]\n";
    const PatchReading r = read_patch_text(text, "case.toml", {});
    REQUIRE(r.patch);
    for (const PatchResult& result : evaluate_patch(*r.patch, true)) {
      const TractionMap& m = result.contacts[0].map;
      double stick = 0.0;
      std::size_t wrong = 0;
      for (std::size_t c = 0; c < m.x.size(); ++c) {
        const bool at_bound = std::hypot(m.traction_x[c], m.traction_y[c]) >= 0.3 * m.pressure[c] * (1.0 - 1e-6);
        wrong += at_bound == (m.sticks[c] == 1);
        stick += m.sticks[c];
        if (m.knows_slip()) wrong += (m.slip_x[c] != 0.0 || m.slip_y[c] != 0.0) == (m.sticks[c] == 1);
      }
      INFO(result.tangential << " " << text);
      CHECK(wrong == 0);
      // the cells of a solved pressure are all of one size
      CHECK(stick / static_cast<double>(m.x.size()) == Approx(result.stick_share).margin(1e-9));
      const bool marches = result.tangential == "strip" || result.tangential == "fastrip";
      CHECK(m.knows_slip() != marches);
    }
  }
}

namespace {

std::size_t occurrences(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; ++at) ++n;
  return n;
}

}  // namespace

TEST_CASE("maps of a patch hold its force, and its picture the cells that stick", "[scenes][wheel_rail]") {
  const PatchReading r = read_patch_text(
      head +
          "[patch]\nload = 82e3\nsemi_axes = { a = 8e-3, b = 4e-3 }\ncreepage = { lateral = 0.0005, spin = 0.3 }\n"
          "tangential = \"fastsim\"\ngrid = { dx = 4e-4, dy = 4e-4 }\n",
      "case.toml", {});
  REQUIRE(r.patch);
  const auto results = evaluate_patch(*r.patch, true);
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("epafi-maps-" + std::to_string(::getpid()));
  write_patch_maps(folder.string(), results);
  std::ifstream table(folder / "patch.csv");
  std::string line, row;
  REQUIRE(std::getline(table, line));
  REQUIRE(std::getline(table, row));
  CHECK(line.starts_with("normal,tangential,normal_force [N],"));
  CHECK(row.starts_with("hertz,fastsim,82000,"));
  CHECK(std::count(line.begin(), line.end(), ',') == std::count(row.begin(), row.end(), ','));
  std::ifstream in(folder / "hertz_fastsim.csv");
  std::getline(in, line);
  CHECK(line == "x,y,pressure,traction_x,traction_y,slip_x,slip_y,state");
  std::size_t cells = 0, stick = 0;
  double worst = 0.0, fy = 0.0;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    double v[8] = {};
    char comma;
    for (double& value : v) words >> value >> comma;
    ++cells;
    stick += v[7] == 1.0;
    fy += v[4];
    worst = std::max(worst, std::hypot(v[3], v[4]) / (0.3 * v[2]));
  }
  CHECK(cells == results[0].contacts[0].map.x.size());
  CHECK(static_cast<double>(stick) / static_cast<double>(cells) == Approx(results[0].stick_share).margin(0.1));
  CHECK(worst < 4.0 / 3.0);  // parabolic bound over elliptic pressure
  CHECK(fy * results[0].force.fy > 0.0);
  std::stringstream picture;
  picture << std::ifstream(folder / "hertz_fastsim.svg").rdbuf();
  const auto count = [text = picture.str()](const std::string& word) { return occurrences(text, word); };
  // one square for each cell of the image, strips of one length each in theirs
  // and one of each kind in the legend
  const std::size_t sticks = count("class=\"stick\"") - 1, slips = count("class=\"slip\"") - 1;
  const double share = static_cast<double>(sticks) / static_cast<double>(sticks + slips);
  CHECK(count(fmt::format("sticks: {:.0f} % of the patch", 100.0 * share)) == 1);
  CHECK(static_cast<double>(sticks) / static_cast<double>(sticks + slips) ==
        Approx(results[0].stick_share).margin(0.1));
  CHECK(std::filesystem::exists(folder / "hertz_fastsim.vti"));
  std::filesystem::remove_all(folder);
}

TEST_CASE("captions of maps stay within pictures of any shape, with the title of the case", "[scenes][wheel_rail]") {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("epafi-captions-" + std::to_string(::getpid()));
  std::mt19937 random(8);
  for (int k = 0; k < 8; ++k) {
    PatchResult result;
    result.normal = "hertz";
    result.tangential = "fastsim";
    result.contacts.emplace_back();
    TractionMap& m = result.contacts.back().map;
    const double length = std::exp2(static_cast<double>(random() % 13) - 6.0);  // 1:64 to 64:1
    for (int cell = 0; cell < 64; ++cell) {
      m.x.push_back(1e-3 * length * (cell % 8));
      m.y.push_back(1e-3 * (cell / 8));
      for (auto* column : {&m.pressure, &m.traction_x, &m.traction_y}) column->push_back(1e6);
      m.sticks.push_back(cell % 2 == 0);
    }
    write_patch_maps(folder.string(), {result}, "a < b");
    std::stringstream all;
    all << std::ifstream(folder / "hertz_fastsim.svg").rdbuf();
    const std::string text = all.str();
    CHECK(text.find("<title>a &lt; b</title>") != text.npos);
    const auto number = [&](const std::string& word) { return std::stod(text.substr(text.find(word) + word.size())); };
    const double width = number("width=\""), height = number("height=\"");
    int lines = 0;
    for (std::size_t at = 0; (at = text.find("<text x=\"", at)) != text.npos; ++at) {
      double x = std::stod(text.substr(at + 9)), y = std::stod(text.substr(text.find("y=\"", at) + 3));
      const std::size_t group = text.rfind("<g transform=\"translate(", at), axes = text.rfind("<g class=\"axes\"", at);
      if (group != text.npos && group > axes) {  // of the legend, which comes last
        x += std::stod(text.substr(group + 24));
        y += std::stod(text.substr(text.find(' ', group + 24)));
        ++lines;
      }
      const std::size_t from = text.find('>', at) + 1, letters = text.find('<', from) - from;
      const double long_by = 8.0 * static_cast<double>(letters);  // 15 points of a sans face: 7.5 a letter
      const std::string head = text.substr(at, from - at);
      const double share = head.find("middle") != head.npos ? 0.5 : head.find("\"end\"") != head.npos ? 1.0 : 0.0;
      CHECK(x + (1 - share) * long_by < width);
      CHECK(x - share * long_by > 0.0);
      CHECK(y + 4.0 < height);
    }
    CHECK(lines >= 3);  // what sticks, what slips, the longest line
  }
  std::filesystem::remove_all(folder);
}

TEST_CASE("what is wrong with a case is named with its place", "[scenes][wheel_rail]") {
  CHECK(problems(head + "[patch]\nload = 1\nsemi_axes = { a = 1, b = 1 }\ntangential = [\"fastsin\"]\n")
            .find("case.toml:9:15: error: unknown tangential 'fastsin'") != std::string::npos);
  CHECK(problems(head + "[patch]\nlaod = 1\nsemi_axes = { a = 1, b = 1 }\n").find("did you mean 'load'") !=
        std::string::npos);
  CHECK(problems(head + "[patch]\nload = 1\n").find("needs a wheel_profile and a rail_profile") != std::string::npos);
  CHECK(problems(head + "[patch]\nload = 1\nradii = { x1 = 1, x2 = -0.5, y1 = 1, y2 = 1 }\n")
            .find("both must be positive") != std::string::npos);
  CHECK(problems(head + "[patch]\nload = 1\nradii = { x1 = 1, x2 = 1, y1 = inf, y2 = inf }\n").find("length") !=
        std::string::npos);
  CHECK(problems("[patch]\nload = 1\nsemi_axes = { a = 1, b = 1 }\n").find("missing table [material.NAME]") !=
        std::string::npos);
  CHECK(problems(head).find("missing table [patch]") != std::string::npos);
  CHECK(problems("[material.steel]\nshear_modulus = 82e9\npoissons_ratio = 0.28\n[patch]\nload = 1\nsemi_axes = { a = "
                 "1, b = 1 }\ntangential = \"polach\"\n")
            .find("missing key 'friction'") != std::string::npos);
}

TEST_CASE("a grid for boundary elements leaves finite elements to their own, with a note",
          "[scenes][wheel_rail][long]") {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> axis(0.3, 0.9), load(5e3, 8e4);
  for (int k = 0; k < 2; ++k) {
    const std::string both = fmt::format("load = {:.6g}\nradii = {{ x1 = {:.4g}, x2 = inf, y1 = inf, y2 = {:.4g} }}\n",
                                         load(random), axis(random), axis(random));
    const auto fine = run(both + "normal = [\"hertz\", \"fem\"]\ngrid = { dx = 1e-4, dy = 1e-4 }\n");
    INFO(both);
    REQUIRE(fine[1].notes.size() == 1);
    CHECK_THAT(fine[1].notes[0], Catch::Contains("at most 24 across"));
    CHECK(fine[1].reasons.empty());
    // of eight elements: as near to Hertz as the error estimate says
    CHECK(fine[1].error_estimate >= 0.01);
    CHECK(fine[1].error_estimate < 0.02);
    CHECK(fine[1].max_pressure == Approx(fine[0].max_pressure).epsilon(fine[1].error_estimate));
    CHECK(fine[1].approach == Approx(fine[0].approach).epsilon(0.01));
    if (k > 0) continue;
    const auto own = run(both + "normal = \"fem\"\n");
    CHECK(own[0].notes.empty());
    CHECK(own[0].max_pressure == fine[1].max_pressure);
  }
}

TEST_CASE("patch prints rows of CSV, JSON and a table that say the same, into a file where asked",
          "[scenes][wheel_rail]") {
  const TemporaryFolder folder;
  const std::string file = (folder / "case.toml").string();
  std::ofstream(file) << head << "[patch]\nload = 5e4\nsemi_axes = { a = 6e-3, b = 4e-3 }\n"
                      << "creepage = { longitudinal = 1e-3 }\ntangential = [\"polach\", \"fastsim\"]\n";
  const auto printed = [&](PatchOptions o) { return captured([&] { return command_patch({file, {}}, o); }).out; };
  const std::string csv = printed({});
  std::istringstream lines(csv);
  std::string names, row;
  std::getline(lines, names);
  std::getline(lines, row);
  CHECK(names ==
        "normal,tangential,normal_force,approach,max_pressure,area,fx,fy,mz,stick_share,wear_number,milliseconds,"
        "error_estimate,valid,reasons");
  CHECK(row.starts_with("hertz,polach,50000,"));
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 3);
  CHECK_THAT(printed({.json = true}), Catch::Contains("\"wear_number\"") && Catch::StartsWith("["));
  CHECK_THAT(printed({.table = true}), Catch::Contains("Fx [N]"));
  const std::string out = (folder / "rows.csv").string();
  CHECK(printed({.out = out}).empty());
  std::ifstream in(out);
  const std::string written(std::istreambuf_iterator<char>(in), {});
  CHECK(written.substr(0, written.find("hertz,polach,50000,")) == csv.substr(0, csv.find("hertz,polach,50000,")));
  CHECK(std::count(written.begin(), written.end(), '\n') == 3);
}

TEST_CASE("finite elements say how far they miss two hills of pressure", "[scenes][wheel_rail][long]") {
  // S1002 on UIC60 without cant: the head's arcs make two hills, of which 8 elements hold one; boundary elements beside
  const std::string text = head +
                           "[shape.wheel]\nwheel_profile = { name = \"s1002\", radius = 0.46 }\n[shape.rail]\n"
                           "rail_profile = { name = \"uic60\", cant = \"= 1/40\" }\n[patch]\nload = 82.5e3\n"
                           "lateral_shift = 0.0\nnormal = [\"half-space\", \"fem\"]\n";
  const PatchReading r = read_patch_text(text, "case.toml", {});
  REQUIRE(r.patch);
  const auto both = evaluate_patch(*r.patch);
  REQUIRE(both.size() == 2);
  const double off = std::abs(both[1].max_pressure / both[0].max_pressure - 1.0);
  CHECK(off <= both[1].error_estimate + 2.0 * both[0].error_estimate);
}

TEST_CASE("without friction no model of steady rolling has a force, with hardly any all have Coulomb's",
          "[scenes][wheel_rail]") {
  // FASTSIM's flexibility was 0/0 where mu N is: forces that were no numbers
  std::mt19937 random(5);
  const auto in = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  for (const double friction : {0.0, 1e-9, 1e-12}) {
    const std::string text = fmt::format(
        "[material.s]\nshear_modulus = 82e9\npoissons_ratio = 0.28\n[contact]\nfriction = {}\n[patch]\nload = 8e4\n"
        "semi_axes = {{ a = {}, b = {} }}\ncreepage = {{ longitudinal = {}, lateral = {} }}\ntangential = "
        "[\"fastsim\", "
        "\"fastsim-elliptic\", \"fastrip\", \"shen-hedrick-elkins\", \"polach\", \"coulomb\", \"half-space\"]\n",
        friction, in(3e-3, 8e-3), in(3e-3, 8e-3), in(1e-3, 1e-2), in(1e-3, 1e-2));
    INFO(text);
    const PatchReading reading = read_patch_text(text, "case.toml", {});
    REQUIRE(reading.patch);
    for (const PatchResult& r : evaluate_patch(*reading.patch)) {
      INFO(r.tangential);
      CHECK(std::hypot(r.force.fx, r.force.fy) == Approx(friction * 8e4).epsilon(0.02).margin(0.0));
    }
  }
}

TEST_CASE("friction falls with the slip of a rolling wheelset as with a given creepage", "[scenes][wheel_rail]") {
  // of full slip the wear number over the force is the creepage; friction stayed at rest where it was not given
  const std::string wheelset =
      "[shape.wheel]\nwheel_profile = { name = \"s1002\" }\n[shape.rail]\nrail_profile = { name = \"uic60\", cant = "
      "0.025 }\n[patch]\nload = 60e3\ntangential = \"coulomb\"\n";
  std::mt19937 random(9);
  const auto in = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  for (int n = 0; n < 20; ++n) {
    const double limit = in(0.1, 0.9), decay = in(0.1, 1.0), speed = in(5.0, 60.0);
    const std::string text =
        head + fmt::format("friction_limit = {}\nfriction_decay = {}\nspeed = {}\n", limit, decay, speed) + wheelset +
        fmt::format("lateral_shift = {}\nyaw = {}\nrolling_radius = {}\n", in(-4e-3, 4e-3), in(-0.02, 0.02),
                    in(0.40, 0.52)) +
        (n % 2 ? fmt::format("creepage = {{ longitudinal = {}, lateral = {} }}\n", in(-0.1, 0.1), in(-0.1, 0.1)) : "");
    INFO(text);
    const PatchReading reading = read_patch_text(text, "case.toml", {});
    REQUIRE(reading.patch);
    CHECK(reading.problems.empty());
    const PatchResult r = evaluate_patch(*reading.patch).front();
    const double force = std::hypot(r.force.fx, r.force.fy), slip = speed * r.wear_number / force;
    CHECK(force / r.normal_force == Approx(0.3 * ((1.0 - limit) * std::exp(-decay * slip) + limit)).epsilon(1e-6));
  }
  const PatchReading idle = read_patch_text(head + "friction_decay = 0.6\n" + wheelset, "case.toml", {});
  REQUIRE(idle.problems.size() == 1);
  CHECK_THAT(idle.problems[0].to_string(), Catch::Contains("friction_decay has no effect"));
}
