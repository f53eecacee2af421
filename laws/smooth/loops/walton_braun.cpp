#include "laws/smooth/loops/make_loop.h"

namespace epafi {
template std::unique_ptr<ContactModel> make_loop<WaltonBraun>(const MaterialTable&,
                                                              const std::vector<WaltonBraun::Parameters>&,
                                                              const SmoothParts&);
}  // namespace epafi
