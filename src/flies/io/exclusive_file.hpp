#pragma once

#include <string>

namespace flies {

/// Opens a file that only one run at a time may write, and empties it once it is ours; another run that writes it is
/// told by a lock, which ends when the descriptor is closed. File systems without locks do without; what is no regular
/// file (a pipe, a device) is shared.
/// @param name of the file in errors
/// @returns the descriptor
/// @throws InputError when it cannot be opened, or another run is writing it
int open_exclusively(const std::string& path, const std::string& name);

}  // namespace flies
