#pragma once

#include <sstream>
#include <string>

#include "hal/emulation/emulated_rig.h"
#include "hal/emulation/simulated_amplifier.h"
#include "hal/emulation/simulated_node.h"

namespace flexarm {

/// The commands of `flexarm rig`, one per line, as its help prints them.
extern const char* const kRigCommands;

/// Executes one line. @returns the error message for the operator; empty on success
std::string ExecuteRigCommand(const std::string& line, EmulatedRig* rig);

/// The same for the words after "amplifier NAME" and "node ROLE".
std::string CommandAmplifier(std::istringstream& words, SimulatedAmplifier* amplifier);
std::string CommandNode(std::istringstream& words, SimulatedNode* node);

}  // namespace flexarm
