#include "laws/smooth/loops/make_loop.h"

namespace epafi {
template std::unique_ptr<ContactModel> make_loop<OverlapVolume>(const MaterialTable&,
                                                                const std::vector<OverlapVolume::Parameters>&,
                                                                const SmoothParts&);
}  // namespace epafi
