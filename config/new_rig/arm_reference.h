#pragma once

#include "config/config_reference.h"

namespace flexarm {

/// The keys of a description of an arm (ArmDescriptionReader): those of ArmKeys, name and material.
KeyListing ArmReference();

}  // namespace flexarm
