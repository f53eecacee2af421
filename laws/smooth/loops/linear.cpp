#include "laws/smooth/loops/make_loop.h"

namespace epafi {
template std::unique_ptr<ContactModel> make_loop<Linear>(const MaterialTable&, const std::vector<Linear::Parameters>&,
                                                         const SmoothParts&);
}  // namespace epafi
