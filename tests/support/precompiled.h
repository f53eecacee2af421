/// @file precompiled.h  Catch2 and what the engine's headers need, compiled once for all tests.
#pragma once
#include "engine/precompiled.h"
#include "tests/support/catch.h"
