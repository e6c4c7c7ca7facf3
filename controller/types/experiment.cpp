#include "controller/types/experiment.h"

#include <algorithm>
#include <cstddef>

#include "controller/types/rejected_error.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr double kRoundingS = 1e-9;  // decimal times added in binary; the loop samples every 5 ms
constexpr int kMostBits = 12;        // of a prbs: 4095 pulses

// A row and the key that its duration follows from.
struct Act {
  std::string kind;
  std::string row;
  double start_s;
  double duration_s;  // 0: not known yet
  std::string duration_key;

  double end_s() const { return start_s + duration_s; }
};

template <typename Row, typename Duration>
void AddActs(const std::vector<Row>& rows, const std::string& kind, const std::string& key,
             const Duration& duration, std::vector<Act>* acts) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string row = ProblemList::Element(kind, i);
    acts->push_back({.kind = kind,
                     .row = row,
                     .start_s = rows[i].start_s,
                     .duration_s = duration(rows[i]),
                     .duration_key = row + "." + key});
  }
}

std::vector<Act> ActsOf(const Experiment& e) {
  std::vector<Act> acts;
  AddActs(e.doublet, "doublet", "duration_s", [](const auto& r) { return r.duration_s; }, &acts);
  AddActs(
      e.move, "move", "duration_s", [](const auto& r) { return r.duration_s.value_or(0.0); },
      &acts);
  AddActs(e.chirp, "chirp", "duration_s", [](const auto& r) { return r.duration_s; }, &acts);
  AddActs(e.prbs, "prbs", "bits", [](const auto& r) { return r.duration_s(); }, &acts);
  if (e.csv) {
    acts.push_back({.kind = "csv",
                    .row = "csv",
                    .start_s = e.csv->start_s,
                    .duration_s = e.csv->duration_s(),
                    .duration_key = "csv.file"});
  }
  return acts;
}

// A row against the one above it of the same kind. A move may begin while the one above it lasts:
// PlanMoves decides whether the law can retarget.
void CheckOrder(const Act& act, const Act& above, ProblemList* list) {
  if (act.kind == "move") {
    list->Require(act.start_s > above.start_s + kRoundingS, act.row + ".start_s",
                  NumberText(act.start_s),
                  "must begin later than the move above it, at " + NumberText(above.start_s) +
                      " s: rows are in order of time");
  } else {
    list->Require(
        !(act.start_s < above.end_s() - kRoundingS), act.row + ".start_s", NumberText(act.start_s),
        "must not begin before the " + act.kind + " above it ends, at " +
            NumberText(above.end_s()) + " s: rows are in order of time and do not overlap");
  }
}

// The times of acts[i] against the experiment and all acts before it in the list.
void CheckTimes(const std::vector<Act>& acts, std::size_t i, double experiment_s,
                ProblemList* list) {
  const Act& act = acts[i];
  list->Within(act.row + ".start_s", act.start_s, 0.0, 3600.0, "after the start of the experiment");
  list->Require(
      !(act.end_s() > experiment_s + kRoundingS), act.duration_key, NumberText(act.duration_s),
      "must end inside the experiment: the " + act.kind + " ends at " + NumberText(act.end_s()) +
          " s, the experiment at duration_s = " + NumberText(experiment_s));
  for (std::size_t j = 0; j < i; ++j) {
    const Act& other = acts[j];
    const bool before = act.end_s() < other.start_s + kRoundingS;
    const bool after = !(act.start_s < other.end_s() - kRoundingS);
    if (other.kind != act.kind) {
      list->Require(before || after, act.row + ".start_s", NumberText(act.start_s),
                    "must not overlap a " + other.kind + ": one acts from " +
                        NumberText(other.start_s) + " to " + NumberText(other.end_s()) + " s");
    } else if (j + 1 == i) {
      CheckOrder(act, other, list);
    }
  }
}

void CheckDoublet(const Doublet& doublet, const std::string& row, ProblemList* list) {
  list->Positive(row + ".duration_s", doublet.duration_s, 3600.0,
                 "half of it accelerates, half of it decelerates");
  list->EachWithin(row + ".move_deg", doublet.move_deg, -360.0, 360.0, "of th1 and th2");
}

void CheckMove(const Move& move, const std::string& row, ProblemList* list) {
  if (move.duration_s) {
    list->Positive(row + ".duration_s", *move.duration_s, 3600.0,
                   "half of it accelerates, half of it decelerates");
  }
  list->EachWithin(row + ".to_deg", move.to_deg, -360.0, 360.0, "th1 and th2 at the end");
  if (move.to_tip_m) {
    list->EachWithin(row + ".to_tip_m", *move.to_tip_m, -100.0, 100.0, "x and y of the tip");
  }
}

void CheckChirp(const Chirp& chirp, const std::string& row, ProblemList* list) {
  list->Positive(row + ".duration_s", chirp.duration_s, 3600.0, "the duration of the sweep");
  list->Within(row + ".from_hz", chirp.from_hz, 0.0, 1000.0, "the frequency at the start");
  list->Positive(row + ".to_hz", chirp.to_hz, 1000.0, "the frequency at the end");
  list->EachWithin(row + ".amplitude_deg", chirp.amplitude_deg, -90.0, 90.0, "of th1 and th2");
}

void CheckPrbs(const Prbs& prbs, const std::string& row, ProblemList* list) {
  list->Positive(row + ".hold_s", prbs.hold_s, 60.0,
                 "the shortest time of constant sign of the torque");
  list->Within(row + ".bits", prbs.bits, 2, kMostBits, "the sequence has 2^bits - 1 pulses");
  if (prbs.bits >= 2 && prbs.bits <= kMostBits) {
    list->Within(row + ".seed", prbs.seed, 1, prbs.pulses(),
                 "the initial state of the shift register");
  }
  list->EachWithin(row + ".torque_nm", prbs.torque_nm, -1000.0, 1000.0, "of joint 1 and 2");
}

void CheckSimEvent(const Experiment& experiment, std::size_t i, ProblemList* list) {
  const SimEvent& event = experiment.sim_event[i];
  const std::string row = ProblemList::Element("sim_event", i);
  list->Require(event.at_s >= 0.0 && !(event.at_s > experiment.duration_s), row + ".at_s",
                NumberText(event.at_s), "must lie inside the experiment");
  const int kinds = static_cast<int>(event.line.has_value()) +
                    static_cast<int>(event.freeze != FreezeTarget::kNone) +
                    static_cast<int>(event.kill) + static_cast<int>(event.payload_kg.has_value());
  list->Require(kinds == 1, row, NumberText(kinds) + " of them",
                "must have exactly one of line (with level), freeze, kill = true, payload_kg");
  if (event.payload_kg) {
    list->Within(row + ".payload_kg", *event.payload_kg, 0.0, 100.0,
                 "the payload of the plant from then on");
  }
  list->Require(event.level == 0 || event.level == 1, row + ".level", NumberText(event.level),
                "must be 0 (open) or 1 (closed)");
}

template <typename Row, typename Check>
void CheckRows(const std::vector<Row>& rows, const std::string& kind, const Check& check,
               ProblemList* list) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    check(rows[i], ProblemList::Element(kind, i), list);
  }
}

}  // namespace

std::vector<Problem> Experiment::Problems() const {
  ProblemList list("");
  const bool printable = std::all_of(name.begin(), name.end(),
                                     [](char c) { return static_cast<unsigned char>(c) >= 32; });
  list.Require(!name.empty() && name.size() <= 64 && printable, "name", name,
               "must be 1 to 64 printable characters: it names the run in the log");
  list.Positive("duration_s", duration_s, kLongestRun_s, "the duration of the run");
  list.Within("speed_percent", 100.0 * speed, 100.0 * kLeastSpeed, 100.0,
              "the share of the planned speed");
  list.Require(!ends_after_rows || !Motions().empty(), "duration_s", "",
               "must be given where no row says when the run is over");
  if (payload_kg) {
    list.EachWithin("payload_kg", *payload_kg, 0.0, 100.0, "the payloads that it is for");
    list.Require(!((*payload_kg)[0] > (*payload_kg)[1]), "payload_kg",
                 NumberText((*payload_kg)[0]) + ", " + NumberText((*payload_kg)[1]),
                 "must be the least payload, then the greatest");
  }
  CheckRows(doublet, "doublet", CheckDoublet, &list);
  CheckRows(move, "move", CheckMove, &list);
  CheckRows(chirp, "chirp", CheckChirp, &list);
  CheckRows(prbs, "prbs", CheckPrbs, &list);
  const std::vector<Act> acts = ActsOf(*this);
  for (std::size_t i = 0; i < acts.size(); ++i) CheckTimes(acts, i, duration_s, &list);
  for (std::size_t i = 0; i < sim_event.size(); ++i) CheckSimEvent(*this, i, &list);
  for (std::size_t i = 0; i < load_change.size(); ++i) {
    const double at_s = load_change[i].at_s;
    const double above_s = i == 0 ? 0.0 : load_change[i - 1].at_s;
    list.Require(at_s >= above_s && !(at_s > duration_s),
                 ProblemList::Element("load_change", i) + ".at_s", NumberText(at_s),
                 "must lie inside the experiment, and rows are in order of time");
  }
  return list.Take();
}

std::vector<Motion> Experiment::Motions() const {
  std::vector<Motion> motions;
  for (const Act& act : ActsOf(*this)) motions.push_back({act.row, act.start_s, act.duration_s});
  std::stable_sort(motions.begin(), motions.end(),
                   [](const Motion& a, const Motion& b) { return a.start_s < b.start_s; });
  return motions;
}

Experiment AtSpeed(Experiment experiment, double speed) {
  if (speed == 1.0) return experiment;
  if (experiment.speed != 1.0) {
    throw RejectedError("speed_percent: the experiment states its own: leave out the option");
  }
  experiment.speed = speed;
  experiment.text = "speed_percent = " + NumberText(100.0 * speed) + "\n" + experiment.text;
  return experiment;
}

}  // namespace flexarm
