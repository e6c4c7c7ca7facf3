#pragma once

#include <sstream>
#include <string>

#include "hal/emulation/emulated_rig.h"
#include "hal/emulation/simulated_amplifier.h"
#include "hal/emulation/simulated_node.h"

namespace flexarm {

/// The commands of `flexarm rig`, one a line, as its help prints them.
extern const char* const kRigCommands;

/// Does what a line says. @returns what is wrong with it, for people; empty if it was done
std::string ExecuteRigCommand(const std::string& line, EmulatedRig* rig);

/// The same for what follows "amplifier NAME" and "node ROLE".
std::string ObeyAmplifier(std::istringstream& words, SimulatedAmplifier* amplifier);
std::string ObeyNode(std::istringstream& words, SimulatedNode* node);

}  // namespace flexarm
