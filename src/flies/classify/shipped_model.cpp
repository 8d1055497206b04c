#include "flies/classify/shipped_model.hpp"

// The assembler copies the files; as literals or arrays they would take the compiler minutes.
// FLIES_SHIPPED_KERNEL_MODEL, FLIES_SHIPPED_NETWORK_MODEL and FLIES_SHIPPED_LINEAR_MODEL are set by CMake.
asm(R"(
  .pushsection .rodata
  .hidden flies_shipped_kernel_model
  .hidden flies_shipped_kernel_model_end
  .hidden flies_shipped_network_model
  .hidden flies_shipped_network_model_end
  .hidden flies_shipped_linear_model
  .hidden flies_shipped_linear_model_end
  .global flies_shipped_kernel_model
  .global flies_shipped_kernel_model_end
  .global flies_shipped_network_model
  .global flies_shipped_network_model_end
  .global flies_shipped_linear_model
  .global flies_shipped_linear_model_end
flies_shipped_kernel_model:
  .incbin ")" FLIES_SHIPPED_KERNEL_MODEL R"("
flies_shipped_kernel_model_end:
flies_shipped_network_model:
  .incbin ")" FLIES_SHIPPED_NETWORK_MODEL R"("
flies_shipped_network_model_end:
flies_shipped_linear_model:
  .incbin ")" FLIES_SHIPPED_LINEAR_MODEL R"("
flies_shipped_linear_model_end:
  .popsection
)");

// NOLINTBEGIN(readability-identifier-naming): labels of the assembler
extern "C" {
extern const char flies_shipped_kernel_model[], flies_shipped_kernel_model_end[];
extern const char flies_shipped_network_model[], flies_shipped_network_model_end[];
extern const char flies_shipped_linear_model[], flies_shipped_linear_model_end[];
}
// NOLINTEND(readability-identifier-naming)

namespace flies {
namespace {

std::string_view between(const char* begin, const char* end) {
  return {begin, static_cast<std::string_view::size_type>(end - begin)};
}

}  // namespace

std::string_view shipped_kernel_model_text() {
  return between(flies_shipped_kernel_model, flies_shipped_kernel_model_end);
}

std::string_view shipped_network_model_text() {
  return between(flies_shipped_network_model, flies_shipped_network_model_end);
}

std::string_view shipped_linear_model_text() {
  return between(flies_shipped_linear_model, flies_shipped_linear_model_end);
}

}  // namespace flies
