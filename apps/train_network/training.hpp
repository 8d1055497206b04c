#pragma once

#include <string>

#include "judging.hpp"
#include "learning.hpp"
#include "windows.hpp"

namespace flies {

/// What the command line says.
struct NetworkArguments {
  DataFolders folders;  ///< without pictures: `network_of` and `calibration_of` are put together
  LearningOptions learning;
  JudgingOptions judging;
  bool is_first_look = false;  ///< trains the network in front of `first`; else the one behind it
  std::string first = "flies-48x96-linear";
  std::string out, name, work, report, network_of, calibration_of;
  std::string command;  ///< the whole line, for the report
};

/// Trains a network, or takes the one of `network_of`, judges it on pictures kept apart and writes model and report.
/// Progress goes to standard error, results to standard output unless the model does.
/// @throws InputError from the data, from a state that is of another training or damaged, and when a file cannot be
///         written
void train_network(const NetworkArguments& arguments);

}  // namespace flies
