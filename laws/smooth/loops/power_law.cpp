#include "laws/smooth/loops/make_loop.h"

namespace epafi {
template std::unique_ptr<ContactModel> make_loop<PowerLaw>(const MaterialTable&,
                                                           const std::vector<PowerLaw::Parameters>&,
                                                           const SmoothParts&);
}  // namespace epafi
