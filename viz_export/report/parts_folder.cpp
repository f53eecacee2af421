#include "viz_export/report/parts_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include "engine/units/error.h"

namespace epafi {

namespace fs = std::filesystem;

PartsFolder::PartsFolder(const fs::path& page) {
  if (!fs::is_regular_file(page) && fs::exists(page))  // a device: nothing lies beside it
    path_ = fs::temp_directory_path() / fmt::format("epafi-report-{}", ::getpid());
  else
    path_ = fs::path(page) += fmt::format(".{}.part", ::getpid());
  std::error_code error;
  fs::create_directory(path_, error);
  if (error)
    throw FileError(page.string() + ": cannot write into '" +
                    (page.has_parent_path() ? page.parent_path() : ".").string() + "': " + error.message() +
                    "; `epafi report DIR --out PAGE.html` writes the page elsewhere");
}

PartsFolder::~PartsFolder() {
  std::error_code none;
  fs::remove_all(path_, none);
}

}  // namespace epafi
