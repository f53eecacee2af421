/// @file page.h  The page that shows a run: WebGL by three.js, taken when the program is built (page/, CMakeLists.txt).
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "viz_export/view/view_source.h"

namespace epafi {

/// Files of the page as they were when the program was built; three is empty where the library was not there.
struct PageParts {
  const char *three, *controls, *style, *script, *frame;
};
[[nodiscard]] const PageParts& page_parts();

/// Throws FileError with what to install where the program was built without the library.
void require_page_library();

/// The page without data; it asks the server that gave it (server.h).
[[nodiscard]] std::string served_page(const std::string& title);

struct WrittenPage {
  std::size_t bytes = 0;
  std::vector<std::string> notes;  ///< what was left out to keep it small
};

/// One file, complete in itself. Larger than `most_bytes` it does not get: directions of velocities, then weak
/// contacts, then all contacts, then frames are left out, and the page says so.
[[nodiscard]] std::string complete_page(const ViewSource& source, std::size_t most_bytes, WrittenPage& about);

/// The same into a file.
WrittenPage write_page(const ViewSource& source, const std::filesystem::path& target,
                       std::size_t most_bytes = 30'000'000);

}  // namespace epafi
