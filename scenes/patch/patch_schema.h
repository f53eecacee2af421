/// @file patch_schema.h  The keys of a patch case: read, checked and listed from one declaration.
#pragma once
#include <vector>

#include "engine/units/registry.h"

namespace epafi {

std::vector<Field> patch_fields();           ///< [patch]
std::vector<Field> patch_contact_fields();   ///< [contact]
std::vector<Field> patch_material_fields();  ///< [material.NAME]

}  // namespace epafi
