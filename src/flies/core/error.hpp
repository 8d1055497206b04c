#pragma once

#include <stdexcept>
#include <string>

namespace flies {

/// The one exception the library throws for a fault of the user's input: a file, an image, a calibration, an option.
/// Its message is a single line that names the source and the field, what was found and what is allowed, e.g.
/// `calib.txt: P2: found 11 numbers, expected 12`. Programs catch it once, print `what()` and exit with status 2.
class InputError : public std::runtime_error {
 public:
  /// @param source    file name, folder or option source ("command line") that holds the fault; never empty
  /// @param field     field, image property or option at fault; may be empty when the whole source is at fault
  /// @param complaint what was found and what is allowed, without a trailing full stop
  InputError(const std::string& source, const std::string& field, const std::string& complaint)
      : std::runtime_error(source + ": " + (field.empty() ? "" : field + ": ") + complaint) {}
};

}  // namespace flies
