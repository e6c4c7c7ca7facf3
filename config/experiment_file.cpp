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
  row.Read("start_s", &out->start_s);
  row.Read("duration_s", &out->duration_s);
  row.Read("shape", &out->shape,
           {{"square", DoubletShape::kSquare}, {"sine", DoubletShape::kSine}});
  row.Read("move_deg", &out->move_deg);
}

void ReadMove(TableReader row, Move* out) {
  row.Read("start_s", &out->start_s);
  if (row.Has("duration_s")) row.Read("duration_s", &out->duration_s.emplace());
  if (row.Has("profile")) {
    row.Read("profile", &out->profile,
             {{"quintic", MoveProfile::kQuintic}, {"septic", MoveProfile::kSeptic}});
  }
  if (!row.Has("to_tip_m")) {
    row.Read("to_deg", &out->to_deg);
    if (row.Has("elbow"))
      row.Refuse("elbow", "must be given with to_tip_m only: with angles there is no choice");
    return;
  }
  row.Read("to_tip_m", &out->to_tip_m.emplace());
  if (row.Has("to_deg"))
    row.Refuse("to_deg", "must not be given beside to_tip_m: a move has one goal");
  if (row.Has("elbow")) {
    row.Read("elbow", &out->elbow.emplace(),
             {{"left", ElbowSide::kLeft}, {"right", ElbowSide::kRight}});
  }
}

void ReadChirp(TableReader row, Chirp* out) {
  row.Read("start_s", &out->start_s);
  row.Read("duration_s", &out->duration_s);
  row.Read("from_hz", &out->from_hz);
  row.Read("to_hz", &out->to_hz);
  row.Read("amplitude_deg", &out->amplitude_deg);
}

void ReadPrbs(TableReader row, Prbs* out) {
  row.Read("start_s", &out->start_s);
  row.Read("hold_s", &out->hold_s);
  row.Read("bits", &out->bits);
  row.Read("seed", &out->seed);
  row.Read("torque_nm", &out->torque_nm);
}

void ReadSimEvent(TableReader row, SimEvent* out) {
  row.Read("at_s", &out->at_s);
  const bool has_line = row.Has("line");
  if (has_line) {
    Line line{};
    ReadLine(row, &line);
    out->line = line;
  }
  if (has_line) {
    row.Read("level", &out->level);
  } else if (row.Has("level")) {
    row.Refuse("level", "must be given with line only: it is the level of that line");
  }
  if (row.Has("freeze")) {
    row.Read("freeze", &out->freeze,
             {{"plant", FreezeTarget::kPlant}, {"control", FreezeTarget::kControl}});
  }
  if (row.Has("kill")) row.Read("kill", &out->kill);
  if (row.Has("payload_kg")) row.Read("payload_kg", &out->payload_kg.emplace());
}

// The files that are attached to a text.
using Attachments = std::map<std::string, std::string>;  // file name, text

Attachments ReadAttachments(TableReader root) {
  Attachments attached;
  for (TableReader row : root.OptionalRows("attached")) {
    std::string file, text;
    row.Read("file", &file);
    row.Read("text", &text);
    attached[file] = text;
  }
  return attached;
}

void ReadPlannedMoves(TableReader root, Experiment* out) {
  for (TableReader row : root.OptionalRows("planned_move")) {
    int number = 0;
    double duration_s = 0.0;
    row.Read("row", &number);
    row.Read("duration_s", &duration_s);
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
  csv.Read("start_s", &trajectory.start_s);
  csv.Read("file", &trajectory.file);
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

void ReadLaws(TableReader root, Experiment* out) {
  if (!root.Has("laws")) return;
  std::vector<std::string> names;
  root.Read("laws", &names);
  for (const std::string& name : names) {
    if (const auto law = LawByName(name, &root)) out->laws.push_back(*law);
  }
}

void ReadExperiment(TableReader root, Experiment* out) {
  root.Read("name", &out->name);
  root.Read("duration_s", &out->duration_s);
  ReadLaws(root, out);
  if (root.Has("payload_kg")) root.Read("payload_kg", &out->payload_kg.emplace());
  for (const TableReader& row : root.OptionalRows("doublet")) {
    ReadDoublet(row, &out->doublet.emplace_back());
  }
  for (const TableReader& row : root.OptionalRows("move")) {
    ReadMove(row, &out->move.emplace_back());
  }
  for (const TableReader& row : root.OptionalRows("chirp")) {
    ReadChirp(row, &out->chirp.emplace_back());
  }
  for (const TableReader& row : root.OptionalRows("prbs")) {
    ReadPrbs(row, &out->prbs.emplace_back());
  }
  const Attachments attached = ReadAttachments(root);
  if (root.Has("csv")) ReadCsv(root.Table("csv"), attached, out);
  ReadPlannedMoves(root, out);
  for (const TableReader& row : root.OptionalRows("sim_event")) {
    ReadSimEvent(row, &out->sim_event.emplace_back());
  }
}

}  // namespace

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
