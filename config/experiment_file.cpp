#include "config/experiment_file.h"

#include <map>
#include <optional>
#include <vector>

#include "config/attachment.h"
#include "config/config.h"
#include "config/document.h"
#include "config/line_key.h"
#include "config/problem_log.h"
#include "config/spelling.h"
#include "config/table_reader.h"
#include "controller/runlog/errors.h"

namespace flexarm {
namespace {

void ReadDoublet(TableReader row, Doublet* out) {
  row.Read("start_s", &out->start_s, "when it starts");
  row.Read("duration_s", &out->duration_s, "how long it takes; half of it each way");
  row.Read("shape", &out->shape, {{"square", DoubletShape::kSquare}, {"sine", DoubletShape::kSine}},
           "course of the torque");
  row.Read("move_deg", &out->move_deg,
           "angles by which joint 1, 2 turn; they determine the torque");
}

void ReadMove(TableReader row, Move* out) {
  row.Read("start_s", &out->start_s, "when it starts");
  row.ReadIfGiven(
      "duration_s", &out->duration_s,
      "how long it takes; without it: the shortest duration within limits.plan_fraction");
  if (row.Has("duration")) {
    row.Read("duration", &out->shortest, {{"shortest", true}},
             "in place of duration_s: the shortest for the payload that is found, for laws that "
             "estimate it; docs/experiments.md");
    if (row.Has("duration_s"))
      row.Refuse("duration_s", "must not be given beside duration = \"shortest\"");
  }
  row.ReadIfGiven("same_load", &out->same_load,
                  "true: the payload is that of the move before, so its estimate is kept");
  row.ReadIfGiven("profile", &out->profile,
                  {{"quintic", MoveProfile::kQuintic}, {"septic", MoveProfile::kSeptic}},
                  "polynomial of the angles; \"septic\" has no jump of the jerk");
  if (!row.Has("to_tip_m")) {
    row.Read("to_deg", &out->to_deg, "angles of joint 1, 2 at the end, absolute");
    if (row.Has("elbow"))
      row.Refuse("elbow", "must be given with to_tip_m only: with angles there is no choice");
    return;
  }
  row.Read("to_tip_m", &out->to_tip_m.emplace(),
           "in place of to_deg: x, y of the tip at the end, links straight");
  if (row.Has("to_deg"))
    row.Refuse("to_deg", "must not be given beside to_tip_m: a move has one goal");
  if (row.Has("elbow")) {
    row.Read(
        "elbow", &out->elbow.emplace(), {{"left", ElbowSide::kLeft}, {"right", ElbowSide::kRight}},
        "with to_tip_m: side of the line from shoulder to tip; needed where both are possible");
  }
}

void ReadLoadChange(TableReader row, LoadChange* out) {
  row.Read("at_s", &out->at_s, "when, after the start of the experiment");
}

void ReadChirp(TableReader row, Chirp* out) {
  row.Read("start_s", &out->start_s, "when it starts");
  row.Read("duration_s", &out->duration_s, "how long it takes");
  row.Read("from_hz", &out->from_hz, "frequency at its start");
  row.Read("to_hz", &out->to_hz, "frequency at its end; it changes linearly");
  row.Read("amplitude_deg", &out->amplitude_deg,
           "of the rigid arm's joint 1, 2; tapered at both ends");
}

void ReadPrbs(TableReader row, Prbs* out) {
  row.Read("start_s", &out->start_s, "when it starts");
  row.Read("hold_s", &out->hold_s, "length of one of the four parts of a pulse");
  row.Read("bits", &out->bits,
           {"of the shift register: the sequence has 2^bits - 1 pulses", "bits"});
  row.Read("seed", &out->seed, "where in the sequence it starts: 1 to 2^bits - 1");
  row.Read("torque_nm", &out->torque_nm, "amplitudes of joint 1, 2");
}

void ReadSimEvent(TableReader row, SimEvent* out) {
  row.Read("at_s", &out->at_s, "when, after the start of the experiment");
  const bool has_line = row.Has("line");
  if (has_line) {
    Line line{};
    ReadLine(row, &line);
    out->line = line;
  }
  if (has_line) {
    row.Read("level", &out->level, "0 forces the line open, 1 closed");
  } else if (row.Has("level")) {
    row.Refuse("level", "must be given with line only: it is the level of that line");
  }
  row.ReadIfGiven("freeze", &out->freeze,
                  {{"plant", FreezeTarget::kPlant}, {"control", FreezeTarget::kControl}},
                  "this task stops running");
  row.ReadIfGiven("kill", &out->kill, "true: the process kills itself");
  row.ReadIfGiven("payload_kg", &out->payload_kg, "payload of the arm from then on");
}

// The files that are attached to a text.
using Attachments = std::map<std::string, std::string>;  // file name, text

Attachments ReadAttachments(TableReader root) {
  Attachments attached;
  for (TableReader row : root.OptionalRows(
           "attached",
           "a file that [csv] names, as `flexarm run` and `flexarm simulate` append it")) {
    std::string file, text;
    row.Read("file", &file, "its name");
    row.Read("text", &text, "its contents");
    attached[file] = text;
  }
  return attached;
}

void ReadPlannedMoves(TableReader root, Experiment* out) {
  for (TableReader row : root.OptionalRows(
           "planned_move",
           "the duration that was chosen for a move without one, as the log of a run holds it")) {
    int number = 0;
    double duration_s = 0.0;
    row.Read("row", &number, "number of the [[move]], from 0");
    row.Read("duration_s", &duration_s, "how long it takes");
    const auto i = static_cast<std::size_t>(number);
    if (number < 0 || i >= out->move.size() || out->move[i].duration_s) {
      row.Refuse("row", "must name a [[move]] without duration_s, counted from 0");
      continue;
    }
    out->move[i].duration_s = duration_s;
  }
}

void ReadCsv(TableReader csv, const Attachments& attached, Experiment* out) {
  CsvTrajectory& trajectory = out->csv.emplace();
  csv.Read("start_s", &trajectory.start_s, "when its first row is due");
  csv.Read(
      "file", &trajectory.file,
      "CSV file with time_s and th1_deg, th2_deg or th1_rad, th2_rad; relative to the experiment");
  if (trajectory.file.empty()) return;
  const auto found = attached.find(trajectory.file);
  if (found == attached.end()) {
    csv.Refuse("file",
               "must be attached: read the experiment from its own file, or run it by "
               "`flexarm run` or `flexarm simulate`, which attach the file");
    out->csv.reset();
    return;
  }
  try {
    trajectory.point = ReadTrajectory(trajectory.file, found->second);
  } catch (const InputError& error) {
    csv.Refuse("file", error.what());
    out->csv.reset();
  }
}

// The law of a name; a name that no law has is reported.
std::optional<ControllerKind> LawByName(const std::string& name, TableReader* root) {
  std::vector<std::string> known;
  for (const LawRow& law : kLaws) {
    if (name == law.name) return law.kind;
    known.emplace_back(law.name);
  }
  const std::optional<std::string> meant = ClosestWord(name, known);
  std::string list;
  for (const std::string& law : known) list += " " + law;
  root->Refuse("laws", "has the unknown law \"" + name + "\"; " +
                           (meant ? "did you mean \"" + *meant + "\"?" : "the laws are:" + list));
  return std::nullopt;
}

void ReadDuration(TableReader root, Experiment* out) {
  out->duration_s = kLongestRun_s;
  root.ReadIfGiven(
      "duration_s", &out->duration_s,
      "length of the run, like all times a multiple of the period; without it: until a "
      "second after the last row");
  out->ends_after_rows = !root.Has("duration_s") && !root.Has("planned");
  if (!root.Has("planned")) return;
  root.Table("planned", "what was chosen, as the log of a run holds it")
      .Read("duration_s", &out->duration_s, "length of the run");
  if (root.Has("duration_s")) {
    root.Refuse("planned", "must not be given beside duration_s: a run has one length");
  }
}

void ReadLaws(TableReader root, Experiment* out) {
  if (!root.Has("laws")) return;
  std::vector<std::string> names;
  root.Read("laws", &names, "laws that the experiment is for; others are refused");
  for (const std::string& name : names) {
    if (const auto law = LawByName(name, &root)) out->laws.push_back(*law);
  }
}

}  // namespace

void ReadExperiment(TableReader root, Experiment* out) {
  root.Read("name", &out->name, "name of the experiment, for logs");
  ReadDuration(root, out);
  double speed_percent = 100.0;
  root.ReadIfGiven("speed_percent", &speed_percent,
                   {"share of the planned speed, 10 to 100: all of it takes longer", "%"});
  out->speed = speed_percent / 100.0;
  ReadLaws(root, out);
  root.ReadIfGiven("payload_kg", &out->payload_kg,
                   "least and greatest payload that it is for: the run is predicted with these and "
                   "the middle before it is granted");
  for (const TableReader& row : root.OptionalRows(
           "doublet", "a torque one way, then the other: from rest to rest elsewhere")) {
    ReadDoublet(row, &out->doublet.emplace_back());
  }
  for (const TableReader& row :
       root.OptionalRows("move", "a smooth move of both joints to a place")) {
    ReadMove(row, &out->move.emplace_back());
  }
  for (const TableReader& row :
       root.OptionalRows("chirp", "a sine of changing frequency, for identification")) {
    ReadChirp(row, &out->chirp.emplace_back());
  }
  for (const TableReader& row :
       root.OptionalRows("prbs", "a pseudo-random binary torque, for identification")) {
    ReadPrbs(row, &out->prbs.emplace_back());
  }
  const Attachments attached = ReadAttachments(root);
  if (root.Has("csv"))
    ReadCsv(root.Table("csv", "a trajectory of both joints from a file"), attached, out);
  ReadPlannedMoves(root, out);
  for (const TableReader& row :
       root.OptionalRows("load_change",
                         "the payload changes, as a gripper announces it: the estimate restarts")) {
    ReadLoadChange(row, &out->load_change.emplace_back());
  }
  for (const TableReader& row :
       root.OptionalRows("sim_event", "an event on the simulated rig; real rigs refuse it")) {
    ReadSimEvent(row, &out->sim_event.emplace_back());
  }
}

Experiment ParseExperiment(const std::string& text, const std::string& name) {
  const toml::table document = ParseToml(text, name);
  ProblemLog log(name, &document);
  Experiment experiment{};
  ReadExperiment(TableReader(&document, "", &log), &experiment);
  log.AddRules(experiment.Problems());
  log.AddUnknown();
  log.ThrowIfAny();
  experiment.text = text;
  return experiment;
}

Experiment LoadExperiment(const std::filesystem::path& file) {
  const std::string text = ReadConfigFile(file);
  return ParseExperiment(WithAttachments(text, file), file.string());
}

}  // namespace flexarm
