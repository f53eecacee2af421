#include "laws/smooth/loops/make_loop.h"

namespace epafi {
template std::unique_ptr<ContactModel> make_loop<Jkr>(const MaterialTable&, const std::vector<Jkr::Parameters>&,
                                                      const SmoothParts&);
}  // namespace epafi
