#include "flies/evolve/evolve.hpp"

#include <gtest/gtest.h>
