#pragma once

#include <gtest/gtest.h>

#include <string>

#include "hal/emulation/drive_supply.h"

namespace flexarm {

/// Drives that the relay feeds, of every kind that the emulation knows.
inline const auto kSupplyModels =
    testing::Values(DriveSupplyModel{}, DriveSupplyModel{.clears_itself = true},
                    DriveSupplyModel{.safe_torque_off = true});

inline std::string NameOfSupply(const testing::TestParamInfo<DriveSupplyModel>& model) {
  if (model.param.clears_itself) return "ClearsItself";
  return model.param.safe_torque_off ? "SafeTorqueOff" : "Plain";
}

}  // namespace flexarm
