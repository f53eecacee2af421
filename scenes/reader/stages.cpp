#include "scenes/reader/stages.h"

#include <algorithm>

#include "engine/units/nearest.h"
#include "engine/units/units.h"

namespace epafi {
namespace {

const std::vector<std::string> own_keys{"name", "duration", "until"};
/// Arrays of tables: a stage appends with [[stage.measure]], or changes one entry by its name.
const std::vector<std::string> lists{"body", "bodies", "fill", "outlet", "spring", "measure"};
const std::vector<std::string> changeable{"world",  "material", "contact", "detection", "shape",  "run",    "bounds",
                                          "output", "body",     "bodies",  "fill",      "outlet", "spring", "measure"};

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

Member* find_member(Node& table, const std::string& key) {
  for (Member& member : table.members)
    if (member.key == key) return &member;
  return nullptr;
}

Node& member_of(Node& table, const std::string& key, const Node& like) {
  if (Member* found = find_member(table, key)) return found->value;
  Node empty;
  empty.type = like.type;
  empty.place = like.place;
  table.members.push_back({key, like.place, std::move(empty)});
  return table.members.back().value;
}

class Merge {
 public:
  Merge(StageDocument& out, std::size_t number, std::string label, std::vector<Problem>& problems)
      : out_(out), number_(number), label_(std::move(label)), problems_(problems) {}

  void stage(const Node& stage) {
    for (const Member& member : stage.members) {
      if (holds(own_keys, member.key)) continue;
      if (!holds(changeable, member.key)) {
        error(member.place, "unknown key '" + member.key + "' in " + label_ +
                                suggestion(member.key, own_keys_and_tables(), "known keys"));
        continue;
      }
      if (holds(lists, member.key))
        list(member);
      else
        table(member_of(out_.root, member.key, member.value), member.value, member.key);
    }
  }

 private:
  void error(const Place& place, std::string text) {
    problems_.push_back({Problem::Level::error, place, std::move(text)});
  }
  static std::vector<std::string> own_keys_and_tables() {
    std::vector<std::string> all = own_keys;
    all.insert(all.end(), changeable.begin(), changeable.end());
    return all;
  }

  /// Overrides keys of `below` by those of `above`, recursively.
  void table(Node& below, const Node& above, const std::string& path) {
    if (above.type != Node::Type::table || below.type != Node::Type::table) {
      error(above.place, label_ + " " + path + ": expected a table, found " + type_name(above.type));
      return;
    }
    for (const Member& member : above.members) {
      const std::string full = path + "." + member.key;
      if (const std::string why = refusal(below, member.key, path); !why.empty()) {
        error(member.place, label_ + " " + full + ": " + why);
        continue;
      }
      if (full == "contact.pair") {
        pairs(member_of(below, "pair", member.value), member.value);
        continue;
      }
      Member* old = find_member(below, member.key);
      const bool both = old && old->value.type == Node::Type::table && member.value.type == Node::Type::table;
      if (both)
        table(old->value, member.value, full);
      else if (old)
        *old = member;
      else
        below.members.push_back(member);
    }
  }

  static std::string refusal(Node& below, const std::string& key, const std::string& path) {
    if (path == "run" && key == "duration") return "a stage has a duration of its own: write duration = ...";
    if (path == "run" && key == "seed") return "the seed decides over bodies that are there already";
    if (path == "shape" && find_member(below, key)) return "bodies keep their shapes; give a new shape another name";
    return {};
  }

  /// Entries for two materials replace earlier ones for the same two.
  void pairs(Node& below, const Node& above) {
    if (!above.is_array_of_tables()) return error(above.place, label_ + " contact.pair: write [[stage.contact.pair]]");
    const auto between = [](const Node& pair) {
      std::vector<std::string> names;
      if (const Node* both = pair.find("between"))
        for (const Node& name : both->items) names.push_back(name.text);
      std::sort(names.begin(), names.end());
      return names;
    };
    for (const Node& item : above.items) {
      std::erase_if(below.items, [&](const Node& old) { return between(old) == between(item); });
      below.items.push_back(item);
    }
  }

  void list(const Member& member) {
    if (member.value.is_array_of_tables()) {
      Node& all = member_of(out_.root, member.key, member.value);
      for (Node item : member.value.items) {
        item.stage = number_;
        all.items.push_back(std::move(item));
      }
      return;
    }
    if (member.value.type != Node::Type::table)
      return error(member.value.place, label_ + " " + member.key + ": expected [[stage." + member.key + "]] or " +
                                           member.key + ".NAME = { ... }, found " + type_name(member.value.type));
    for (const Member& one : member.value.members) {
      const std::string path = member.key + "." + one.key;
      if (one.value.type != Node::Type::table)
        error(one.value.place, label_ + " " + path + ": expected a table, found " + type_name(one.value.type));
      else if (member.key == "body" || member.key == "bodies")
        out_.bodies.push_back({one.key, &one.value, number_, label_ + " " + path});
      else if (member.key == "fill")
        error(one.place, label_ + " " + path + ": a fill that has begun does not change; body." + one.key +
                             " = { remove = true } takes its bodies out");
      else
        one_of(member.key, one, path);
    }
  }

  /// measure.NAME = { interval = 0.1 } or { remove = true }
  void one_of(const std::string& key, const Member& change, const std::string& path) {
    Node* all = nullptr;
    if (Member* found = find_member(out_.root, key)) all = &found->value;
    std::vector<std::string> names;
    for (std::size_t k = 0; all && k < all->items.size(); ++k) {
      Node& item = all->items[k];
      const Node* name = item.find("name");
      if (!name) name = item.find("kind");  // a measure is called by its kind where it has no name
      if (!name) continue;
      names.push_back(name->text);
      if (name->text != change.key) continue;
      const Node* remove = change.value.find("remove");
      if (remove && remove->boolean) {
        all->items.erase(all->items.begin() + static_cast<std::ptrdiff_t>(k));
        return;
      }
      for (const Member& own : change.value.members) {
        if (Member* old = find_member(item, own.key))
          *old = own;
        else
          item.members.push_back(own);
      }
      return;
    }
    error(change.place, "unknown " + key + " '" + change.key + "' in " + label_ + " " + path +
                            suggestion(change.key, names, "names"));
  }

  StageDocument& out_;
  std::size_t number_;
  std::string label_;
  std::vector<Problem>& problems_;
};

Node number_node(double value, const Place& place) {
  Node node;
  node.type = Node::Type::real;
  node.real = value;
  node.place = place;
  return node;
}

/// Sets the duration of the scene to that of the stage, or to the longest one of its condition.
void set_duration(Node& root, const Node& stage) {
  const Node* duration = stage.find("duration");
  if (const Node* until = stage.find("until"); !duration && until) duration = until->find("at_most");
  Node empty;
  empty.place = stage.place;
  Node& run = member_of(root, "run", empty);
  std::erase_if(run.members, [](const Member& m) { return m.key == "duration"; });
  // errors are reported for the stage
  const bool is_text = duration && duration->type == Node::Type::text;
  const bool is_expression = is_text && duration->text.find('=') != std::string::npos;
  const bool is_time = is_expression || (is_text && read_quantity(duration->text, "s").value);
  const bool usable = duration && (duration->is_number() ? duration->real > 0.0 : is_time);
  run.members.push_back({"duration", stage.place, usable ? *duration : number_node(1.0, stage.place)});
}

}  // namespace

std::string stage_label(const Node& stage, std::size_t number) {
  const Node* name = stage.find("name");
  return "[[stage]] " + (name && name->type == Node::Type::text ? "'" + name->text + "'" : std::to_string(number + 1));
}

std::vector<Node> list_stages(const Node& root, const std::vector<InsertedStage>& inserted,
                              std::vector<Problem>& problems) {
  std::vector<Node> stages;
  const Node* written = root.find("stage");
  if (written && written->is_array_of_tables()) stages = written->items;
  if (written && !written->is_array_of_tables())
    problems.push_back({Problem::Level::error, written->place,
                        "[[stage]]: expected a list of tables, found " + std::string(type_name(written->type)) +
                            "; write [[stage]] above each"});
  const Node* run = root.find("run");
  const Node* whole = run ? run->find("duration") : nullptr;
  if (!stages.empty() && whole)
    problems.push_back({Problem::Level::error, whole->place,
                        "[run] duration stands beside [[stage]]; each stage has a duration or an until of its own"});
  for (const InsertedStage& more : inserted) {
    Node stage;
    const Place place{"--set " + more.overrides.front(), 0, 0};
    stage.place = place;
    std::string name;
    for (const std::string& one : more.overrides) {
      name += (name.empty() ? "" : ", ") + one;
      set_value(stage, one, problems);
    }
    Node text = number_node(0.0, place);
    text.type = Node::Type::text;
    text.text = name;
    stage.members.push_back({"name", place, text});
    stage.members.push_back({"duration", place, number_node(more.duration, place)});
    Node empty;
    empty.place = place;
    Node& settings = member_of(stage, "run", empty);
    if (!settings.find("output_interval"))
      settings.members.push_back({"output_interval", place, number_node(more.output_interval, place)});
    if (stages.empty()) {  // the scene itself is the first one
      Node first;
      first.place = run ? run->place : root.place;
      Node first_name = text;
      first_name.text = "start";
      first.members.push_back({"name", first.place, first_name});
      if (whole) first.members.push_back({"duration", whole->place, *whole});
      stages.push_back(first);
    }
    const std::size_t at = std::min(more.after + 1, stages.size());
    stages.insert(stages.begin() + static_cast<std::ptrdiff_t>(at), stage);
  }
  return stages;
}

StageDocument document_of_stage(const Node& root, const std::vector<Node>& stages, std::size_t stage,
                                std::vector<Problem>& problems) {
  StageDocument out;
  out.root = root;
  std::erase_if(out.root.members, [](const Member& m) { return m.key == "stage"; });
  for (std::size_t k = 0; k <= stage; ++k) Merge(out, k, stage_label(stages[k], k), problems).stage(stages[k]);
  set_duration(out.root, stages[stage]);
  return out;
}

}  // namespace epafi
