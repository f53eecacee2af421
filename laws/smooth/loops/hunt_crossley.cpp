#include "laws/smooth/loops/make_loop.h"

namespace epafi {
template std::unique_ptr<ContactModel> make_loop<HuntCrossley>(const MaterialTable&,
                                                               const std::vector<HuntCrossley::Parameters>&,
                                                               const SmoothParts&);
}  // namespace epafi
