/// @file program_pages.h  The pages of the program itself.
#pragma once

namespace epafi {

/// Lets go of all pages of code and constants of the program and its libraries: those of reading a scene are not asked
/// for again, the others come back from the system's copy of the files (some 100 times a microsecond or, on rented
/// machines, six). Of the 12 MB of a bed 8 are asked for again. Nothing where the system is not Linux.
void give_back_program();

}  // namespace epafi
