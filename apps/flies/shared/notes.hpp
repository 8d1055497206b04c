#pragma once

#include <string>
#include <vector>

/// Tells the user, on standard error, what was assumed: one line `flies: note: ...` each.
void say_notes(const std::vector<std::string>& notes);
