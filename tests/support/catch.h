/// @file catch.h  The only door to Catch2 (Debian's 2.13).
#pragma once
#include <catch2/catch.hpp>
