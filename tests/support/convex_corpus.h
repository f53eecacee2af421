/// @file convex_corpus.h  The small corpus of convex pairs that the tests read (tests/data/README.md).
#pragma once
#include "detection/convex_corpus.h"

namespace epafi::support {

using epafi::CorpusBody;
using epafi::CorpusPair;
using epafi::read_corpus;

}  // namespace epafi::support
