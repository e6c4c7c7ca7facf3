#include "tools/flexarm/override_options.h"

#include <nlohmann/json.hpp>

#include "controller/operator/override.h"
#include "controller/runlog/errors.h"

namespace flexarm {

void OverrideOptions::AddTo(CLI::App* verb, const std::string& option, const std::string& condition,
                            const std::string& what) {
  Given& given = given_[condition];
  given.option = verb->add_option(option, given.reason, what)->type_name("REASON")->expected(1);
}

void OverrideOptions::PutInto(nlohmann::ordered_json* command) const {
  for (const auto& [condition, given] : given_) {
    if (given.option->count() == 0) continue;
    if (const std::string problem = ProblemOfReason(given.reason); !problem.empty()) {
      throw InputError(given.option->get_name() + ": the reason " + problem +
                       "; expected one line of text, at most " + std::to_string(kLongestReason) +
                       " bytes");
    }
    (*command)["overrides"][condition] = given.reason;
  }
}

}  // namespace flexarm
