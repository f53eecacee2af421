#include "scenes/version.h"

namespace epafi {

const char* version() { return EPAFI_VERSION; }

std::string version_text() {
  return std::string("epafi ") + version() +
         "\nMIT licence. Contains parts under LGPL-3.0-or-later: CGAL's kernel, GMP, MPFR.";
}

}  // namespace epafi
