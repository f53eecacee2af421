/// @file file_kind.h  Scenes, patch cases and studies are all TOML: who gives a command one of another kind is told so,
/// once, and which command takes it, instead of every key that is unknown there.
#pragma once
#include "scenes/reader/table_reader.h"

namespace epafi {

enum class FileKind { scene, patch_case, study };

/// Reports a file whose tables are those of another kind and of none of its own. False: nothing was reported.
bool report_other_kind(Reading& reading, FileKind expected);

}  // namespace epafi
