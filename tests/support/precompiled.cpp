/// @file precompiled.cpp  Carries the precompiled header of the tests.
#include "tests/support/precompiled.h"
