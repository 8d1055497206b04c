#pragma once

#include <string>

/// The model of the CPU as Linux names it, for reports; "not known" where it does not.
std::string cpu_name();
