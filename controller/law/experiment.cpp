#include "controller/law/experiment.h"

#include <algorithm>
#include <cstddef>

#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr double kRoundingS = 1e-9;  // decimal times added in binary; the loop samples every 5 ms

void CheckDoublet(const Experiment& experiment, std::size_t i, ProblemList* list) {
  const Doublet& d = experiment.doublet[i];
  const std::string row = ProblemList::Element("doublet", i);
  list->Within(row + ".start_s", d.start_s, 0.0, 3600.0, "after the start of the experiment");
  list->Positive(row + ".duration_s", d.duration_s, 3600.0, "half of it pushes, half of it brakes");
  list->EachWithin(row + ".move_deg", d.move_deg, -360.0, 360.0, "of th1 and th2");
  const double end = d.start_s + d.duration_s;
  list->Require(!(end > experiment.duration_s + kRoundingS), row + ".duration_s",
                NumberText(d.duration_s),
                "must end inside the experiment: the doublet ends at " + NumberText(end) +
                    " s, the experiment at duration_s = " + NumberText(experiment.duration_s));
  if (i == 0) return;
  const Doublet& before = experiment.doublet[i - 1];
  const double free_from = before.start_s + before.duration_s;
  list->Require(!(d.start_s < free_from - kRoundingS), row + ".start_s", NumberText(d.start_s),
                "must not begin before the doublet above it ends, at " + NumberText(free_from) +
                    " s: rows are in order of time and do not overlap");
}

void CheckSimEvent(const Experiment& experiment, std::size_t i, ProblemList* list) {
  const SimEvent& event = experiment.sim_event[i];
  const std::string row = ProblemList::Element("sim_event", i);
  list->Require(event.at_s >= 0.0 && !(event.at_s > experiment.duration_s), row + ".at_s",
                NumberText(event.at_s), "must lie inside the experiment");
  const int kinds = static_cast<int>(event.line.has_value()) +
                    static_cast<int>(event.freeze != FreezeTarget::kNone) +
                    static_cast<int>(event.kill);
  list->Require(kinds == 1, row, NumberText(kinds) + " of them",
                "must have exactly one of line (with level), freeze, kill = true");
  list->Require(event.level == 0 || event.level == 1, row + ".level", NumberText(event.level),
                "must be 0 (open) or 1 (closed)");
}

}  // namespace

std::vector<Problem> Experiment::Problems() const {
  ProblemList list("");
  const bool printable = std::all_of(name.begin(), name.end(),
                                     [](char c) { return static_cast<unsigned char>(c) >= 32; });
  list.Require(!name.empty() && name.size() <= 64 && printable, "name", name,
               "must be 1 to 64 printable characters: it names the run in the log");
  list.Positive("duration_s", duration_s, 3600.0, "the run ends then");
  for (std::size_t i = 0; i < doublet.size(); ++i) CheckDoublet(*this, i, &list);
  for (std::size_t i = 0; i < sim_event.size(); ++i) CheckSimEvent(*this, i, &list);
  return list.Take();
}

}  // namespace flexarm
