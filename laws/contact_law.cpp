#include "laws/contact_law.h"
