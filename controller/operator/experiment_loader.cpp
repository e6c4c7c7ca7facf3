#include "controller/operator/experiment_loader.h"

#include <utility>

#include "controller/runlog/run_label.h"
#include "controller/types/rejected_error.h"

namespace flexarm {

ExperimentLoader::Order ExperimentLoader::Plan(const Experiment& experiment,
                                               const std::array<double, 2>& start_rad,
                                               const std::stop_token& stop) const {
  if (!stack_->simulated()) RefuseSimEvents(experiment);
  Order order{.planned = std::make_shared<const PlannedExperiment>(
                  experiment, *design_, grid_.period_s(), start_rad, limits(), stop),
              .name = {},
              .text = {}};
  order.name = order.planned->accepted.name;
  order.text = order.planned->accepted.text;
  return order;
}

ExperimentLoader::Order ExperimentLoader::PlanChange(const PlannedExperiment& planned, int from,
                                                     const NewPath& path) const {
  if (!planned.load_change.empty()) {
    throw RejectedError(
        "the experiment announces changes of the payload at fixed times ([[load_change]]): its "
        "path cannot be slowed or changed");
  }
  ReferenceTable changed = path(planned.reference, from, *design_, limits());
  return {.planned = std::make_shared<const PlannedExperiment>(planned, std::move(changed), from),
          .name = planned.accepted.name,
          .text = planned.accepted.text};
}

std::shared_ptr<const PlannedExperiment> ExperimentLoader::Find(std::uint32_t number) const {
  for (const Asked& asked : asked_) {
    if (asked.number == number) return asked.order.planned;
  }
  return nullptr;
}

std::uint32_t ExperimentLoader::AskForChange(std::int64_t now_ns, int client, Order order,
                                             const Change& change) {
  if (requests_->busy()) return 0;
  const RunOrder run{.experiment = order.planned.get()};
  asked_.push_back({.number = 0, .order = std::move(order)});
  const std::uint32_t number =
      requests_->AskForChange(now_ns, client, run, change.run, change.not_after_ns).number;
  asked_.back().number = number;
  return number;
}

std::uint32_t ExperimentLoader::AskForRun(std::int64_t now_ns, int client, Order order) {
  if (requests_->busy()) return 0;
  const RunOrder run{.experiment = order.planned.get(), .may_open = order.may_open};
  // Kept before it is asked for: the safety task may grant it at once.
  asked_.push_back({.number = 0, .order = std::move(order)});
  asked_.back().number = requests_->Ask(RequestKind::kRun, now_ns, client, run).number;
  Announce(now_ns, asked_.back().order, asked_.back().number);
  return asked_.back().number;
}

void ExperimentLoader::Answered(const RequestAnswer& answer) {
  if (asked_.empty() || asked_.back().number != answer.number) return;
  if (answer.refusal == Refusal::kNone) {
    name_ = asked_.back().order.name;
  } else {
    asked_.pop_back();
  }
}

void ExperimentLoader::Announce(std::int64_t now_ns, const Order& order, std::uint32_t number) {
  if (number == 0) name_ = order.name;
  if (stack_->reduced()) {
    events_->Push({.time_ns = now_ns,
                   .kind = "limits",
                   .name = "reduced",
                   .text = "the limits are reduced (safety.reduced)",
                   .value_json = {}});
  }
  events_->Push({.time_ns = now_ns,
                 .kind = "experiment",
                 .name = order.name,
                 .text = order.text,
                 .value_json = Announcement(number, order.label)});
}

void ExperimentLoader::FreeReleased() {
  while (!asked_.empty() && asked_.front().number < stack_->released_experiments()) {
    asked_.pop_front();
  }
}

}  // namespace flexarm
