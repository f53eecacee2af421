#include "viz_export/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/units/error.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/files/page_target.h"
#include "viz_export/files/run_folder.h"
#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/stored_run.h"
#include "viz_export/measures/measure_units.h"
#include "viz_export/measures/telling_rows.h"
#include "viz_export/report/charts.h"
#include "viz_export/report/html_text.h"
#include "viz_export/report/parts_folder.h"
#include "viz_export/report/report_folder.h"
#include "viz_export/report/report_style.h"
#include "viz_export/report/run_facts.h"
#include "viz_export/view/page.h"
#include "viz_export/view/render_run.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

std::string escaped(const std::string& text) { return html_escaped(text); }

/// What the parts of the page share.
struct Page {
  const fs::path& folder;
  const FlatJson& summary;
  const StoredRun& run;
  const ViewSource& source;
  const fs::path& parts;  ///< folder for files on the way
  bool drawn = true;      ///< gnuplot is there
  std::string html{};
  std::vector<std::string> notes{};  ///< on the pictures: where the camera stands that sees no body, dots

  std::string number(const std::string& name, const char* format = "{:.4g}") const {
    const auto value = summary.number(name);
    return value ? fmt::format(fmt::runtime(format), *value) : "-";
  }
  void card(const std::string& value, const std::string& label, const char* kind = "") {
    html += fmt::format("<div class='card'><b class='{}'>{}</b><span>{}</span></div>", kind, escaped(value),
                        escaped(label));
  }
  void figure(const std::string& inner, const std::string& caption) {
    html += "<figure>" + inner + "<figcaption>" + escaped(caption) + "</figcaption></figure>";
  }
};

/// Note at the top for an unfinished run, and what the page then shows.
void state(Page& p) {
  const std::string status = p.summary.text("status"), cut = p.source.cut_text();
  std::string text;
  if (status == "running")
    text = fmt::format("The run goes on: this page shows it up to t = {} s.", p.number("simulated_time", "{:.6g}"));
  if (!cut.empty()) {
    text =
        "T" + cut.substr(1) + ". This page is made of what it wrote until then; maxima over all steps are not known. ";
    text += fs::exists(p.folder / "checkpoint.h5")
                ? "`epafi resume " + p.folder.string() + "` goes on from its last checkpoint."
                : "It wrote no checkpoint: `epafi run` begins anew ([run] checkpoint_interval writes some).";
  }
  if (const std::string stop = p.source.stop_text(); cut.empty() && !stop.empty())
    text = "The run has ended early: " + stop + ".";
  if (!text.empty()) p.html += "<p class='warning'>" + escaped(text) + "</p>";
}

/// Text as "bodies at the end, 503 taken out"; zero counts are left out.
std::string bodies_label(const Page& p) {
  const auto removed = p.summary.number("bodies_removed").value_or(0.0),
             lost = p.summary.number("bodies_lost").value_or(0.0);
  std::string label = removed > 0 || lost > 0 ? "bodies at the end" : "bodies";
  if (removed > 0) label += ", " + p.number("bodies_removed", "{:.0f}") + " taken out on the way";
  if (lost > 0) label += ", " + p.number("bodies_lost", "{:.0f}") + " lost";
  return label;
}

void head(Page& p) {
  const std::string status = p.summary.text("status");
  p.html += "<h1>" + escaped(p.run.title()) + "</h1>";
  state(p);
  std::string about = p.summary.text("scene");
  about += (about.empty() ? "Epafi " : " \u00b7 Epafi ") + p.run.version();
  if (const std::string hash = p.summary.text("state_hash"); !hash.empty()) about += " \u00b7 state " + hash;
  p.html += "<p class='sub'>" + escaped(about) + "</p>";
  p.html += "<div class='cards'>";
  const bool completed = status == "completed", goes_on = status == "running" || status == "cut";
  p.card(status == "cut" ? "cut off" : status, "status", completed ? "ok" : "no");
  p.card(p.number("simulated_time", "{:.6g}") + " s",
         goes_on ? "simulated so far"
                 : "simulated, in " + p.number("steps", "{:.0f}") + " steps of " + p.number("time_step") + " s");
  if (p.summary.number("wall_time"))
    p.card(p.number("wall_time") + " s", "wall time, " + p.number("threads", "{:.0f}") +
                                             (p.summary.number("threads") == 1.0 ? " thread" : " threads"));
  p.card(p.number("bodies", "{:.0f}"), bodies_label(p));
  for (const auto& [name, label] : {std::pair{"contacts_mean", "contacts in the mean"},
                                    {"energy.relative_error", "energy error"},
                                    {"overlap.max_relative", "deepest overlap over radius, worst step"},
                                    {"residual.max", "residual, worst step"}})
    if (p.summary.number(name)) p.card(p.number(name, "{:.3g}"), label);
  if (p.summary.number("unconverged_steps").value_or(0.0) > 0.0)
    p.card(p.number("unconverged_steps", "{:.0f}"), "steps above the solver's tolerance");
  p.html += "</div>";
  if (const std::string failure = p.summary.text("failure"); !failure.empty())
    p.html += "<p class='no'>" + escaped(failure) + "</p>";
}

void warnings(Page& p) {
  for (const auto& [name, text] : p.summary.texts)
    if (name.starts_with("warnings.")) p.html += "<p class='warning'>" + escaped(text) + "</p>";
}

/// Key of one stage's value in the summary.
std::string stage_key(std::size_t k, const char* what) { return fmt::format("stages.{}.{}", k, what); }

/// The stages of the run, where the scene has any.
void acts(Page& p) {
  if (!p.summary.number(stage_key(0, "from"))) return;
  p.html +=
      "<h2>Stages</h2><table><tr><th>stage</th><th class='n'>from [s]</th><th class='n'>until [s]</th><th>ended by</th>"
      "</tr>";
  for (std::size_t k = 0; p.summary.number(stage_key(k, "from")); ++k) {
    const std::string ended = p.summary.text(stage_key(k, "ended"));
    p.html += fmt::format("<tr><td>{}</td><td class='n'>{}</td><td class='n'>{}</td><td>{}</td></tr>",
                          escaped(p.summary.text(stage_key(k, "name"))), p.number(stage_key(k, "from"), "{:.6g}"),
                          p.number(stage_key(k, "until"), "{:.6g}"), ended == "at_most" ? "its longest time" : ended);
  }
  p.html += "</table>";
}

/// ", stage 'settle'" where the run has stages.
std::string stage_at(const Page& p, double time) {
  for (std::size_t k = 0; p.summary.number(stage_key(k, "from")); ++k)
    if (time <= p.summary.number(stage_key(k, "until")).value_or(0.0) * (1.0 + 1e-9))
      return ", stage '" + p.summary.text(stage_key(k, "name")) + "'";
  return {};
}

/// Adds the last frame of each stage that has none shown, up to the number that a page can hold.
std::vector<std::size_t> with_each_stage(const Page& p, const std::vector<double>& times,
                                         std::vector<std::size_t> shown) {
  constexpr std::size_t most = 24;
  std::map<std::string, std::size_t> last;  // frame of each stage
  for (std::size_t k = 0; k < times.size(); ++k) last[stage_at(p, times[k])] = k;
  for (const std::size_t k : shown) last.erase(stage_at(p, times[k]));
  for (const auto& [stage, k] : last)
    if (!stage.empty() && shown.size() < most) shown.push_back(k);
  std::sort(shown.begin(), shown.end());
  return shown;
}

/// Six frames from one camera, at least one per stage, chosen by the changes between them; where contacts are few, also
/// those of the last frame.
void pictures(Page& p, const ViewSource& source) {
  if (source.times().empty()) return;
  const Overview overview = look_over(source);
  RenderOptions options;
  options.width = 720;
  options.height = 480;
  options.title = false;  // above the page
  options.letters = report_letters;
  p.html += "<h2>Pictures</h2><div class='grid three'>";
  RunPainter painter(source, overview, options);
  const auto add = [&](RunPainter& by, std::size_t k, const std::string& what) {
    const std::string strays = outside_text(by.outside(source.frame(k)));
    p.figure("<img alt='bodies' src='data:image/png;base64," + base64(png_of(by.paint(k))) + "'/>",
             fmt::format("t = {} s{}{}{}", time_text(source.times(), source.times()[k]), stage_at(p, source.times()[k]),
                         what, strays.empty() ? "" : ", " + strays));
  };
  const std::vector<std::size_t> shown = with_each_stage(p, source.times(), telling_frames(source, 6));
  for (const std::size_t k : shown) add(painter, k, "");
  p.notes = view_notes(source, "", "");
  std::string blind, dots;  // at all times
  for (const std::size_t k : shown) {
    const ViewFrame frame = source.frame(k);
    if (k == shown.front() || !blind.empty()) blind = painter.blind_text(frame);
    if (k == shown.front() || !dots.empty()) dots = painter.dots_text(frame);
  }
  for (const std::string& note : {blind, dots})
    if (!note.empty()) p.notes.push_back(note);
  constexpr std::size_t few = 4000;
  const std::size_t contacts = source.frame(shown.back()).contacts.size();
  if (contacts > 0 && contacts <= few) {
    options.contacts = true;
    RunPainter chains(source, overview, options);
    add(chains, shown.back(),
        fmt::format(", {} contact{}, as wide as {} force", contacts, contacts > 1 ? "s" : "",
                    contacts > 1 ? "their" : "its"));
  }
  p.html += "</div>";
}

/// Embeds the page of `epafi view`.
void three_dimensions(Page& p, const ViewSource& source) {
  if (source.times().empty() || page_parts().three[0] == '\0') return;
  constexpr std::size_t most = 8'000'000;
  WrittenPage about;
  const std::string page = complete_page(source, most, about);
  p.html += "<h2>In three dimensions</h2><iframe title='the run in three dimensions' loading='lazy' srcdoc=\"" +
            escaped(page) + "\"></iframe>";
}

constexpr std::size_t curves_of_plot = 8, most_plots = 4;  // of a quantity

/// Curves of one quantity.
struct Course {
  std::string title, axis;
  std::vector<PlotLine> lines;
};

/// Plots curves, eight per plot; a sample of them where there are very many, as of fine profiles. False without
/// gnuplot.
bool plot(Page& p, const std::string& file, Course course) {
  const std::size_t all = course.lines.size(), most = curves_of_plot * most_plots;
  if (all > most) {
    std::vector<PlotLine> some;
    for (std::size_t k = 0; k < curves_of_plot; ++k)
      some.push_back(std::move(course.lines[k * (all - 1) / (curves_of_plot - 1)]));
    course.lines = std::move(some);
  }
  const std::size_t plots = (course.lines.size() + curves_of_plot - 1) / curves_of_plot;
  for (std::size_t k = 0; k < plots; ++k) {
    const auto first = course.lines.begin() + static_cast<std::ptrdiff_t>(k * curves_of_plot);
    const auto left = static_cast<std::size_t>(course.lines.end() - first);
    const LinePlot part{course.title,
                        "time [s]",
                        course.axis,
                        {first, first + static_cast<std::ptrdiff_t>(std::min(left, curves_of_plot))}};
    const fs::path path = p.parts / fmt::format("{}_{}", file, k);
    if (!draw(part, path)) return false;
    std::string caption = course.title + ": " + course.axis;
    if (plots > 1) caption += fmt::format(" ({} of {})", k + 1, plots);
    if (all > most)
      caption += fmt::format("; {} of {} curves are drawn, measures.csv has all", course.lines.size(), all);
    p.figure("<img alt=\"" + escaped(course.title) + "\" src='data:image/svg+xml;base64," +
                 base64(read_whole_file(fs::path(path) += ".svg")) + "'/>",
             caption);
  }
  return true;
}

/// Plots for each quantity of the measure, with a curve for each component that changes.
void curves(Page& p, const std::string& name, const std::string& title, const StoredMeasure& m) {
  std::map<std::string, std::vector<PlotLine>> by_axis;
  const std::size_t width = m.components.size();
  std::string still;
  for (std::size_t c = 0; c < width; ++c) {
    PlotLine line{m.components[c], {}, {}};
    bool moves = false;
    for (const std::size_t k : telling_rows(m, c, 2000)) {
      const double v = m.values[k * width + c];
      if (!std::isfinite(v)) continue;
      line.points.push_back({m.times[k], v});
      moves = moves || v != line.points.front()[1];
    }
    if (moves)
      by_axis[axis_label(measure_unit(m.kind, m.components[c]))].push_back(std::move(line));
    else
      still += (still.empty() ? "" : ", ") + m.components[c] +
               (line.points.empty() ? " (no number)" : fmt::format(" = {:.6g}", line.points.front()[1]));
  }
  if (!still.empty())
    p.html +=
        "<p class='sub'>" + escaped(title) + ": without a curve, as it does not change: " + escaped(still) + "</p>";
  int number = 0;
  for (auto& [axis, lines] : by_axis)
    p.drawn = p.drawn && plot(p, fmt::format("{}_{}", name, number++), {title, axis, std::move(lines)});
}

bool is_energy(const StoredMeasure& m) {
  const auto has = [&](const char* c) {
    return std::find(m.components.begin(), m.components.end(), c) != m.components.end();
  };
  return has("kinetic") && has("relative_error");
}

/// Energies of the measure of that kind where the scene has one, else the kinetic energy of the snapshots.
StoredMeasure energies(const Page& p) {
  for (const StoredMeasure& m : p.source.measures())
    if (is_energy(m)) return m;
  StoredMeasure kinetic{"energy", "energy", {"kinetic"}, {}, {}};
  for (std::size_t k = 0; k < p.run.snapshots(); ++k) {
    const StoredSnapshot s = p.run.snapshot(k);
    double sum = 0;
    for (const BodyRecord& b : s.bodies) sum += b.kinetic_energy;
    kinetic.times.push_back(s.stamp.time);
    kinetic.values.push_back(sum);
  }
  return kinetic;
}

void energy(Page& p) {
  p.html += "<h2>Energy balance</h2><div class='grid'><div><table>";
  for (const char* part :
       {"kinetic", "potential", "elastic", "dissipated", "gained", "work", "correction", "relative_error"}) {
    const auto value = p.summary.number(std::string("energy.") + part);
    if (!value) continue;
    const bool error = std::string(part) == "relative_error";
    p.html += fmt::format("<tr><td>{}</td><td class='n'>{:.6g}{}</td></tr>",
                          error ? "relative error of the ledger" : part, *value, error ? "" : " J");
  }
  p.html += "</table></div>";
  const StoredMeasure m = energies(p);
  curves(p, "energy", m.components.size() > 1 ? "energy over time" : "kinetic energy of the snapshots", m);
  p.html += "</div>";
}

void measures(Page& p) {
  const auto all = p.source.measures();
  if (all.empty()) return;
  p.html += "<h2>Measures</h2><div class='grid'>";
  for (std::size_t k = 0; k < all.size(); ++k)
    if (!is_energy(all[k])) curves(p, fmt::format("measure_{}", k), all[k].name, all[k]);
  p.html +=
      "</div><table><tr><th>measure</th><th>component</th><th class='n'>last</th><th class='n'>smallest</th><th "
      "class='n'>largest</th></tr>";
  for (const auto& m : all)
    for (const auto& c : m.components) {
      const std::string at = "measures." + m.name + "." + c + ".";
      if (!p.summary.number(at + "last") && !p.summary.number(at + "max")) continue;
      p.html +=
          fmt::format("<tr><td>{}</td><td>{}</td><td class='n'>{}</td><td class='n'>{}</td><td class='n'>{}</td></tr>",
                      escaped(m.name), escaped(c), p.number(at + "last", "{:.6g}"), p.number(at + "min", "{:.6g}"),
                      p.number(at + "max", "{:.6g}"));
    }
  p.html += "</table>";
}

void quality(Page& p) {
  if (!p.summary.number("steps")) return;  // known at the end of a run alone
  p.html +=
      "<h2>Overlap and checks</h2><table><tr><th>quantity</th><th class='n'>value</th><th "
      "class='n'>bound</th><th></th></tr>";
  for (const auto& [name, text] : {std::pair{"overlap.max", "deepest overlap, worst step [m]"},
                                   {"overlap.mean", "mean overlap, last tenth of the run [m]"},
                                   {"overlap.max_relative", "deepest over bounding radius, worst step"},
                                   {"momentum_error", "momentum error"},
                                   {"residual.max", "residual, worst step"},
                                   {"residual.mean", "residual, mean"},
                                   {"iterations.mean", "iterations, mean"}})
    if (p.summary.number(name))
      p.html += fmt::format("<tr><td>{}</td><td class='n'>{}</td><td></td><td></td></tr>", text, p.number(name));
  for (const auto& [name, value] : p.summary.numbers) {
    if (name.rfind("checks.", 0) != 0 || !name.ends_with(".value")) continue;
    const std::string check = name.substr(7, name.size() - 13);
    const bool ok = p.summary.number("checks." + check + ".ok").value_or(0) > 0;
    p.html += fmt::format(
        "<tr><td>[bounds] {}</td><td class='n'>{:.4g}</td><td class='n'>{}</td><td class='{}'>{}</td></tr>",
        escaped(check), value, p.number("checks." + check + ".bound"), ok ? "ok" : "no", ok ? "held" : "violated");
  }
  p.html += "</table>";
}

void stages(Page& p) {
  if (!p.summary.number("ns_per_body_step")) return;
  p.html += "<h2>Where the time went</h2><table>";
  double total = 0;
  for (const auto& [name, value] : p.summary.numbers)
    if (name.rfind("stage_seconds.", 0) == 0) total += value;
  for (const auto& [name, value] : p.summary.numbers)
    if (name.rfind("stage_seconds.", 0) == 0)
      p.html += fmt::format(
          "<tr><td>{}</td><td class='n'>{:.3g} s</td><td style='width:60%'><div class='bar' "
          "style='width:{:.1f}%'></div></td></tr>",
          name.substr(14), value, total > 0 ? 100 * value / total : 0.0);
  p.html +=
      fmt::format("</table><p class='sub'>{} ns per body and step, {} MB at the peak</p>", p.number("ns_per_body_step"),
                  fmt::format("{:.0f}", p.summary.number("peak_memory_bytes").value_or(0) / 1e6));
}

void settings(Page& p) {
  p.html += "<h2>Settings</h2>";
  if (const std::string o = p.run.overrides(); !o.empty()) p.html += "<p>Overrides:</p><pre>" + escaped(o) + "</pre>";
  p.html += "<pre>" + escaped(p.run.scene_text()) + "</pre>";
}

}  // namespace

fs::path write_report(const fs::path& folder, const fs::path& wanted) {
  const bool is_run = fs::exists(folder / "run.h5") || was_run(folder);
  if (!is_run && has_tables(folder)) return write_folder_report(folder, wanted);
  if (!is_run) throw FileError(no_run_text(folder, "report"));
  const fs::path target = wanted.empty() ? folder / "report.html" : wanted;
  require_page_target(target);
  const auto source = open_run(folder, "report");
  const FlatJson summary = run_facts(folder, *source);
  const StoredRun run(folder / "run.h5");
  const PartsFolder parts(target);
  Page page{folder, summary, run, *source, parts.path()};
  head(page);
  warnings(page);
  const std::size_t below_warnings = page.html.size();
  acts(page);
  pictures(page, *source);
  three_dimensions(page, *source);
  energy(page);
  measures(page);
  quality(page);
  stages(page);
  settings(page);
  if (!page.drawn) page.html += "<p class='no'>gnuplot is not installed: the curves are missing.</p>";
  std::string unread;  // what could not be read or seen is known by now
  for (const auto& list : {page.notes, source->warnings()})
    for (const std::string& text : list) unread += "<p class='warning'>" + escaped(text) + "</p>";
  page.html.insert(below_warnings, unread);
  write_whole_file(target,
                   {"<!doctype html><html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
                    "content='width=device-width'><title>",
                    escaped(run.title()), "</title>", report_style, "</head><body>", page.html, "</body></html>\n"});
  return target;
}

}  // namespace epafi
