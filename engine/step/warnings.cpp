#include "engine/step/warnings.h"

#include <algorithm>
#include <cstdio>

namespace epafi {

namespace {

/// What of a warning is a number.
struct WarningNumbers {
  std::uint64_t first_step, worst_step, times;
  double first_time, value;
  std::uint64_t body;        ///< the number of a body, or no_body
  std::uint64_t kind, text;  ///< characters of each
};
constexpr std::uint64_t no_body = ~std::uint64_t{0};

}  // namespace

void Warnings::add(const Warning& now) {
  const auto same = [&](const Warning& w) { return w.kind == now.kind; };
  const auto found = std::find_if(all_.begin(), all_.end(), same);
  if (found == all_.end()) {
    all_.push_back(now);
    all_.back().worst_step = now.first_step;
    all_.back().times = std::max<std::uint64_t>(1, now.times);
    return;
  }
  found->times += std::max<std::uint64_t>(1, now.times);
  if (!(now.value > found->value)) return;
  found->value = now.value;
  found->text = now.text;
  found->body = now.body;
  found->worst_step = now.first_step;
}

void Warnings::visit(StateVisitor& visitor) {
  std::vector<WarningNumbers> numbers;
  std::vector<char> letters;
  for (const Warning& w : all_) {
    const std::uint64_t body = w.body ? static_cast<std::uint64_t>(*w.body) : no_body;
    numbers.push_back({w.first_step, w.worst_step, w.times, w.first_time, w.value, body, w.kind.size(), w.text.size()});
    letters.insert(letters.end(), w.kind.begin(), w.kind.end());
    letters.insert(letters.end(), w.text.begin(), w.text.end());
  }
  visitor.column("warnings/numbers", numbers);
  visitor.column("warnings/letters", letters);
  all_.clear();
  std::size_t at = 0;
  const auto word = [&](std::uint64_t size) {
    at += size;
    return std::string(letters.data() + at - size, size);
  };
  for (const WarningNumbers& n : numbers) {
    Warning w;
    w.kind = word(n.kind);
    w.text = word(n.text);
    w.first_step = n.first_step;
    w.first_time = n.first_time;
    w.worst_step = n.worst_step;
    w.value = n.value;
    w.times = n.times;
    if (n.body != no_body) w.body = static_cast<BodyId>(n.body);
    all_.push_back(std::move(w));
  }
}

std::string warning_line(const Warning& w, const std::string& body_name) {
  std::string out = w.text;
  if (!body_name.empty()) out += ", body '" + body_name + "'";
  char text[128];
  std::snprintf(text, sizeof text, " (%s step %llu, t = %.6g s", w.times > 1 ? "first in" : "in",
                static_cast<unsigned long long>(w.first_step), w.first_time);
  out += text;
  if (w.times > 1) out += "; " + std::to_string(w.times) + " times";
  if (w.worst_step != w.first_step) out += "; worst in step " + std::to_string(w.worst_step);
  return out + ")";
}

}  // namespace epafi
