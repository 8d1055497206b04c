#pragma once

#include <string>
#include <vector>

#include "shared/output_claims.hpp"

/// What is read of folders to train on, named as inputs. Folders that are not there are told of when they are read.

/// Pictures and labels, also further down.
/// @throws flies::InputError as `OutputClaims::reads`
void reads_pictures(OutputClaims& claims, std::vector<std::string> folders);

/// Pairs with truth.
/// @throws flies::InputError as `OutputClaims::reads` and `flies::open_dataset`
void reads_true_pairs(OutputClaims& claims, std::vector<std::string> folders);
