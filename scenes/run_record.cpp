#include "scenes/run_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "engine/threads/parallel.h"
#include "engine/units/error.h"
#include "scenes/scene.h"

namespace epafi {

int AdaptiveStep::parts(const World& w) const {
  const double square = block_max<double>(w.size(), 0.0, [&](std::size_t i) { return w.velocity[i].squaredNorm(); });
  const double share = std::clamp(2 * std::sqrt(square) / top, least_share, 1e3);  // two bodies that meet head-on
  return std::max(1, static_cast<int>(std::ceil(longest / shortest * std::pow(share, power) * (1 - 1e-9))));
}

namespace {

/// Writes lines of words. A text is preceded by its length; numbers are hexadecimal, so that they are read back
/// exactly.
struct RecordWriter {
  std::string out;
  RecordWriter& word(const std::string& w) {
    out += w + " ";
    return *this;
  }
  RecordWriter& number(double x) {
    out += fmt::format("{:a} ", x);
    return *this;
  }
  RecordWriter& count(std::uint64_t n) {
    out += std::to_string(n) + " ";
    return *this;
  }
  RecordWriter& body(const FillBody& b) {
    count(b.shape).number(b.size);
    for (int k = 0; k < 3; ++k) number(b.position[k]).number(b.velocity[k]);
    for (int k = 0; k < 4; ++k) number(b.orientation.coeffs()[k]);
    return *this;
  }
  RecordWriter& text(const std::string& t) {
    out += std::to_string(t.size()) + ":" + t + " ";
    return *this;
  }
};

struct RecordParser {
  const std::string& in;
  std::size_t at = 0;
  [[noreturn]] static void refuse() { throw FileError("the checkpoint's record of stages is damaged"); }
  bool ends() const { return at >= in.size(); }
  std::string word() {
    const std::size_t end = in.find(' ', at);
    if (end == std::string::npos) refuse();
    std::string w = in.substr(at, end - at);
    at = end + 1;
    return w;
  }
  double number() { return std::strtod(word().c_str(), nullptr); }
  std::uint64_t count() { return std::strtoull(word().c_str(), nullptr, 10); }
  FillBody body() {
    FillBody b;
    b.shape = count();
    b.size = number();
    for (int k = 0; k < 3; ++k) {
      b.position[k] = number();
      b.velocity[k] = number();
    }
    for (int k = 0; k < 4; ++k) b.orientation.coeffs()[k] = number();
    return b;
  }
  std::string text() {
    const std::size_t colon = in.find(':', at);
    if (colon == std::string::npos) refuse();
    const std::size_t size = std::strtoull(in.c_str() + at, nullptr, 10);
    if (colon + 1 + size >= in.size()) refuse();
    std::string t = in.substr(colon + 1, size);
    at = colon + size + 2;
    return t;
  }
};

}  // namespace

std::string at_most_warning(const StageRecord& record, const StageSpec& stage) {
  return fmt::format("stage '{}' ended at its longest time, {:.6g} s: {} {} was not {} {:.6g} for {:.6g} s",
                     record.name, stage.duration, stage.until->measure, stage.until->component,
                     stage.until->above ? "above" : "below", stage.until->limit, stage.until->duration);
}

std::vector<double> RunRecord::clocks() const {
  std::vector<double> all;
  for (std::size_t k = scenes; k + 1 < stages.size(); ++k) all.push_back(stages[k].clock);
  return all;
}

std::string RunRecord::to_text() const {
  RecordWriter w;
  w.word("stage").count(stage).count(scenes);
  if (!start_run.empty()) w.word("start").text(start_run);
  for (const StageRecord& s : stages)
    w.word("record").text(s.name).number(s.from).number(s.until).number(s.clock).count(s.first_step).text(s.ended);
  for (const InsertedStage& i : inserted) {
    w.word("inserted").count(i.after).number(i.duration).number(i.output_interval).count(i.overrides.size());
    for (const std::string& o : i.overrides) w.text(o);
  }
  for (std::size_t i = 0; i < fills.size(); ++i) {
    if (fills[i].empty()) continue;
    w.word("fill").count(i).count(fills[i].size());
    for (const FillBody& b : fills[i]) w.body(b);
  }
  if (!time_step) return w.out;
  w.word("time_step").number(time_step->value).number(time_step->limit);
  w.text(time_step->reason).text(time_step->limit_reason);
  if (const auto& a = time_step->adaptive)
    w.word("adaptive").number(a->top).number(a->longest).number(a->shortest).number(a->power).number(a->least_share);
  return w.out;
}

RunRecord RunRecord::from_text(const std::string& text) {
  RunRecord r;
  RecordParser p{text};
  while (!p.ends()) {
    const std::string key = p.word();
    if (key == "stage") {
      r.stage = p.count();
      r.scenes = p.count();
    } else if (key == "start") {
      r.start_run = p.text();
    } else if (key == "record") {
      StageRecord s;
      s.name = p.text();
      s.from = p.number();
      s.until = p.number();
      s.clock = p.number();
      s.first_step = p.count();
      s.ended = p.text();
      r.stages.push_back(s);
    } else if (key == "inserted") {
      InsertedStage i;
      i.after = p.count();
      i.duration = p.number();
      i.output_interval = p.number();
      for (std::uint64_t k = p.count(); k > 0; --k) i.overrides.push_back(p.text());
      r.inserted.push_back(i);
    } else if (key == "fill") {
      const std::size_t i = p.count();
      r.fills.resize(std::max(r.fills.size(), i + 1));
      for (std::uint64_t k = p.count(); k > 0; --k) r.fills[i].push_back(p.body());
    } else if (key == "time_step") {
      TimeStep t;
      t.value = p.number();
      t.limit = p.number();
      t.reason = p.text();
      t.limit_reason = p.text();
      r.time_step = t;
    } else if (key == "adaptive" && r.time_step) {
      AdaptiveStep a;
      for (double* x : {&a.top, &a.longest, &a.shortest, &a.power, &a.least_share}) *x = p.number();
      r.time_step->adaptive = a;
    } else {
      RecordParser::refuse();
    }
  }
  return r;
}

}  // namespace epafi
