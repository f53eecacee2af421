/// @file closed_forms.h  The list of pairs with a closed form: overloads of collide_closed(a, b, query, sink), in one
/// order each.
#pragma once
#include "detection/narrow/capsule_pairs.h"
#include "detection/narrow/half_space_pairs.h"
#include "detection/narrow/hollow_pairs.h"
#include "detection/narrow/sphere_pairs.h"
#include "detection/narrow/wheel_rail_pairs.h"
