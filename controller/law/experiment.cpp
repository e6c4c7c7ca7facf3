#include "controller/law/experiment.h"

#include <algorithm>
#include <cstddef>

#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr double kRoundingS = 1e-9;  // decimal times added in binary; the loop samples every 5 ms

// The times of row i of `rows`, which are doublets or moves: `kind`.
template <typename Row>
void CheckTimes(const std::vector<Row>& rows, std::size_t i, const std::string& kind,
                double experiment_s, ProblemList* list) {
  const Row& r = rows[i];
  const std::string row = ProblemList::Element(kind, i);
  list->Within(row + ".start_s", r.start_s, 0.0, 3600.0, "after the start of the experiment");
  list->Positive(row + ".duration_s", r.duration_s, 3600.0, "half of it pushes, half of it brakes");
  const double end = r.start_s + r.duration_s;
  list->Require(!(end > experiment_s + kRoundingS), row + ".duration_s", NumberText(r.duration_s),
                "must end inside the experiment: the " + kind + " ends at " + NumberText(end) +
                    " s, the experiment at duration_s = " + NumberText(experiment_s));
  if (i == 0) return;
  const double free_from = rows[i - 1].start_s + rows[i - 1].duration_s;
  list->Require(!(r.start_s < free_from - kRoundingS), row + ".start_s", NumberText(r.start_s),
                "must not begin before the " + kind + " above it ends, at " +
                    NumberText(free_from) + " s: rows are in order of time and do not overlap");
}

void CheckDoublet(const Experiment& experiment, std::size_t i, ProblemList* list) {
  CheckTimes(experiment.doublet, i, "doublet", experiment.duration_s, list);
  list->EachWithin(ProblemList::Element("doublet", i) + ".move_deg", experiment.doublet[i].move_deg,
                   -360.0, 360.0, "of th1 and th2");
}

void CheckMove(const Experiment& experiment, std::size_t i, ProblemList* list) {
  CheckTimes(experiment.move, i, "move", experiment.duration_s, list);
  const Move& m = experiment.move[i];
  const std::string row = ProblemList::Element("move", i);
  list->EachWithin(row + ".to_deg", m.to_deg, -360.0, 360.0, "th1 and th2 at the end");
  for (const Doublet& d : experiment.doublet) {
    const bool apart = m.start_s + m.duration_s < d.start_s + kRoundingS ||
                       d.start_s + d.duration_s < m.start_s + kRoundingS;
    list->Require(apart, row + ".start_s", NumberText(m.start_s),
                  "must not overlap a doublet: one acts from " + NumberText(d.start_s) + " to " +
                      NumberText(d.start_s + d.duration_s) + " s");
  }
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
  for (std::size_t i = 0; i < move.size(); ++i) CheckMove(*this, i, &list);
  for (std::size_t i = 0; i < sim_event.size(); ++i) CheckSimEvent(*this, i, &list);
  return list.Take();
}

std::vector<Motion> Experiment::Motions() const {
  std::vector<Motion> motions;
  for (const Doublet& d : doublet) motions.push_back({d.start_s, d.duration_s});
  for (const Move& m : move) motions.push_back({m.start_s, m.duration_s});
  std::sort(motions.begin(), motions.end(),
            [](const Motion& a, const Motion& b) { return a.start_s < b.start_s; });
  return motions;
}

}  // namespace flexarm
