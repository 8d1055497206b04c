#pragma once

inline constexpr int kExitSuccess = 0;
inline constexpr int kExitInternalFault = 1;
inline constexpr int kExitInputFault = 2;
