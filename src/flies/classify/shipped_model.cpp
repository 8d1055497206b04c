#include "flies/classify/shipped_model.hpp"

// The assembler copies the file; as a literal or an array it would take the compiler minutes.
// FLIES_SHIPPED_MODEL is set by CMake.
asm(R"(
  .pushsection .rodata
  .hidden flies_shipped_model
  .hidden flies_shipped_model_end
  .global flies_shipped_model
  .global flies_shipped_model_end
flies_shipped_model:
  .incbin ")" FLIES_SHIPPED_MODEL R"("
flies_shipped_model_end:
  .popsection
)");

extern "C" {
extern const char flies_shipped_model[];
extern const char flies_shipped_model_end[];
}

namespace flies {

std::string_view shipped_model_text() {
  return {flies_shipped_model, static_cast<std::string_view::size_type>(flies_shipped_model_end - flies_shipped_model)};
}

}  // namespace flies
