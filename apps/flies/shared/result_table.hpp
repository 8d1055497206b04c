#pragma once

#include <string>

#include "flies/io/writers.hpp"

/// What was found in one pair, for people to read: a heading, a line each, nearest first, and the timing.
std::string result_table(const flies::FrameRecord& record);
