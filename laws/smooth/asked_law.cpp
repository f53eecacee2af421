#include "laws/smooth/asked_law.h"

namespace epafi {

bool asks_for_restitution(const std::string& normal) {
  return with_law(NormalLaws{}, normal, [](auto n) { return uses_restitution<typename decltype(n)::type>; });
}

AskedLaw asked_law(const std::string& normal, const MaterialPair& pair) {
  return with_law(NormalLaws{}, normal, [&](auto n) {
    using Law = typename decltype(n)::type;
    static_assert(!RemembersNormal<Law> || sizeof(NormalState<Law>) == sizeof(double));
    const typename Law::Parameters p = Law::parameters(pair);
    AskedLaw out{std::vector<double>(sizeof p / sizeof(double)), normal_evaluation<Loop<Law>>(), Law::is_hertzian,
                 RemembersNormal<Law>};
    std::memcpy(out.numbers.data(), &p, sizeof p);
    return out;
  });
}

}  // namespace epafi
