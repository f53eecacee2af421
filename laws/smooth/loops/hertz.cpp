#include "laws/smooth/loops/make_loop.h"

namespace epafi {
template std::unique_ptr<ContactModel> make_loop<Hertz>(const MaterialTable&, const std::vector<Hertz::Parameters>&,
                                                        const SmoothParts&);
}  // namespace epafi
