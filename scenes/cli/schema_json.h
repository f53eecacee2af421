/// @file schema_json.h  `epafi schema`: the JSON Schema (draft-07) of scene files, for completion in editors (taplo:
/// `#:schema`).
#pragma once
#include <string>

#include "scenes/reader/registry.h"

namespace epafi {

std::string json_schema(const Registry& registry);

}  // namespace epafi
