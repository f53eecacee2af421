#include "laws/smooth/loops/make_loop.h"

namespace epafi {
template std::unique_ptr<ContactModel> make_loop<Dmt>(const MaterialTable&, const std::vector<Dmt::Parameters>&,
                                                      const SmoothParts&);
}  // namespace epafi
