/// @file file_kind.h  Scenes, patch cases and studies are all TOML. A command that is given another kind says so once,
/// with the command that takes it, instead of listing every unknown key.
#pragma once
#include "scenes/reader/table_reader.h"

namespace epafi {

enum class FileKind { scene, patch_case, study };

/// Reports a file whose tables are those of another kind and of none of its own. False: nothing was reported.
bool report_other_kind(Reading& reading, FileKind expected);

}  // namespace epafi
