#include "flies/fitness/fitness.hpp"

#include <gtest/gtest.h>
