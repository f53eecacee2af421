/// @file make_loop.h  From a way to evaluate the normal force and the names of the other parts to the contact model.
/// Only the .cpp files of this folder, one for each such way, see the loop itself: it is heavy to compile.
#pragma once
#include "laws/smooth/choose_law.h"
#include "laws/smooth/make_smooth_contact.h"
#include "laws/smooth/smooth_contact.h"

namespace epafi {

/// Parameters of a law for all pairs that occur; the others keep their defaults.
template <class Law>
std::vector<typename Law::Parameters> parameters_of_pairs(const MaterialTable& table) {
  std::vector<typename Law::Parameters> out(table.pairs.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    if (table.pairs[i].occurs) out[i] = Law::parameters(table.pairs[i]);
  return out;
}

template <class N, class T, class R>
std::unique_ptr<ContactModel> join_parts(const MaterialTable& table, const std::vector<typename N::Parameters>& normal,
                                         const std::vector<typename T::Parameters>& tangential,
                                         const std::vector<typename R::Parameters>& rolling, bool locate) {
  std::vector<typename SmoothContact<N, T, R>::PairParameters> pairs;
  for (std::size_t i = 0; i < normal.size(); ++i) pairs.push_back({normal[i], tangential[i], rolling[i]});
  return std::make_unique<SmoothContact<N, T, R>>(table.materials, std::move(pairs), locate);
}

template <NormalLaw N>
std::unique_ptr<ContactModel> make_loop(const MaterialTable& table, const std::vector<typename N::Parameters>& normal,
                                        const SmoothParts& parts) {
  return std::visit(
      [&](auto t, auto r) -> std::unique_ptr<ContactModel> {
        using T = typename decltype(t)::type;
        using R = typename decltype(r)::type;
        if constexpr (parts_fit<N, T, R>)
          return join_parts<N, Loop<T>, Loop<R>>(table, normal, parameters_of_pairs<T>(table),
                                                 parameters_of_pairs<R>(table), parts.locate);
        else
          return nullptr;  // refused by check_smooth
      },
      *find_law(TangentialLaws{}, parts.tangential), *find_law(RollingLaws{}, parts.rolling));
}

}  // namespace epafi
