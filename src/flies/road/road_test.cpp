#include "flies/road/road.hpp"

#include <gtest/gtest.h>
