#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

// The targets of fuzzing: each gives bytes that may be anything to the code of the product that
// reads such bytes. The exception that this code documents is a right answer, and is caught there.
// Another exception leaves the function, and is a finding.
//
// libFuzzer calls them in programs of their own (libfuzzer_entry.cpp), stored_inputs_test.cpp with
// the stored inputs.

namespace flexarm {

using FuzzBytes = std::span<const std::uint8_t>;

void FuzzConfig(FuzzBytes input);
void FuzzExperiment(FuzzBytes input);
void FuzzCsv(FuzzBytes input);
void FuzzGains(FuzzBytes input);
void FuzzCalibration(FuzzBytes input);
void FuzzLog(FuzzBytes input);
void FuzzSocket(FuzzBytes input);
void FuzzClient(FuzzBytes input);
void FuzzTelemetry(FuzzBytes input);
void FuzzModbus(FuzzBytes input);
void FuzzCan(FuzzBytes input);
void FuzzComedi(FuzzBytes input);

/// For a target: what must hold whatever the input is.
inline void Expect(bool holds, const char* what) {
  if (!holds) throw std::logic_error(what);
}

inline std::string TextOf(FuzzBytes input) { return {input.begin(), input.end()}; }

}  // namespace flexarm
