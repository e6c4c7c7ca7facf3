#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "controller/types/safety_state.h"
#include "controller/types/trip_cause.h"

namespace flexarm {
namespace {

// The names in the first cells of the tables of docs/safety.md, section "The way back to Idle";
// only of rows whose second cell says something.
std::set<std::string> NamesOfThePage() {
  std::ifstream file(std::filesystem::path(FLEXARM_SOURCE_DIR) / "docs/safety.md");
  std::set<std::string> names;
  bool is_section = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("## ")) is_section = line == "## The way back to Idle";
    if (!is_section || !line.starts_with("| ")) continue;
    std::istringstream cells(line.substr(2));
    std::string first, second;
    std::getline(cells, first, '|');
    std::getline(cells, second, '|');
    if (second.find_first_not_of(' ') == std::string::npos) continue;
    for (std::size_t at = first.find('`'); at != std::string::npos;) {
      const std::size_t end = first.find('`', at + 1);
      names.insert(first.substr(at + 1, end - at - 1));
      at = first.find('`', end + 1);
    }
  }
  return names;
}

TEST(WayBack, ThePageNamesOneForEveryStateAndEveryCause) {
  std::set<std::string> expected;
  for (int state = 0; state < kSafetyStates; ++state) {
    expected.insert(ToString(static_cast<SafetyState>(state)));
  }
  for (int cause = 1; cause < kTripCauses; ++cause) {
    expected.insert(ToString(static_cast<TripCause>(cause)));
  }
  EXPECT_EQ(NamesOfThePage(), expected);
}

}  // namespace
}  // namespace flexarm
