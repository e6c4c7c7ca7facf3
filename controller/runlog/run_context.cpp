#include "controller/runlog/run_context.h"

#include <nlohmann/json.hpp>

namespace flexarm {
namespace {

std::uint32_t NumberOf(const RunEvent& announcement) {
  if (announcement.value_json.empty()) return 0;
  return nlohmann::json::parse(announcement.value_json).value("number", std::uint32_t{0});
}

}  // namespace

void RunContext::Add(const RunEvent& event) {
  if (Announces(event)) {
    experiment_ = event;
    experiment_number_ = NumberOf(event);
  } else if (events_.size() < kMostEvents) {
    events_.push_back(event);
  }
}

RunEvent RunContext::Experiment(std::uint32_t request_number) const {
  const bool is_its = experiment_number_ == 0 || experiment_number_ == request_number;
  return is_its ? experiment_ : RunEvent{};
}

}  // namespace flexarm
