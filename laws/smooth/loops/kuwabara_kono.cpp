#include "laws/smooth/loops/make_loop.h"

namespace epafi {
template std::unique_ptr<ContactModel> make_loop<KuwabaraKono>(const MaterialTable&,
                                                               const std::vector<KuwabaraKono::Parameters>&,
                                                               const SmoothParts&);
}  // namespace epafi
