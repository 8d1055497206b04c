#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/core/error.hpp"
#include "flies/core/fly.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/random.hpp"
#include "flies/core/results.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"
TEST(Placeholder, Builds) {}
