/// @file chung_ooi.cpp  The eight impact tests of Chung and Ooi (2011) as CSV: exact or converged answer, errors at 100
/// and at 4000 steps per contact relative to the scale of the impact, and the answer of bristles. Micro-slip rows
/// compare with the converged incremental Mindlin law with rescaling; bristles have the full history of partial slip.
/// Given a folder, writes chung_ooi (errors of all rows) and chung_ooi_4 (svg) there:
/// perf_chung_ooi docs/figures > docs/figures/chung_ooi.csv
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "laws/smooth/critical_step.h"
#include "tests/support/experiments.h"
#include "viz_export/report/charts.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

const Material glass{"glass", 2800, 48e9, 0.20}, limestone{"limestone", 2500, 20e9, 0.25},
    rigid{"rigid", 1000, infinity, 0.0};
const Material aluminium{"Al alloy", 2699, 70e9, 0.30}, magnesium{"Mg alloy", 1800, 40e9, 0.35};
const Material oxide{"Al oxide", 4000, 380e9, 0.23}, iron{"cast iron", 7000, 100e9, 0.25},
    steel{"steel", 7850, 208e9, 0.3};
const Material alloy{"Al alloy", 2700, 70e9, 0.33};

/// One impact of a sphere on a rigid plane, or of two spheres.
struct Shot {
  Material material;
  double radius, normal_speed, slip_speed = 0.0, spin = 0.0, restitution = 1.0, friction = 0.0;
  int partner =
      0;  ///< 0: plane, 1: equal sphere at the same speed and spin, 2: sphere 5 times as large, 1000 times as dense
  std::string tangential{};
};

struct Outcome {
  double overlap, force, time, restitution, slip_speed, spin;
};

Outcome shoot(const Shot& s, int steps) {
  ContactChoice choice{"hertz", s.restitution, s.friction};
  choice.tangential = s.tangential;
  const SmoothSetup setup = s.partner ? setup_of(choice, {s.material}) : setup_of(choice, {s.material, rigid});
  const double mass = 4.0 / 3.0 * pi * s.radius * s.radius * s.radius * s.material.density;
  const double mixed = s.partner == 1 ? 0.5 : 1.0, speed = s.partner == 1 ? 2 * s.normal_speed : s.normal_speed;
  const double R = s.partner == 1 ? 0.5 * s.radius : s.partner == 2 ? s.radius / 1.2 : s.radius;
  const MaterialPair& pair = s.partner ? setup.materials.of(0, 0) : setup.materials.of(0, 1);
  const double dt = hertz_contact_time(mixed * mass, R, pair.effective_modulus(), speed) / steps,
               gap = 0.3 * speed * dt;
  Rig rig(setup, Columns{.rotation = true});
  if (s.partner == 0) {
    rig.wall_material = 1;
    rig.add_sphere(s.radius, s.material.density, {0, 0, s.radius + gap}, {s.slip_speed, 0, -s.normal_speed},
                   {0, s.spin, 0});
    rig.add_plane(Vec3::UnitZ());
  } else {
    const double other = s.partner == 1 ? s.radius : 5 * s.radius;
    rig.add_sphere(s.radius, s.material.density, {s.radius + gap, 0, 0}, {-s.normal_speed, 0, 0}, {0, 0, s.spin});
    rig.add_sphere(other, s.material.density * (s.partner == 1 ? 1 : 1000), {-other, 0, 0},
                   {s.partner == 1 ? s.normal_speed : 0.0, 0, 0}, {0, 0, s.partner == 1 ? s.spin : 0.0});
  }
  const Impact impact = run_impact(rig, dt);
  const Vec3 &v = rig.world.velocity[0], &w = rig.world.angular_velocity[0];
  if (s.partner == 0)
    return {impact.largest_overlap, impact.largest_force, impact.contact_time, impact.restitution, v.x(), w.y()};
  return {impact.largest_overlap, impact.largest_force, impact.contact_time, impact.restitution, v.y(), w.z()};
}

/// Errors of all rows so far, by test: x is the number of the test and a share of the row within it.
struct Errors {
  PlotLine coarse{"100 steps per contact", {}, {}}, fine{"4000 steps per contact", {}, {}};
  std::array<int, 9> rows{};
  void add(const char* test, double at_100, double at_4000) {
    const auto t = static_cast<std::size_t>(std::atoi(test));
    const double x = static_cast<double>(t) + std::min(0.8, 0.03 * rows[t]++);
    coarse.points.push_back({x, std::max(at_100, 1e-10)});
    fine.points.push_back({x, std::max(at_4000, 1e-10)});
  }
};

void row(Errors& errors, const char* test, const std::string& what, double exact, const Shot& shot,
         double Outcome::*quantity, double sign, double scale) {
  const double coarse = sign * (shoot(shot, 100).*quantity), fine = sign * (shoot(shot, 4000).*quantity);
  const double at_100 = std::abs(coarse - exact) / scale, at_4000 = std::abs(fine - exact) / scale;
  std::printf("%s,\"%s\",%.5g,%.1e,%.1e,", test, what.c_str(), exact, at_100, at_4000);
  errors.add(test, at_100, at_4000);
  if (shot.friction > 0.0) {
    Shot full = shot;
    full.tangential = "mindlin-deresiewicz";
    std::printf("%.5g", sign * (shoot(full, 400).*quantity));
  }
  std::printf("\n");
}

void normal_tests(Errors& errors) {
  struct Row {
    Material material;
    double radius, speed;
    int partner;
    double overlap, force, time;
  };
  for (const Row& r : {Row{glass, 0.01, 10, 1, 2.74113e-4, 10696.9, 4.03395e-5},
                       {limestone, 0.01, 10, 1, 3.68304e-4, 7108.24, 5.42010e-5},
                       {aluminium, 0.1, 0.2, 0, 4.97172e-5, 11369.9, 7.31657e-4},
                       {magnesium, 0.1, 0.2, 0, 5.21233e-5, 7232.68, 7.67066e-4}}) {
    Shot shot{r.material, r.radius, r.speed};
    shot.partner = r.partner;
    const char* test = r.partner ? "1" : "2";
    row(errors, test, r.material.name + ", overlap [m]", r.overlap, shot, &Outcome::overlap, 1, r.overlap);
    row(errors, test, r.material.name + ", force [N]", r.force, shot, &Outcome::force, 1, r.force);
    row(errors, test, r.material.name + ", contact time [s]", r.time, shot, &Outcome::time, 1, r.time);
  }
  for (const Material& m : {oxide, iron})
    for (double e : {0.2, 0.4, 0.6, 0.8, 1.0}) {
      Shot shot{m, 2.5e-3, 3.9};
      shot.restitution = e;
      row(errors, "3", m.name + ", e", e, shot, &Outcome::restitution, 1, 1.0);
    }
}

void oblique_tests(const std::string& figures, Errors& errors) {
  struct Row {
    double degrees, ratio, spin;
  };
  PlotLine slip{"full slip, exact", {}, {}}, coarse{"mindlin, 100 steps", {}, {}},
      full{"mindlin-deresiewicz, 400 steps", {}, {}}, converged{"mindlin, converged", {}, {}};
  for (const Row& r : {Row{2, .87937, 16.42},
                       {5, .86114, 47.20},
                       {10, .71056, 196.02},
                       {15, .63143, 372.0},
                       {20, .62010, 506.7},
                       {25, .63812, 596.5},
                       {30, .68449, 615.2},
                       {35, .73985, 581.95},
                       {45, .81784, 502.35},
                       {50, .84715, 456.65},
                       {60, .89483, 355.21},
                       {75, .95119, 183.87},
                       {85, .98406, 61.918}}) {
    const double theta = r.degrees * pi / 180, V = 3.9;
    Shot shot{oxide, 2.5e-3, V * std::cos(theta), V * std::sin(theta), 0, 0.98, 0.092};
    const std::string at = std::to_string(static_cast<int>(r.degrees)) + " degrees, ";
    row(errors, "4", at + "v_t [m/s]", r.ratio * shot.slip_speed, shot, &Outcome::slip_speed, 1, V);
    row(errors, "4", at + "spin [rad/s]", r.spin, shot, &Outcome::spin, 1, V / 2.5e-3);
    coarse.points.push_back({r.degrees, shoot(shot, 100).slip_speed / shot.slip_speed});
    (r.degrees > 32.6 ? slip : converged).points.push_back({r.degrees, r.ratio});
    shot.tangential = "mindlin-deresiewicz";
    full.points.push_back({r.degrees, shoot(shot, 400).slip_speed / shot.slip_speed});
  }
  if (!figures.empty())
    draw(ScatterPlot{"Chung and Ooi, test 4: sphere of aluminium oxide",
                     "angle of impact from the normal [deg]",
                     "tangential restitution [-]",
                     {slip, converged, coarse, full},
                     {},
                     {},
                     {},
                     true,
                     false,
                     false},
         figures + "/chung_ooi_4");
}

void recoil_tests(Errors& errors) {
  struct Recoil {
    double psi, spin;
  };
  for (const Recoil& r : {Recoil{1, -.4174},
                          {2, -1.5649},
                          {3, -2.8490},
                          {4, -3.8557},
                          {5, -4.5969},
                          {6, -4.9867},
                          {7, -5},
                          {8, -5},
                          {14, -5}}) {
    const double scale = 0.3 * 5;
    Shot shot{steel, 1e-5, 5, r.psi * scale, 0, 1.0, 0.3};
    row(errors, "5", "psi = " + std::to_string(static_cast<int>(r.psi)) + ", R spin/(mu v_n)", r.spin, shot,
        &Outcome::spin, -1e-5 / scale, 1.0);
  }
}

void spin_tests(Errors& errors) {
  struct Row {
    double spin, speed_out, spin_out;
  };
  for (const Row& r : {Row{0.5, .018184509, .045387268},
                       {1, .041606967, -.040174174},
                       {2, .081485042, -.037126046},
                       {3, .10848853, .28778686},
                       {5, .11758768, 2.060308},
                       {12, .11908648, 9.0228381},
                       {22, .11951812, 19.012047}})
    for (int partner : {0, 1, 2}) {
      const char* test = partner == 0 ? "6" : partner == 1 ? "7" : "8";
      Shot shot{alloy, 0.1, 0.2, 0, r.spin, 0.5, 0.4, partner};
      const std::string at = "spin " + std::to_string(r.spin).substr(0, 4);
      row(errors, test, at + ", v_t [m/s]", r.speed_out, shot, &Outcome::slip_speed, 1, 0.12);
      row(errors, test, at + ", spin out [rad/s]", r.spin_out, shot, &Outcome::spin, 1, 3.0);
    }
}

}  // namespace

int main(int argc, char** argv) {
  std::printf("test,quantity,exact,error_100,error_4000,bristles\n");
  const std::string figures = argc > 1 ? argv[1] : "";
  Errors errors;
  normal_tests(errors);
  oblique_tests(figures, errors);
  recoil_tests(errors);
  spin_tests(errors);
  if (figures.empty()) return 0;
  draw(ScatterPlot{"Chung and Ooi, tests 1 to 8: ours beside the exact or converged answer",
                   "test, its rows side by side",
                   "error over the scale of the impact [-]",
                   {errors.coarse, errors.fine},
                   {},
                   {{"micro-slip at 100 steps: 2 %", 0.02},
                    {"micro-slip at 4000 steps: 0.3 %", 3e-3},
                    {"full slip, normal: 0.1 %", 1e-3}},
                   {},
                   false,
                   false,
                   true},
       figures + "/chung_ooi");
}
