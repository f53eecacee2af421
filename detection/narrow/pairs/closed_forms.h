/// @file closed_forms.h  The list of pairs with a closed form: overloads of collide_closed(a, b, query, sink), in one
/// order each.
#pragma once
#include "detection/narrow/pairs/capsule_pairs.h"
#include "detection/narrow/pairs/half_space_pairs.h"
#include "detection/narrow/pairs/hollow_pairs.h"
#include "detection/narrow/pairs/sphere_pairs.h"
#include "detection/narrow/pairs/wheel_rail_pairs.h"
