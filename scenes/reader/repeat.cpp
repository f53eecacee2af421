#include "scenes/reader/repeat.h"

#include <algorithm>
#include <cmath>

namespace epafi {
namespace {

constexpr double most_copies = 1e7;  // a repeat beyond is a slip of the keyboard: 10 million bodies take 2 GB

bool speaks_of_index(const std::string& text) {
  return mentions(text, "i") || mentions(text, "j") || mentions(text, "k");
}

bool is_expression(const std::string& text) { return text.find('=') != std::string::npos; }

/// Name and index expressions of "ball[i + 1]"; empty where there is no index.
struct IndexedName {
  std::string name, inside;
};

std::optional<IndexedName> indexed_name(const Node& node) {
  if (node.type != Node::Type::text || is_expression(node.text) || node.text.empty() || node.text.back() != ']')
    return std::nullopt;
  const std::size_t open = node.text.find('[');
  if (open == std::string::npos || open == 0) return std::nullopt;
  const std::string inside = node.text.substr(open + 1, node.text.size() - open - 2);
  if (!speaks_of_index(inside)) return std::nullopt;
  return IndexedName{node.text.substr(0, open), inside};
}

/// Splits a list of expressions at commas outside parentheses.
std::vector<std::string> parts_at_commas(const std::string& text) {
  std::vector<std::string> parts{""};
  int depth = 0;
  for (const char c : text) {
    depth += (c == '(') - (c == ')');
    if (c == ',' && depth == 0)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

/// The name with its indices evaluated; unchanged where they are wrong, which is reported.
std::string resolved(Reading& reading, const Node& node, const IndexedName& name, const std::string& label) {
  std::string numbers;
  for (const std::string& part : parts_at_commas(name.inside)) {
    Node expression = node;
    expression.text = "= " + part;
    expression.quoted_inline = false;
    const auto value = reading.number(expression, "", label + " '" + node.text + "'");
    if (!value) return node.text;
    if (*value < 0.0 || *value != std::floor(*value) || *value > most_copies) {
      reading.error(node.place, label + " '" + node.text + "': expected a whole number from 0 in the brackets, found " +
                                    format_number(*value));
      return node.text;
    }
    numbers += (numbers.empty() ? "" : ",") + format_number(*value);
  }
  return name.name + "[" + numbers + "]";
}

void resolve_names(Reading& reading, Node& node, const std::string& label) {
  if (const auto name = indexed_name(node)) node.text = resolved(reading, node, *name, label);
  for (Node& item : node.items) resolve_names(reading, item, label);
  for (Member& member : node.members) resolve_names(reading, member.value, label);
}

/// Sets the name of a copy: NAME[i], NAME[i,j] ...
void set_name(Node& copy, const std::string& other_name, const Index3& at, std::size_t dimensions) {
  std::string index;
  for (std::size_t d = 0; d < dimensions; ++d) index += (d > 0 ? "," : "") + std::to_string(at[d]);
  for (Member& member : copy.members) {
    if (member.key != "name") continue;
    if (member.value.type == Node::Type::text) member.value.text += "[" + index + "]";
    return;
  }
  Node name;
  name.type = Node::Type::text;
  name.text = other_name + "[" + index + "]";
  name.place = copy.place;
  copy.members.push_back({"name", copy.place, std::move(name)});
}

bool stands_with(const Place& a, const Place& b) {
  return a.file == b.file && a.line == b.line && a.column == b.column;
}

/// Drops problems of a later copy that the first one has reported at the same place.
void drop_repeated(std::vector<Problem>& problems, std::size_t first, std::size_t own) {
  const auto repeated = [&](const Problem& p) {
    return std::any_of(problems.begin() + static_cast<std::ptrdiff_t>(first),
                       problems.begin() + static_cast<std::ptrdiff_t>(own),
                       [&](const Problem& q) { return stands_with(q.place, p.place) && q.level == p.level; });
  };
  const auto end = std::remove_if(problems.begin() + static_cast<std::ptrdiff_t>(own), problems.end(), repeated);
  problems.erase(end, problems.end());
}

}  // namespace

bool uses_index(const Node& node) {
  if (node.type == Node::Type::text) return is_expression(node.text) && speaks_of_index(node.text);
  return std::ranges::any_of(node.items, uses_index) ||
         std::ranges::any_of(node.members, [](const Member& m) { return uses_index(m.value); });
}

Node part_of(const Node& table, const std::function<bool(const Member&)>& keep) {
  Node part;
  part.place = table.place;
  part.stage = table.stage;
  for (const auto& member : table.members)
    if (keep(member)) part.members.push_back(member);
  return part;
}

std::vector<std::size_t> read_repeat(Reading& reading, const Node& item, const std::string& label,
                                     const std::vector<Field>& fields) {
  const auto field = std::ranges::find(fields, "repeat", &Field::name);
  const TableValues values =
      read_table(part_of(item, [](const Member& m) { return m.key == "repeat"; }), label, {*field}, reading);
  if (!values.has("repeat")) return {};
  const auto& counts = values.numbers("repeat");
  double product = 1.0;
  for (const double c : counts) product *= c;
  if (counts.empty() || counts.size() > 3)
    reading.error(values.place_of("repeat"), label + " repeat: expected n or [l, m, n]");
  else if (product > most_copies)
    reading.error(values.place_of("repeat"), label + " repeat: more than 10 million copies");
  return std::vector<std::size_t>(counts.begin(), counts.end());
}

void set_indices(Reading& reading, const Index3& index, std::size_t dimensions) {
  constexpr const char* names[] = {"i", "j", "k"};
  reading.indices.clear();
  for (std::size_t d = 0; d < dimensions; ++d) reading.indices.emplace_back(names[d], static_cast<double>(index[d]));
}

void each_copy(Reading& reading, const Node& item, const std::string& label, const std::vector<Field>& fields,
               const std::string& other_name, const std::function<void(const Node&)>& visit) {
  if (!item.find("repeat")) return visit(item);
  const std::size_t errors = reading.errors();
  const auto counts = read_repeat(reading, item, label, fields);
  const Node plain = part_of(item, [](const Member& m) { return m.key != "repeat"; });
  const std::size_t first = reading.problems.size();
  Index3 size{1, 1, 1};
  if (reading.errors() == errors) std::ranges::copy(counts, size.begin());
  for (std::size_t n = 0; n < size[0] * size[1] * size[2] && reading.errors() == errors; ++n) {
    const Index3 at{n / (size[1] * size[2]), n / size[2] % size[1], n % size[2]};
    set_indices(reading, at, counts.size());
    Node copy = plain;
    resolve_names(reading, copy, label);
    if (reading.errors() != errors) break;
    set_name(copy, other_name, at, counts.size());
    const std::size_t own = reading.problems.size();
    visit(copy);
    drop_repeated(reading.problems, first, own);
  }
  reading.indices.clear();
}

}  // namespace epafi
