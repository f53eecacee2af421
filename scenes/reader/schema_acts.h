/// @file schema_acts.h  Tables of scenes with several stages: stages, the run that a scene starts from, and the bounds
/// and conditions that end a run or a stage.
#pragma once
#include "scenes/reader/schema.h"

namespace epafi {

/// Lower and upper corner.
std::vector<Field> region_box();
TableSchema stage_table();
TableSchema start_table();
/// ends_run: of [bounds], which may stop a run; else of [accuracy].
std::vector<Field> bound_fields(bool ends_run);
TableSchema bounds_measure_table();

}  // namespace epafi
