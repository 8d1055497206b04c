#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "camera/seen_boards.hpp"
#include "flies/io/images.hpp"
#include "flies/rig/board_tools.hpp"

/// Cameras or films that a board is held before.
struct LivingBoards {
  std::vector<std::string> sources;  ///< one that gives both images, or the left and the right one
  std::vector<int> size_px;          ///< width and height asked of cameras, of both images together; empty: their own
  std::size_t views = 20;            ///< that are enough
};

/// Takes a view whenever the board is found in both images, held still and elsewhere than before, and says so on
/// standard error; ends with enough views, the end of a film, or SIGINT.
/// @throws flies::InputError when a source cannot be opened or gives nothing
SeenBoards watch_boards(const LivingBoards& living, const flies::PairReading& reading, const flies::BoardTools& tools,
                        const flies::Board& board);
