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

/// For those that replace a file by another of its name: while the descriptor is open, no other run can open the file
/// by the function above, but may replace it, too.
/// @param name of the file in errors
/// @returns the descriptor; below 0 when there is no such file, or it cannot be locked
/// @throws InputError when another run is writing it line by line
int keep_from_writers(const std::string& path, const std::string& name);

/// Whether a run that opened it by `open_exclusively` is writing the file.
bool is_being_written(const std::string& path) noexcept;

/// @throws InputError when another run is writing the file
void check_not_being_written(const std::string& path);

}  // namespace flies
