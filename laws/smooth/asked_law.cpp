#include "laws/smooth/asked_law.h"

#include <cstring>

#include "laws/smooth/choose_law.h"

namespace epafi {

namespace {

/// N: a way of evaluation, which several laws may share.
template <NormalLaw N>
AskedLaw asked(const typename N::Parameters& p) {
  return {[p](const ContactKinematics& at, double before, double& now) {
            NormalState<N> old{}, next{};
            if constexpr (RemembersNormal<N>) {
              static_assert(sizeof old == sizeof before);
              std::memcpy(static_cast<void*>(&old), &before, sizeof old);
            }
            const NormalResponse out = respond<N>(p, at, old, next);
            if constexpr (RemembersNormal<N>) std::memcpy(&now, &next, sizeof now);
            return out;
          },
          N::is_hertzian, RemembersNormal<N>};
}

}  // namespace

AskedLaw asked_law(const std::string& normal, const MaterialPair& pair) {
  return with_law(NormalLaws{}, normal, [&](auto n) {
    using N = typename decltype(n)::type;
    return asked<Loop<N>>(N::parameters(pair));
  });
}

}  // namespace epafi
