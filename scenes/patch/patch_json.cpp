#include <fmt/format.h>

#include <algorithm>

#include "scenes/patch/evaluate_patch.h"
#include "viz_export/files/json_writer.h"

namespace epafi {
namespace {

using Members = std::vector<std::pair<std::string, std::string>>;

std::string object(const Members& members, const char* separator = ", ") {
  std::string out;
  for (const auto& [key, value] : members) out += (out.empty() ? "" : separator) + json_text(key) + ": " + value;
  return "{" + out + "}";
}

std::string contact_json(const PatchContact& c, bool friction) {
  Members m{{"y_wheel", json_number(c.y_wheel)},
            {"y_rail", json_number(c.y_rail)},
            {"point",
             "[" + json_number(c.point.x()) + ", " + json_number(c.point.y()) + ", " + json_number(c.point.z()) + "]"},
            {"angle", json_number(c.angle)},
            {"semi_axes", "[" + json_number(c.semi_axes.a) + ", " + json_number(c.semi_axes.b) + "]"},
            {"area", json_number(c.area)},
            {"max_pressure", json_number(c.max_pressure)},
            {"normal_force", json_number(c.normal_force)}};
  if (friction) {
    m.push_back({"fx", json_number(c.force.fx)});
    m.push_back({"fy", json_number(c.force.fy)});
    m.push_back({"mz", json_number(c.force.mz)});
  }
  return object(m);
}

std::string list_json(const std::vector<std::string>& texts) {
  std::string out;
  for (const auto& text : texts) out += (out.empty() ? "" : ", ") + json_text(text);
  return "[" + out + "]";
}

std::string result_json(const PatchResult& r) {
  std::string contacts;
  for (const auto& c : r.contacts) contacts += (contacts.empty() ? "" : ", ") + contact_json(c, r.friction);
  Members m{{"normal", json_text(r.normal)}};
  if (r.friction) m.push_back({"tangential", json_text(r.tangential)});
  m.push_back({"normal_force", json_number(r.normal_force)});
  m.push_back({"approach", json_number(r.approach)});
  m.push_back({"contacts", "[" + contacts + "]"});
  m.push_back({"max_pressure", json_number(r.max_pressure)});
  m.push_back({"area", json_number(r.area)});
  if (r.friction) {
    m.push_back({"fx", json_number(r.force.fx)});
    m.push_back({"fy", json_number(r.force.fy)});
    m.push_back({"mz", json_number(r.force.mz)});
    if (r.stick_share >= 0.0) m.push_back({"stick_share", json_number(r.stick_share)});
    m.push_back({"wear_number", json_number(r.wear_number)});
  }
  if (r.fatigue_index) m.push_back({"fatigue_index", json_number(*r.fatigue_index)});
  if (r.pressure_over_yield) m.push_back({"pressure_over_yield", json_number(*r.pressure_over_yield)});
  m.push_back({"milliseconds", json_number(r.milliseconds)});
  m.push_back({"error_estimate", json_number(r.error_estimate)});
  m.push_back({"valid", r.reasons.empty() ? "true" : "false"});
  m.push_back({"reasons", list_json(r.reasons)});
  if (!r.notes.empty()) m.push_back({"notes", list_json(r.notes)});
  return "  " + object(m);
}

}  // namespace

std::string patch_json(const std::vector<PatchResult>& results) {
  std::string all;
  for (const auto& r : results) all += (all.empty() ? "" : ",\n") + result_json(r);
  return "[\n" + all + "\n]\n";
}

std::string patch_table(const std::vector<PatchResult>& results) {
  std::string out =
      fmt::format("{:<16}{:<20}{:>12}{:>11}{:>11}{:>10}{:>13}{:>13}{:>8}{:>9}{:>9}  {}\n", "normal", "tangential",
                  "N [N]", "delta [m]", "p0 [Pa]", "area [m2]", "Fx [N]", "Fy [N]", "stick", "ms", "error", "valid");
  for (const auto& r : results) {
    out += fmt::format("{:<16}{:<20}", r.normal, r.friction ? r.tangential : "-");
    out += r.solved()
               ? fmt::format("{:>12.5g}{:>11.4g}{:>11.4g}{:>10.3g}", r.normal_force, r.approach, r.max_pressure, r.area)
               : fmt::format("{:>12}{:>11}{:>11}{:>10}", "-", "-", "-", "-");
    out += r.friction && r.solved() ? fmt::format("{:>13.5g}{:>13.5g}{:>8}", r.force.fx, r.force.fy,
                                                  r.stick_share >= 0.0 ? fmt::format("{:.3f}", r.stick_share) : "-")
                                    : fmt::format("{:>13}{:>13}{:>8}", "-", "-", "-");
    out += fmt::format("{:>9.3g}{:>9.1e}  {}\n", r.milliseconds, r.error_estimate, r.reasons.empty() ? "yes" : "NO");
    for (const auto& reason : r.reasons) out += "                  " + reason + "\n";
  }
  return out;
}

std::string patch_csv(const std::vector<PatchResult>& results, bool units) {
  std::string out =
      units ? "normal,tangential,normal_force [N],approach [m],max_pressure [Pa],area [m2],fx [N],fy [N],mz [N m],"
              "stick_share,wear_number [N],milliseconds,error_estimate,valid,reasons\n"
            : "normal,tangential,normal_force,approach,max_pressure,area,fx,fy,mz,"
              "stick_share,wear_number,milliseconds,error_estimate,valid,reasons\n";
  for (const PatchResult& r : results) {
    out += fmt::format("{},{},", r.normal, r.friction ? r.tangential : "");
    out += r.solved() ? fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},", r.normal_force, r.approach, r.max_pressure, r.area)
                      : ",,,,";
    const bool friction = r.friction && r.solved();
    out += friction ? fmt::format("{:.6g},{:.6g},{:.6g},", r.force.fx, r.force.fy, r.force.mz) : ",,,";
    out += friction && r.stick_share >= 0.0 ? fmt::format("{:.4g},", r.stick_share) : ",";
    out += friction ? fmt::format("{:.6g},", r.wear_number) : ",";
    std::string reasons;
    for (const std::string& text : r.reasons) reasons += (reasons.empty() ? "" : "; ") + text;
    std::replace(reasons.begin(), reasons.end(), '"', '\'');
    out += fmt::format("{:.3g},{:.2g},{},\"{}\"\n", r.milliseconds, r.error_estimate, r.reasons.empty() ? "yes" : "no",
                       reasons);
  }
  return out;
}

}  // namespace epafi
