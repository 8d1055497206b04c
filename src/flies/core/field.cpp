#include "flies/core/field.hpp"

#include <fmt/format.h>

#include "flies/core/error.hpp"

namespace flies {

void check_field(const FieldOptions& field, const std::string& source) {
  check_options(field, source);
  const auto require_interval = [&](const char* name, double min_m, double max_m) {
    if (!(min_m < max_m)) throw InputError(source, name, fmt::format("the interval {}..{} m is empty", min_m, max_m));
  };
  require_interval("field.x_min_m", field.x_min_m, field.x_max_m);
  require_interval("field.y_min_m", field.y_min_m, field.y_max_m);
  require_interval("field.z_min_m", field.z_min_m, field.z_max_m);
}

}  // namespace flies
