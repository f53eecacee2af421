#include "detection/shape_store.h"
