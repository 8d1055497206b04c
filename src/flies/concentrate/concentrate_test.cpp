#include "flies/concentrate/concentrate.hpp"

#include <gtest/gtest.h>
