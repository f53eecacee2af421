#include "laws/smooth/make_smooth_contact.h"

#include <algorithm>

#include "laws/smooth/smooth_contact.h"

namespace epafi {

namespace {

/// Other common names of normal laws.
struct OtherName {
  const char *name, *normal, *summary;
};
constexpr OtherName other_names[] = {{"hertz-mindlin", "hertz", "the same as hertz, by its common name"},
                                     {"tsuji", "hertz", "the same as hertz, by the name of its damping"}};

const OtherName* find_other(const std::string& law) {
  const auto* const at = std::ranges::find(other_names, law, &OtherName::name);
  return at == std::end(other_names) ? nullptr : at;
}
std::string normal_of(const std::string& law) {
  const OtherName* const other = find_other(law);
  return other ? other->normal : law;
}

/// As scenes name them.
std::vector<std::string> law_names() {
  std::vector<std::string> names;
  for (const Entry& e : law_entries(NormalLaws{})) {
    names.push_back(e.name);
    for (const OtherName& other : other_names)
      if (e.name == other.normal) names.emplace_back(other.name);
  }
  return names;
}

/// The friction of a normal law unless another one is asked for.
const char* own_friction(const std::string& normal) {
  if (!find_law(NormalLaws{}, normal)) return NoFriction::name;
  return with_law(NormalLaws{}, normal,
                  [](auto n) { return decltype(n)::type::is_hertzian ? Mindlin::name : CoulombSpring::name; });
}

template <class F>
bool any_pair(const MaterialTable& table, const F& f) {
  return std::any_of(table.pairs.begin(), table.pairs.end(), [&](const MaterialPair& p) { return p.occurs && f(p); });
}

void add(std::vector<Problem>& out, Problem::Level level, std::string text) {
  Problem problem;
  problem.level = level;
  problem.text = std::move(text);
  out.push_back(std::move(problem));
}

template <class List>
std::vector<std::string> names_of(const List& list) {
  std::vector<std::string> names;
  for (const Entry& e : law_entries(list)) names.push_back(e.name);
  return names;
}

void check_name(const std::vector<std::string>& names, const char* key, const std::string& name,
                std::vector<Problem>& out) {
  if (std::ranges::find(names, name) != names.end()) return;
  std::string known;
  for (const std::string& n : names) known += (known.empty() ? "" : ", ") + n;
  add(out, Problem::Level::error,
      std::string("[contact.smooth] ") + key + " '" + name + "' is unknown; known: " + known);
}

void check_combination(const SmoothSetup& setup, const SmoothParts& parts, std::vector<Problem>& out) {
  const bool fits = with_law(TangentialLaws{}, parts.tangential, [&](auto t) {
    return with_law(NormalLaws{}, parts.normal,
                    [](auto n) { return decltype(t)::type::template fits<typename decltype(n)::type>; });
  });
  if (!fits)
    add(out, Problem::Level::error,
        "tangential law '" + parts.tangential + "' needs a Hertzian normal law, not '" + parts.normal +
            "'; use tangential = \"" +
            (parts.tangential == MindlinDashpot::name ? SpringDashpot::name : CoulombSpring::name) + "\"");
  const bool has_dashpot = parts.tangential.ends_with("-dashpot") || parts.tangential == NoFriction::name;
  if (!has_dashpot &&
      any_pair(setup.materials, [](const MaterialPair& p) { return p.parameters.has("tangential_damping"); }))
    add(out, Problem::Level::error,
        "tangential law '" + parts.tangential + "' has no tangential_damping; use tangential = \"" +
            (parts.tangential == CoulombSpring::name ? SpringDashpot::name : MindlinDashpot::name) + "\"");
}

template <class List>
void check_missing(const List& list, const std::string& name, const MaterialPair& pair, const std::string& of,
                   std::vector<Problem>& out) {
  const auto missing = with_law(list, name, [&](auto l) { return Missing(decltype(l)::type::missing(pair)); });
  for (const std::string& what : missing) {
    std::string text = "law '";
    text.append(of).append("' needs ").append(what).append(" (contact ");
    text.append(pair.a.name).append("-").append(pair.b.name).append(")");
    const bool said = std::any_of(out.begin(), out.end(), [&](const Problem& p) { return p.text == text; });
    if (!said) add(out, Problem::Level::error, text);
  }
}

/// Warns if the restitution differs from the key.
template <class N>
void check_restitution(const std::string& law, const MaterialPair& pair, std::vector<Problem>& out) {
  const std::string where = "contact " + pair.a.name + "-" + pair.b.name;
  constexpr double least = least_restitution<N>;
  if constexpr (requires { N::restitution(0.5); }) {
    if (pair.restitution < 1.0)
      add(out, Problem::Level::warning,
          where + ": law '" + law + "' returns " + std::to_string(N::restitution(pair.restitution)) +
              " for a restitution of " + std::to_string(pair.restitution) +
              " at its reference_speed; 'hunt-crossley' returns what is asked");
  }
  const bool has_dashpot = std::is_same_v<N, PowerLaw> && pair.parameters.has("damping");
  if ((!uses_restitution<N> || has_dashpot) && pair.restitution < 1.0)
    add(out, Problem::Level::warning,
        where + ": restitution " + std::to_string(pair.restitution) + " is not used by law '" + law +
            "', whose restitution depends on the speed");
  else if (least > minimum_restitution && pair.restitution < least)
    add(out, Problem::Level::warning,
        where + ": restitution " + std::to_string(pair.restitution) + " would need more damping than law '" + law +
            "' is set for; it acts as " + std::to_string(least));
}

/// Names of the laws whose normal part has P.
template <class P>
std::string laws_that(const P& has) {
  std::string all;
  for (const std::string& law : law_names())
    if (with_law(NormalLaws{}, normal_of(law), has)) all += (all.empty() ? "" : ", ") + law;
  return all;
}

/// Keys that the law passes over.
void check_unused(const SmoothSetup& setup, const SmoothParts& parts, std::vector<Problem>& out) {
  const auto locates = [](auto n) { return PowerParts<typename decltype(n)::type>; };
  if (parts.locate && !with_law(NormalLaws{}, parts.normal, locates))
    add(out, Problem::Level::warning,
        "locate_edges is not used by law '" + setup.law + "'; laws that have it: " + laws_that(locates));
  if (any_pair(setup.materials, [](const MaterialPair& p) {
        return p.parameters.has("stiffness") && p.parameters.has("calibration_overlap");
      }))
    add(out, Problem::Level::warning,
        "calibration_overlap and calibration_force are not used where stiffness is written; leave one out");
}

void check_materials(const SmoothSetup& setup, const SmoothParts& parts, std::vector<Problem>& out) {
  for (std::size_t i = 0; i < setup.materials.materials; ++i) {
    for (std::size_t j = i; j < setup.materials.materials; ++j) {
      const MaterialPair& pair = setup.materials.pairs[i * setup.materials.materials + j];
      if (!pair.occurs) continue;
      check_missing(NormalLaws{}, parts.normal, pair, setup.law, out);
      check_missing(TangentialLaws{}, parts.tangential, pair, setup.law, out);
      check_missing(RollingLaws{}, parts.rolling, pair, setup.law, out);
      with_law(NormalLaws{}, parts.normal,
               [&](auto n) { check_restitution<typename decltype(n)::type>(setup.law, pair, out); });
    }
  }
}

}  // namespace

const std::vector<Entry>& all_smooth_laws() {
  static const std::vector<Entry> list = [] {
    std::vector<Entry> out;
    for (const std::string& law : law_names()) {
      const auto entry = [](auto l) { return decltype(l)::type::entry(); };
      const std::string normal = normal_of(law), friction = own_friction(normal);
      Entry e = with_law(NormalLaws{}, normal, entry);
      e.name = law;
      const OtherName* const other = find_other(law);
      e.summary = other ? other->summary : e.summary + "; friction: " + friction;
      for (const Entry& part :
           {with_law(TangentialLaws{}, friction, entry), MindlinDashpot::entry(), RollingSpring::entry()})
        e.fields.insert(e.fields.end(), part.fields.begin(), part.fields.end());
      out.push_back(std::move(e));
    }
    return out;
  }();
  return list;
}

std::vector<Entry> all_normal_laws() { return law_entries(NormalLaws{}); }
std::vector<Entry> all_tangential_laws() { return law_entries(TangentialLaws{}); }
std::vector<Entry> all_rolling_laws() { return law_entries(RollingLaws{}); }

SmoothParts smooth_parts(const SmoothSetup& setup) {
  SmoothParts parts;
  parts.locate = setup.locate;
  parts.normal = normal_of(setup.law);
  parts.tangential = setup.tangential.empty() ? own_friction(parts.normal) : setup.tangential;
  parts.rolling = setup.rolling.empty() ? RollingSpring::name : setup.rolling;
  if (!any_pair(setup.materials, [](const MaterialPair& p) { return p.friction > 0.0; }))
    parts.tangential = NoFriction::name;
  // without friction nothing makes a body roll
  if (parts.tangential == NoFriction::name ||
      !any_pair(setup.materials, [](const MaterialPair& p) { return p.rolling_friction > 0.0; }))
    parts.rolling = NoRolling::name;
  return parts;
}

std::vector<Problem> check_smooth(const SmoothSetup& setup) {
  std::vector<Problem> out;
  check_name(law_names(), "law", setup.law, out);
  // the names as given, even where friction 0 makes them idle
  if (!setup.tangential.empty()) check_name(names_of(TangentialLaws{}), "tangential", setup.tangential, out);
  if (!setup.rolling.empty()) check_name(names_of(RollingLaws{}), "rolling", setup.rolling, out);
  if (!out.empty()) return out;
  const SmoothParts parts = smooth_parts(setup);
  check_combination(setup, parts, out);
  check_materials(setup, parts, out);
  check_unused(setup, parts, out);
  return out;
}

Needs smooth_needs(const SmoothSetup& setup) {
  const SmoothParts parts = smooth_parts(setup);
  const auto needs = [](auto l) { return Needs(decltype(l)::type::needs); };
  Needs out = with_law(NormalLaws{}, parts.normal, needs) | with_law(TangentialLaws{}, parts.tangential, needs) |
              with_law(RollingLaws{}, parts.rolling, needs);
  out.memory = out.memory || smooth_law(setup).needs.push;
  return out;
}

std::unique_ptr<ContactModel> make_smooth_contact(const SmoothSetup& setup) {
  std::vector<Problem> problems = check_smooth(setup);
  std::erase_if(problems, [](const Problem& p) { return p.level != Problem::Level::error; });
  if (!problems.empty()) throw SceneError(std::move(problems));
  return std::make_unique<SmoothContact>(smooth_law(setup));
}

double smooth_reach(const SmoothSetup& setup, double largest_radius) {
  return with_law(NormalLaws{}, smooth_parts(setup).normal, [&](auto n) {
    using N = typename decltype(n)::type;
    double reach = 0.0;
    if constexpr (requires(const typename N::Parameters& p) { N::reach(p, 1.0); })
      for (const MaterialPair& pair : setup.materials.pairs)
        if (pair.occurs) reach = std::max(reach, 1.1 * N::reach(N::parameters(pair), largest_radius));
    return reach;
  });
}

}  // namespace epafi
