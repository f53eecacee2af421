/// @file superquadric_batch.h  Pairs of superquadrics, whose distances are found several at a time.
#pragma once
#include <vector>

#include "detection/narrow/gjk/superquadric_pairs.h"
#include "detection/narrow/pairs/convex_pairs.h"

namespace epafi {

class SuperquadricBatch {
 public:
  static constexpr std::size_t room = 64;

  /// Number k of a run, unless they are apart.
  void ask(std::size_t k, const Superquadric& a, const Superquadric& b, const PairQuery& q) {
    if (still_apart(a, b, q)) return leave_rest(q);
    const MinkowskiDifference difference(ConvexRef::to(a), ConvexRef::to(b), q.a, q.b);
    pairs_.push_back({&a, &b, difference.rotation, difference.offset, quick_limit(rounded_pair(a, b), q)});
    asked_.push_back({k, q});
  }
  /// Adds the contacts of the pairs since the last call; open(k) begins pair k in the sink.
  template <class Open>
  void answer(const Open& open, ContactSink& sink) {
    answers_.resize(pairs_.size());
    two_normals(pairs_, answers_);
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const Superquadric &a = *pairs_[i].a, &b = *pairs_[i].b;
      open(asked_[i].number);
      collide_round(CorePair::of(a, b), RoundRef::to(a), RoundRef::to(b), rounded_pair(a, b), asked_[i].query, sink,
                    &answers_[i]);
      sink.end();
    }
    pairs_.clear();
    asked_.clear();
  }

 private:
  struct Asked {
    std::size_t number;
    PairQuery query;
  };
  std::vector<SuperquadricPair> pairs_;
  std::vector<Asked> asked_;
  std::vector<CommonNormal> answers_;
};

}  // namespace epafi
