#pragma once

#include <nlohmann/json.hpp>

#include "flies/eval/sequence.hpp"

/// What following the pairs as one sequence gave, as docs/evaluation.md says.
nlohmann::ordered_json sequence_json(const flies::SequenceResult& sequence);
