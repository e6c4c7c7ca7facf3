// Searches the inputs with the slowest Step, safety tick and plan, or counts those that a search
// has found: tests/bench/slowest.py runs it under callgrind.
//
//   slowest_step PREFIX search NAMES SEED CANDIDATES   prints the slowest candidate of each
//   scenario slowest_step PREFIX check NAMES FILE               counts the candidates of a file of
//   such lines
//
// PREFIX is callgrind's --callgrind-out-file; NAMES is a part of the names of the scenarios, or "".
// A line is: name, instructions, median, words.

#include <cstdio>
#include <exception>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/config.h"
#include "tests/bench/plan_scenario.h"
#include "tests/bench/safety_scenario.h"
#include "tests/bench/step_scenario.h"
#include "tests/support/recorded_inputs.h"

namespace flexarm {
namespace {

void Print(const std::string& name, std::int64_t instructions, std::int64_t median,
           const Candidate& candidate) {
  std::printf("%s %lld %lld", name.c_str(), static_cast<long long>(instructions),
              static_cast<long long>(median));
  for (const std::uint32_t word : candidate) std::printf(" %x", word);
  std::printf("\n");
  std::fflush(stdout);
}

// A third of the candidates is random. Each of the others changes one to four words of the slowest
// so far, and takes its place unless it is faster.
void Search(Scenario& scenario, unsigned seed, int candidates) {
  std::mt19937 random(seed);
  const std::int64_t median = scenario.Median();
  std::int64_t most = 0;
  Candidate slowest{};
  for (int i = 0; i < candidates; ++i) {
    Candidate candidate = slowest;
    if (i < candidates / 3) {
      for (std::uint32_t& word : candidate) word = static_cast<std::uint32_t>(random());
    } else {
      for (auto left = 1 + random() % 4; left > 0; --left) {
        candidate[random() % candidate.size()] = static_cast<std::uint32_t>(random());
      }
    }
    const std::int64_t cost = scenario.Cost(candidate);
    if (cost < most) continue;
    most = cost;
    slowest = candidate;
  }
  Print(scenario.name(), most, median, slowest);
}

// A line of a file, as Print writes it.
struct Stored {
  std::int64_t median = 0;
  Candidate candidate{};
};

std::map<std::string, Stored> Read(const std::string& file) {
  std::map<std::string, Stored> stored;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string name;
    std::int64_t found = 0, median = 0;
    words >> name >> found >> median >> std::hex;
    stored[name].median = median;
    for (std::uint32_t& word : stored[name].candidate) words >> word;
    if (!words) throw std::runtime_error("not a candidate: " + line);
  }
  return stored;
}

// The median is the stored one: counting it takes ten times as long as the candidate.
void Check(Scenario& scenario, const std::map<std::string, Stored>& stored) {
  const auto found = stored.find(scenario.name());
  if (found == stored.end()) throw std::runtime_error("no candidate of " + scenario.name());
  const auto& [median, candidate] = found->second;
  Print(scenario.name(), scenario.Cost(candidate), median, candidate);
}

int Run(const std::vector<std::string>& arguments) {
  if (arguments.size() < 4) {
    std::fprintf(stderr, "see tests/bench/slowest_step.cpp\n");
    return 2;
  }
  InstructionCounter counter{std::filesystem::path(arguments[0])};
  const std::string& names = arguments[2];
  const auto is_meant = [&names](const std::string& name) {
    return name.find(names) != std::string::npos;
  };
  const bool searches = arguments[1] == "search";
  std::map<std::string, Stored> stored;
  if (!searches) stored = Read(arguments[3]);
  const auto handle = [&](Scenario& scenario) {
    if (!searches) return Check(scenario, stored);
    const int candidates = std::stoi(arguments.at(4));
    // A plan takes as long as a hundred steps.
    Search(scenario, static_cast<unsigned>(std::stoul(arguments[3])),
           scenario.name() == "plan-stage" ? candidates / 4 : candidates);
  };
  if (is_meant("safety-tick")) handle(*std::make_unique<SafetyScenario>(counter));
  if (is_meant("plan-stage")) handle(*std::make_unique<PlanScenario>(counter));
  std::vector<StepInput> inputs;
  for (const StepVariant& variant : StepVariants()) {
    if (!is_meant(StepScenario::NameOf(variant))) continue;
    if (inputs.empty()) inputs = RecordedInputs(LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml"));
    handle(*std::make_unique<StepScenario>(variant, inputs, counter));
  }
  return 0;
}

}  // namespace
}  // namespace flexarm

int main(int argc, char** argv) {
  try {
    return flexarm::Run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slowest_step: %s\n", error.what());
    return 1;
  }
}
