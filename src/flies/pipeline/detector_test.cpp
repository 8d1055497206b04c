#include "flies/pipeline/detector.hpp"

#include <gtest/gtest.h>
