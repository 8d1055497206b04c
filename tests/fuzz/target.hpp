#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// What every fuzz target defines. Built by clang as fuzzers (`scripts/fuzz`), by any compiler as replayers, which
/// `./test` runs over the seeds and their neighbours.

/// Must neither crash nor let anything out but what the library says it throws.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

/// Good inputs, made by the formats' writers where there are some, and bad ones that once did harm.
std::vector<std::string> fuzz_seeds();
