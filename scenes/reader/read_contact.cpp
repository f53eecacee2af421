/// @file read_contact.cpp  [contact], [contact.smooth], [contact.nonsmooth], [[contact.pair]], and whether they are
/// enough.
#include <algorithm>
#include <cmath>

#include "laws/smooth/asked_law.h"
#include "laws/smooth/make_smooth_contact.h"
#include "scenes/reader/parts.h"

namespace epafi {
namespace {

bool contains(const std::vector<Field>& fields, const std::string& name) {
  return std::any_of(fields.begin(), fields.end(), [&](const Field& f) { return f.name == name; });
}

/// The text of a key that decides which fields its table has; read before the table.
std::string peek(const Node& table, const std::string& key) {
  const Node* node = table.find(key);
  return node ? node->text : std::string{};
}

/// Fields of the chosen entry; of all entries where none is chosen.
std::vector<Field> fields_of(const std::vector<Entry>& entries, const std::string& chosen) {
  if (chosen.empty()) return united_fields(entries);
  const Entry* entry = find_entry(entries, chosen);
  return entry ? entry->fields : std::vector<Field>{};
}

struct Laws {
  LawChoice chosen;
  std::vector<Field> words;  ///< law, tangential, rolling
  std::vector<Field> used;   ///< by the chosen law and parts
};

/// Keeps the values of used fields; warns of written ones that are not used.
void keep_used(const TableValues& values, const std::vector<Field>& used, const std::vector<std::string>& words,
               Parameters& out, const std::string& by, Reading& reading) {
  for (const auto& field : used)
    if (values.has(field.name)) out.set(field.name, values.all().at(field.name));
  for (const auto& [name, place] : values.places) {
    if (contains(used, name) || std::find(words.begin(), words.end(), name) != words.end() || by.empty()) continue;
    reading.warning(place, name + " is not used by " + by);
  }
}

/// Warns of a table for the method that the scene does not use.
void warn_of_unused(Reading& reading, const std::string& table, const char* method) {
  if (const Node* node = find_table(reading, table))
    reading.warning(node->place, "[" + table + "] is not used by method '" + method + "'");
}

/// Of the parts that the names come to where bodies rub and roll: an entry of a normal law has those of its companions
/// too. A tangential_damping that none has is an error of its own (check_smooth).
std::vector<Field> fields_of_parts(const Registry& registry, const LawChoice& chosen) {
  MaterialPair rough;
  rough.friction = rough.rolling_friction = 1.0;
  const SmoothParts parts = smooth_parts({chosen.law, chosen.tangential, chosen.rolling, {1, {rough}}});
  const auto of = [](const std::vector<Entry>& entries, const std::string& name) {
    const Entry* entry = find_entry(entries, name);
    return entry ? entry->fields : std::vector<Field>{};
  };
  const auto companions = united_fields(registry.tangential_laws) + united_fields(registry.rolling_laws);
  std::vector<Field> own = of(registry.normal_laws, chosen.law);
  std::erase_if(own, [&](const Field& f) { return f.name != "tangential_damping" && contains(companions, f.name); });
  return own + of(registry.tangential_laws, parts.tangential) + of(registry.rolling_laws, parts.rolling);
}

Laws read_smooth(Draft& draft, bool active) {
  Reading& reading = draft.reading;
  const auto& registry = reading.registry;
  const Node& table = table_or_empty(reading, "contact.smooth");
  if (!active) warn_of_unused(reading, "contact.smooth", "nonsmooth");
  auto& contact = draft.scene.contact;
  auto fields = reading.schema.at("contact.smooth").fields;
  const LawChoice written{peek(table, "law"), peek(table, "tangential"), peek(table, "rolling")};
  const std::vector<Field> words(fields.begin(), fields.begin() + 4);  // law, tangential, rolling, locate_edges
  const auto of = [](const std::vector<Entry>& entries, const std::string& name) {
    const Entry* entry = find_entry(entries, name);
    return entry ? entry->fields : std::vector<Field>{};
  };
  const bool chosen = find_entry(registry.normal_laws, written.law) != nullptr;
  const std::vector<Field> all = words + smooth_fields(registry, written);
  const std::vector<Field> offered =
      words + of(registry.normal_laws, written.law) +
      (written.tangential.empty() ? united_fields(registry.tangential_laws)
                                  : of(registry.tangential_laws, written.tangential)) +
      (written.rolling.empty() ? united_fields(registry.rolling_laws) : of(registry.rolling_laws, written.rolling));
  const TableValues values = read_table(table, "[contact.smooth]", all, reading, chosen ? offered : all);
  contact.law = values.placed_text("law");
  contact.tangential = values.placed_text("tangential");
  contact.rolling = values.placed_text("rolling");
  contact.locate_edges = values.boolean("locate_edges");
  Laws laws{{contact.law.value, contact.tangential.value, contact.rolling.value}, words, {}};
  laws.used = fields_of_parts(registry, laws.chosen);
  keep_used(values, laws.used, {"law", "tangential", "rolling", "locate_edges"}, contact.smooth,
            active ? "law '" + contact.law.value + "'" : "", reading);
  return laws;
}

void read_nonsmooth(Draft& draft, bool active) {
  Reading& reading = draft.reading;
  const auto& solvers = reading.registry.solvers;
  const Node& table = table_or_empty(reading, "contact.nonsmooth");
  if (!active) warn_of_unused(reading, "contact.nonsmooth", "smooth");
  auto& contact = draft.scene.contact;
  const std::vector<Field> word{reading.schema.at("contact.nonsmooth").fields.front()};
  const std::string written = peek(table, "solver");
  const std::string likely = written.empty() ? std::get<std::string>(*word[0].default_value) : written;
  const TableValues values =
      read_table(table, "[contact.nonsmooth]", word + as_optional(united_fields(solvers, likely)), reading,
                 word + fields_of(solvers, likely));
  contact.solver = values.placed_text("solver");
  const Entry* entry = find_entry(solvers, contact.solver.value);
  if (!entry) return;
  keep_used(values, entry->fields, {"solver"}, contact.nonsmooth, active ? "solver '" + entry->name + "'" : "",
            reading);
  for (const auto& field : entry->fields) {
    if (active && !field.optional && !values.has(field.name) && !values.written(field.name)) {
      reading.error(values.place,
                    "missing key '" + field.name + "' in [contact.nonsmooth]: solver '" + entry->name + "' needs it");
    }
  }
}

void read_wheel_rail(Draft& draft, bool active) {
  Reading& reading = draft.reading;
  const Node* table = find_table(reading, "contact.wheel_rail");
  const TableValues values = read_table(table_or_empty(reading, "contact.wheel_rail"), "[contact.wheel_rail]",
                                        reading.schema.at("contact.wheel_rail").fields, reading);
  draft.scene.contact.wheel_rail = values;
  if (!table) return;
  draft.scene.contact.wheel_rail_place = table->place;
  if (!active)
    reading.warning(table->place, "[contact.wheel_rail] is not used by method 'nonsmooth': contact is rigid");
}

std::optional<PairSpec> read_pair(Draft& draft, const Node& item, const Laws& laws) {
  Reading& reading = draft.reading;
  const std::string label = "[[contact.pair]]";
  const std::vector<Field> between{reading.schema.at("contact.pair").fields.front()};
  const TableValues values =
      read_table(item, label, between + pair_values() + smooth_fields(reading.registry, laws.chosen), reading);
  if (!values.has("between")) return std::nullopt;
  const auto& names = values.texts("between");
  const auto a = find_material(draft, names[0], values.place_of("between"), label);
  const auto b = find_material(draft, names[1], values.place_of("between"), label);
  if (!a || !b) return std::nullopt;
  PairSpec pair{std::min(*a, *b),
                std::max(*a, *b),
                values.optional_number("restitution"),
                values.optional_number("friction"),
                values.optional_number("rolling_friction"),
                {},
                values.place};
  const bool smooth = draft.scene.contact.method.value == Method::smooth;
  for (const auto& [name, place] : values.places) {
    if (name == "between" || contains(pair_values(), name)) continue;
    if (smooth && !contains(laws.used, name))
      reading.warning(place, name + " is not used by law '" + laws.chosen.law + "'");
    else if (!smooth)
      reading.warning(place, name + " is not used by method 'nonsmooth'");
    if (contains(laws.used, name) && values.has(name)) pair.parameters.set(name, values.all().at(name));
  }
  return pair;
}

void read_pairs(Draft& draft, const Laws& laws) {
  auto& pairs = draft.scene.contact.pairs;
  each_item(draft.reading, "contact.pair", [&](const Node& item) {
    const auto pair = read_pair(draft, item, laws);
    if (!pair) return;
    const auto same =
        std::find_if(pairs.begin(), pairs.end(), [&](const PairSpec& p) { return p.a == pair->a && p.b == pair->b; });
    if (same == pairs.end()) return pairs.push_back(*pair);
    const auto name = [&](std::size_t k) { return draft.scene.materials[k].material.name; };
    draft.reading.error(pair->place, "the pair " + name(pair->a) + "-" + name(pair->b) +
                                         " is given twice; first in line " + std::to_string(same->place.line));
  });
}

/// Where a coefficient is above 0: its key in [contact], then the pairs that have one of their own.
std::vector<Place> places_above_zero(const ContactSettings& contact, Placed<double> ContactSettings::*common,
                                     std::optional<double> PairSpec::*own) {
  std::vector<Place> places;
  if ((contact.*common).value > 0.0) places.push_back((contact.*common).place);
  for (const auto& pair : contact.pairs)
    if ((pair.*own).value_or(0.0) > 0.0) places.push_back(pair.place);
  return places;
}

/// Coefficients and the laws that use them.
void warn_idle(Draft& draft) {
  const auto& contact = draft.scene.contact;
  const bool smooth = contact.method.value == Method::smooth;
  const auto warn = [&](const std::vector<Place>& places, const std::string& text) {
    for (const Place& place : places) draft.reading.warning(place, text);
  };
  const auto rolling = places_above_zero(contact, &ContactSettings::rolling_friction, &PairSpec::rolling_friction);
  if (!smooth) return warn(rolling, "rolling_friction is not used by method 'nonsmooth'");
  if (contact.rolling.value == "none") warn(rolling, "rolling_friction is not used by rolling law 'none'");
  const auto friction = places_above_zero(contact, &ContactSettings::friction, &PairSpec::friction);
  if (friction.empty() || contact.tangential.value == "none")
    warn(rolling, "rolling_friction does nothing without friction");
  if (contact.tangential.value == "none") warn(friction, "friction is not used by tangential law 'none'");
  const bool rolls = contact.rolling.written() && contact.rolling.value != "none";
  if (rolls && rolling.empty() && !contact.rolling_friction.written())
    draft.reading.warning(contact.rolling.place, "rolling law '" + contact.rolling.value +
                                                     "' does nothing where no pair has a rolling_friction");
}

/// Number of bodies of a material.
struct Census {
  std::size_t all = 0, free = 0;
};

std::vector<Census> count_bodies(const Scene& scene) {
  std::vector<Census> count(scene.materials.size());
  for (const auto& body : scene.bodies) {
    ++count[body.material].all;
    if (body.moves()) ++count[body.material].free;
  }
  for (const auto& fill : scene.fills) {  // two stand for many
    count[fill.material].all += 2;
    count[fill.material].free += 2;
  }
  return count;
}

/// Calls visit(a, b) for each pair of materials whose bodies can touch.
template <class F>
void each_touching_pair(const Scene& scene, F&& visit) {
  const auto count = count_bodies(scene);
  for (std::size_t a = 0; a < count.size(); ++a) {
    if (count[a].all > 1 && count[a].free > 0) visit(a, a);
    for (std::size_t b = a + 1; b < count.size(); ++b)
      if (count[a].all > 0 && count[b].all > 0 && count[a].free + count[b].free > 0) visit(a, b);
  }
}

const PairSpec* find_pair(const Scene& scene, std::size_t a, std::size_t b) {
  for (const auto& pair : scene.contact.pairs)
    if (pair.a == a && pair.b == b) return &pair;
  return nullptr;
}

/// Reports the first pair that neither the table nor its own [[contact.pair]] gives a key; true if every pair has it.
template <class Has>
void require_for_pairs(Draft& draft, const std::string& key, const std::string& table, const std::string& why,
                       Has&& has) {
  bool reported = false;
  each_touching_pair(draft.scene, [&](std::size_t a, std::size_t b) {
    const PairSpec* pair = find_pair(draft.scene, a, b);
    if (reported || (pair && has(*pair))) return;
    const auto& m = draft.scene.materials;
    const Node* node = find_table(draft.reading, table);
    if (!node) node = find_table(draft.reading, "contact");
    draft.reading.error(node ? node->place : Place{draft.scene.file, 1, 1},
                        "missing key '" + key + "' in [" + table + "]: " + why +
                            ", and no [[contact.pair]] gives it for " + m[a].material.name + "-" + m[b].material.name);
    reported = true;
  });
}

void check_densities(Draft& draft) {
  const auto count = count_bodies(draft.scene);
  for (std::size_t k = 0; k < count.size(); ++k) {
    const auto& spec = draft.scene.materials[k];
    if (count[k].free == 0 || !std::isnan(spec.material.density)) continue;
    draft.reading.error(spec.place,
                        "missing key 'density' in [material." + spec.material.name + "]: bodies of it move freely");
  }
}

}  // namespace

void read_contact(Draft& draft) {
  Reading& reading = draft.reading;
  auto& contact = draft.scene.contact;
  const Node* table = find_table(reading, "contact");
  if (table) {
    const TableValues values = read_table(*table, "[contact]", reading.schema.at("contact").fields, reading);
    contact.method.place = values.place_of("method");
    if (values.has("method") && values.text("method") == "nonsmooth") contact.method.value = Method::nonsmooth;
    contact.restitution = values.placed_number("restitution");
    contact.friction = values.placed_number("friction");
    contact.rolling_friction = values.placed_number("rolling_friction");
  }
  const bool smooth = contact.method.value == Method::smooth;
  const Laws laws = read_smooth(draft, smooth);
  read_nonsmooth(draft, !smooth);
  read_wheel_rail(draft, smooth);
  read_pairs(draft, laws);
  warn_idle(draft);
}

void check_pairs(Draft& draft) {
  Reading& reading = draft.reading;
  if (reading.errors() > 0) return;  // bodies or materials may be missing: what follows from that is noise
  check_densities(draft);
  auto& contact = draft.scene.contact;
  if (!reading.root.find("contact")) {
    bool touching = false;
    each_touching_pair(draft.scene, [&](std::size_t, std::size_t) { touching = true; });
    if (touching)
      reading.error({draft.scene.file, 1, 1},
                    "missing table [contact] with method, restitution and friction: bodies can touch");
    return;
  }
  const std::string why = "it must be written where bodies can touch (0 is fine)";
  const bool smooth = contact.method.value == Method::smooth;
  const std::string normal = smooth_parts({contact.law.value, "", "", {}, false}).normal;
  const bool asks = !smooth || !find_entry(all_normal_laws(), normal) || asks_for_restitution(normal);
  if (!asks && !contact.restitution.written()) contact.restitution.value = 1.0;  // no damper beside that of the law
  if (asks && !contact.restitution.written())
    require_for_pairs(draft, "restitution", "contact", why,
                      [](const PairSpec& p) { return p.restitution.has_value(); });
  if (!contact.friction.written())
    require_for_pairs(draft, "friction", "contact", why, [](const PairSpec& p) { return p.friction.has_value(); });
  if (!smooth) return;
  const Entry* law = find_entry(reading.registry.normal_laws, contact.law.value);
  for (const auto& field : law ? law->fields : std::vector<Field>{}) {
    if (field.optional || field.default_value || contact.smooth.has(field.name)) continue;
    require_for_pairs(draft, field.name, "contact.smooth", "law '" + law->name + "' needs it",
                      [&](const PairSpec& p) { return p.parameters.has(field.name); });
  }
}

MaterialTable material_table(const Scene& scene) {
  const std::size_t n = scene.materials.size();
  MaterialTable table{n, std::vector<MaterialPair>(n * n)};
  const auto& contact = scene.contact;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const PairSpec* own = find_pair(scene, std::min(i, j), std::max(i, j));
      const auto value = [&](const std::optional<double>& of_pair, double common) { return of_pair.value_or(common); };
      MaterialPair& pair = table.pairs[i * n + j];
      pair.a = scene.materials[i].material;
      pair.b = scene.materials[j].material;
      pair.restitution = value(own ? own->restitution : std::nullopt, contact.restitution.value);
      pair.friction = value(own ? own->friction : std::nullopt, contact.friction.value);
      pair.rolling_friction = value(own ? own->rolling_friction : std::nullopt, contact.rolling_friction.value);
      pair.parameters = contact.smooth;
      if (!own) continue;
      for (const auto& [name, written] : own->parameters.all()) pair.parameters.set(name, written);
    }
  }
  for (auto& pair : table.pairs) pair.occurs = false;
  each_touching_pair(scene, [&](std::size_t a, std::size_t b) {
    table.pairs[a * n + b].occurs = table.pairs[b * n + a].occurs = true;
  });
  return table;
}

}  // namespace epafi
