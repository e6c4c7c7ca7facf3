#include <optional>

#include "config/config.h"
#include "config/document.h"
#include "config/line_key.h"
#include "config/problem_log.h"
#include "config/table_reader.h"

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
  row.Read("duration_s", &out->duration_s);
  row.Read("to_deg", &out->to_deg);
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
    row.Refuse("level", "must stand beside line: it is the level of that line");
  }
  if (row.Has("freeze")) {
    row.Read("freeze", &out->freeze,
             {{"plant", FreezeTarget::kPlant}, {"control", FreezeTarget::kControl}});
  }
  if (row.Has("kill")) row.Read("kill", &out->kill);
}

void ReadExperiment(TableReader root, Experiment* out) {
  root.Read("name", &out->name);
  root.Read("duration_s", &out->duration_s);
  for (const TableReader& row : root.OptionalRows("doublet")) {
    ReadDoublet(row, &out->doublet.emplace_back());
  }
  for (const TableReader& row : root.OptionalRows("move")) {
    ReadMove(row, &out->move.emplace_back());
  }
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
  return ParseExperiment(ReadConfigFile(file), file.string());
}

}  // namespace flexarm
