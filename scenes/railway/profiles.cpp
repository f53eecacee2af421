#include "scenes/railway/profiles.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>

#include "engine/units/nearest.h"
#include "scenes/railway/plausible.h"
#include "scenes/reader/document.h"
#include "viz_export/files/side_file.h"

namespace epafi {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

bool exists(const std::string& path) {
  std::error_code failure;
  return std::filesystem::is_regular_file(path, failure);
}

Built<ProfilePoints> points_of(const Parameters& p, bool is_wheel, const std::string& label) {
  if (p.has("file") == p.has("name")) return {{}, label + ": write one of file and name"};
  if (p.has("name")) {
    const auto names = is_wheel ? std::vector<std::string>{"s1002", "cone"} : std::vector<std::string>{"60e1", "uic60"};
    const std::string& name = p.text("name");
    if (std::find(names.begin(), names.end(), name) == names.end())
      return {{}, "unknown profile '" + name + "' in " + label + suggestion(name, names, "built in"), "name"};
    return {name == "cone" ? cone_profile(p.number_or("conicity", 0.05)) : *built_in_profile(name)};
  }
  const std::string& path = p.text("file");
  if (!exists(path)) return {{}, label + " file: there is no file '" + path + "'", "file"};
  ProfileFile file = read_profile(read_whole_file(path));
  if (!file.problem.empty()) return {{}, file.problem, "file", {path, std::max(1, file.line), 1}};
  ProfileRemarks remarks = is_wheel ? remarks_on_wheel(file.points) : remarks_on_rail(file.points);
  if (!remarks.problem.empty()) return {{}, label + " file '" + path + "': " + remarks.problem, "file"};
  Built<ProfilePoints> out{std::move(file.points)};
  for (const std::string& text : remarks.doubts) out.doubts.push_back(label + ": " + text);
  const double smoothing = p.number_or("smoothing", 0.0);
  for (const std::string& text : {noise_remark(*out.value, smoothing), outlier_remark(*out.value),
                                  hole_remark(*out.value), smoothing_remark(*out.value, smoothing)})
    if (!text.empty()) out.doubts.push_back(label + ": " + text);
  return out;
}

void set_defect(const Parameters& p, const std::string& group, WheelDefect& out) {
  const std::string& wheel = p.text(group + ".wheel");
  out.left = wheel != "right";
  out.right = wheel != "left";
}

}  // namespace

Built<Profile> build_profile(const Parameters& p, bool is_wheel, const std::string& label) {
  Built<ProfilePoints> points = points_of(p, is_wheel, label);
  if (!points.value) return {{}, points.problem, points.key, points.place};
  const double smoothing = p.number_or("smoothing", 0.0);
  if (!is_wheel) points.value = canted_rail(std::move(*points.value), p.number_or("cant", 0.0));
  if (points.value->y.size() < 4)
    return {{}, label + ": fewer than 4 points are left of the head with this cant", "cant"};
  Built<Profile> out{Profile(*points.value, smoothing)};
  out.doubts = std::move(points.doubts);
  return out;
}

std::string gauge_face_problem(const Profile& rail, const TrackGeometry& track, const std::string& label) {
  const WheelRailPair pair(Profile({{-0.1, 0.0, 0.1}, {0.0, 0.0, 0.0}}), rail, track, true);
  if (pair.has_gauge_face()) return "";
  return fmt::format(
      "{}: the rail's points end {:.3g} m below its top on the gauge side (y = {:.4g} m), and the gauge is measured "
      "{:.3g} m below it: give the whole head, or write as gauge the distance between the rails' last points",
      label, rail.at(rail.y_max()).z, rail.y_max(), track.gauge_height);
}

Built<Wheelset> build_wheelset(const Parameters& p, const std::string& label) {
  Built<Profile> profile = build_profile(p, true, label);
  if (!profile.value) return {{}, profile.problem, profile.key, profile.place};
  Wheelset w;
  w.wheel = std::move(*profile.value);
  const auto done = [&] {
    Built<Wheelset> out{std::move(w)};
    out.doubts = std::move(profile.doubts);
    return out;
  };
  w.geometry.radius = p.number("radius");
  w.geometry.flange_back = p.number("flange_back");
  w.geometry.tape_circle = p.number("tape_circle");
  if (p.has("mass") != p.has("inertia"))
    return {{}, label + ": mass and inertia are given together or not at all", p.has("mass") ? "mass" : "inertia"};
  if (p.has("mass")) {
    w.mass = p.number("mass");
    w.inertia = p.vec3("inertia");
  }
  if (p.has("mass") && !(w.inertia.minCoeff() > 0.0 && 2.0 * w.inertia.maxCoeff() <= w.inertia.sum()))
    return {{}, label + ": moments of inertia are positive, none larger than the sum of the others", "inertia"};
  const bool flat = p.has("flat.wheel"), oval = p.has("out_of_round.wheel");
  if (flat && oval) return {{}, label + ": write one of flat and out_of_round", "out_of_round"};
  if (flat && !p.has("flat.length")) return {{}, label + " flat: needs its length (m)", "flat"};
  if (oval && !p.has("out_of_round.amplitude"))
    return {{}, label + " out_of_round: needs its amplitude (m)", "out_of_round"};
  if (flat) {
    w.defect.flat_length = p.number("flat.length");
    w.defect.flat_angle = degree * p.number("flat.angle_deg");
    set_defect(p, "flat", w.defect);
  }
  if (oval) {
    w.defect.amplitude = p.number("out_of_round.amplitude");
    w.defect.order = static_cast<int>(p.integer("out_of_round.order"));
    set_defect(p, "out_of_round", w.defect);
  }
  return done();
}

Built<Track> build_track(const Parameters& p, const std::string& label) {
  Built<Profile> profile = build_profile(p, false, label);
  if (!profile.value) return {{}, profile.problem, profile.key, profile.place};
  TrackCurve curve;
  if (p.has("curve.start")) {
    if (!p.has("curve.radius") || std::abs(p.number("curve.radius")) < 50.0)
      return {{}, label + " curve: needs a radius of at least 50 m, negative to the left", "curve"};
    curve = {p.number("curve.radius"), p.number("curve.start"), p.number("curve.transition"),
             p.number("curve.superelevation")};
    if (curve.transition > std::abs(curve.radius))
      return {{}, label + " curve: the transition is longer than the radius", "curve"};
  }
  Track t(std::move(*profile.value), {}, curve);
  t.geometry.gauge = p.number("gauge");
  const auto done = [&] {
    Built<Track> out{std::move(t)};
    out.doubts = std::move(profile.doubts);
    return out;
  };
  if (!p.has("irregularity.lateral")) return done();
  const bool sine = p.has("irregularity.wavelength"), measured = p.has("irregularity.file");
  const SinusoidalTrack wave{p.number("irregularity.lateral"), p.number("irregularity.vertical"),
                             p.number("irregularity.cross_level"), p.number_or("irregularity.wavelength", 1.0)};
  if (sine == measured) return {{}, label + " irregularity: write one of file and wavelength", "irregularity"};
  if (sine) {
    t.wave = wave;
    return done();
  }
  if (wave.lateral != 0.0 || wave.vertical != 0.0 || wave.cross_level != 0.0)
    return {{}, label + " irregularity: amplitudes belong to a wavelength, not to a file", "irregularity"};
  const std::string& path = p.text("irregularity.file");
  if (!exists(path)) return {{}, label + " irregularity file: there is no file '" + path + "'", "irregularity.file"};
  MeasuredFile file = read_irregularity(read_whole_file(path));
  if (!file.problem.empty()) return {{}, file.problem, "irregularity.file", {path, std::max(1, file.line), 1}};
  t.measured = std::move(file.track);
  return done();
}

}  // namespace epafi
