#pragma once

#include <cstdint>
#include <span>
#include <string>

// The targets of fuzzing: each gives bytes that may be anything to the code of the product that
// reads such bytes. The exception that this code documents is a right answer. Everything else, such
// as another exception, ends the program: these functions are noexcept.
//
// libFuzzer calls them in programs of their own (libfuzzer_entry.cpp), stored_inputs_test.cpp with
// the stored inputs.

namespace flexarm {

using FuzzBytes = std::span<const std::uint8_t>;

void FuzzConfig(FuzzBytes input) noexcept;
void FuzzExperiment(FuzzBytes input) noexcept;
void FuzzCsv(FuzzBytes input) noexcept;
void FuzzGains(FuzzBytes input) noexcept;
void FuzzCalibration(FuzzBytes input) noexcept;
void FuzzLog(FuzzBytes input) noexcept;
void FuzzSocket(FuzzBytes input) noexcept;
void FuzzModbus(FuzzBytes input) noexcept;
void FuzzCan(FuzzBytes input) noexcept;
void FuzzComedi(FuzzBytes input) noexcept;

inline std::string TextOf(FuzzBytes input) { return {input.begin(), input.end()}; }

}  // namespace flexarm
