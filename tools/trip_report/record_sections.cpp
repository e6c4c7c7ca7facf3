#include <exception>

#include "controller/files/external_text.h"
#include "controller/host/daemon_identity.h"
#include "controller/runlog/build_info.h"
#include "controller/runlog/replay.h"
#include "tools/replay/log_replay.h"
#include "tools/trip_report/config_changes.h"
#include "tools/trip_report/trip_sections.h"

namespace flexarm {
namespace {

constexpr std::int64_t kMostReplayed = 20'000;  // samples: less than a second of work
constexpr std::size_t kMostChanges = 200;
constexpr std::size_t kMostValue = 300;  // bytes of a value

std::string OrDash(const std::string& text) { return text.empty() ? "-" : Shown(text, kMostValue); }

std::string ResultText(const ReplayResult& result) {
  const auto word = [](const std::optional<bool>& exact) {
    return !exact ? "not compared" : *exact ? "yes" : "NO";
  };
  std::string text = std::string("bit exact: ") + word(result.bit_exact) +
                     "; safety machine exact: " + word(result.safety_exact) + "; " +
                     std::to_string(result.ticks) + " samples";
  if (result.ticks_before_reset > 0) {
    text += ", of which " + std::to_string(result.ticks_before_reset) +
            " before the first reset are not compared";
  }
  return text;
}

std::string ReplayText(const TripReading& reading) {
  if (reading.ticks > kMostReplayed) {
    return "not done here, since the run is long: flexarm replay FILE";
  }
  if (reading.ticks == 0) return "no samples";
  try {
    RunReader reader(reading.log);
    const Design gains = GainsOf(reader, reading.config);
    const std::string text = ResultText(ReplayLog(&reader, reading.config, gains, false));
    return reading.head.info.build_id == BuildId() ? text : text + "; recorded by another build";
  } catch (const std::exception& error) {
    return "not possible: " + Shown(error.what(), kMostValue);
  }
}

std::string LabelText(const RunLabel& label) {
  std::string text = Shown(label.name);
  if (!label.note.empty()) text += (text.empty() ? "" : "; ") + Shown(label.note, kMostValue);
  for (const std::string& tag : label.tags) text += (text.empty() ? "" : "; ") + Shown(tag);
  return text.empty() ? "-" : text;
}

}  // namespace

void ConfigSection(const TripReading& reading, HtmlPage* page) {
  page->Section("Config changes since the last good run");
  const RunInfo& info = reading.head.info;
  try {
    const std::optional<GoodRun> good = GoodRunBefore(reading.log, info);
    if (!good) {
      return page->Paragraph(
          "The folder of the log has no earlier run of this rig that ended as "
          "its experiment ends.");
    }
    const auto changes = ConfigChanges(good->head.info.config_text, info.config_text);
    const std::string which = Shown(good->file.filename().string(), kMostValue) + " of " +
                              Shown(good->head.info.start_utc);
    if (changes.empty()) return page->Paragraph("None: the config is that of " + which + ".");
    page->Paragraph("Compared with " + which + ", experiment " +
                    OrDash(good->head.info.experiment_name) + ": " +
                    std::to_string(changes.size()) + " keys differ.");
    std::vector<std::vector<std::string>> rows;
    for (const ConfigChange& change : changes) {
      if (rows.size() == kMostChanges) break;
      rows.push_back({Shown(change.key, kMostValue), OrDash(change.before), OrDash(change.after)});
    }
    page->Table({"key", "then", "now"}, rows);
  } catch (const std::exception& error) {
    page->Paragraph("Not known: " + Shown(error.what(), kMostValue));
  }
}

void AboutTheLog(const TripReading& reading, HtmlPage* page) {
  page->Section("The log and the program");
  const RunInfo& info = reading.head.info;
  const std::string file = reading.log.filename().string();
  page->Table({"what", "value"},
              {{"log", Shown(file, kMostValue)},
               {"begun", OrDash(info.start_utc)},
               {"rig, backend", OrDash(info.rig_name) + ", " + OrDash(info.backend)},
               {"experiment", OrDash(info.experiment_name)},
               {"name, note, tags", LabelText(info.label)},
               {"law", OrDash(info.law)},
               {"config hash", ConfigHash(info.config_text)},
               {"version", OrDash(info.version)},
               {"build", OrDash(info.build_id)},
               {"end of the run", ToString(reading.head.end)},
               {"as it was written", reading.digest_holds ? "yes" : "not known, or damaged"},
               {"replay", ReplayText(reading)}});
  page->Paragraph(
      "More of it: `flexarm info`, `flexarm plot --html`, `flexarm replay`, `flexarm "
      "check` and `flexarm export` read this log.");
}

}  // namespace flexarm
