#include "flies/rig/board_tools.hpp"

#include "flies/video/lazy_module.hpp"

namespace flies {

const BoardTools& board_tools() {
  using ToolsFunction = const BoardTools* (*)();
  static const auto tools = reinterpret_cast<ToolsFunction>(module_function("flies_rig", "flies_board_tools"));
  return *tools();
}

}  // namespace flies
