#include "tools/report/report.h"

#include <array>
#include <ctime>
#include <iterator>

#include "config/thesis_arm.h"
#include "controller/files/write_file.h"
#include "controller/runlog/build_info.h"
#include "controller/runlog/errors.h"
#include "tools/report/chapters.h"
#include "tools/report/overview.h"
#include "tools/support/parallel_for.h"
#include "tools/sweep/sweep_grid.h"

namespace flexarm {
namespace {

void CheckFolder(const std::filesystem::path& folder) {
  if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder)) {
    throw InputError(folder.string() + ": is a file; expected a new or an empty folder");
  }
  if (std::filesystem::exists(folder) && !std::filesystem::is_empty(folder)) {
    throw InputError(folder.string() +
                     ": is not empty; a report is written into a new or an empty folder");
  }
}

// "on 2026-01-31".
std::string Today() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "on %Y-%m-%d", &utc);
  return text.data();
}

using Chapter = void (*)(ReportContext*, HtmlPage*);

std::vector<Chapter> ThesisChapters() {
  return {Chapter3, Chapter4,  Chapter5,  Chapter6,       ControlFeatures,
          Chapter7, AppendixB, Baselines, PayloadChapter, PublishedChapter};
}

// Those that are about the rig itself.
std::vector<Chapter> AnyChapters() { return {Baselines, PayloadChapter}; }

std::vector<std::string> Words(const std::string& commas) {
  return commas.empty() ? std::vector<std::string>{} : ParseValues(commas);
}

}  // namespace

std::filesystem::path WriteReport(const ReportRequest& request) {
  CheckFolder(request.folder);
  for (const char* part : {"figures", "tables", "runs"}) {
    MakeFolder(request.folder / part);
  }
  ReportContext context{.config = request.config,
                        .experiment = request.experiment,
                        .experiments = request.experiments,
                        .published = request.published,
                        .folder = request.folder,
                        .laws = Words(request.laws),
                        .runs = request.runs};
  const bool is_thesis = IsThesisArm(request.config.arm);
  HtmlPage page((is_thesis ? "The flexible arm of the thesis, recomputed: "
                           : "The flexible arm and its control laws, simulated: ") +
                request.config.rig_name);
  const std::vector<Chapter> chapters = is_thesis ? ThesisChapters() : AnyChapters();
  std::size_t done = 0;
  const auto progress = ProgressBar("chapters", chapters.size());
  for (auto* chapter : chapters) {
    chapter(&context, &page);
    ++done;
    if (progress) progress(done);
  }
  HtmlPage overview({});
  Overview(&context, &overview);
  page.PutFirst(overview);
  page.Lead("Computed " + Today() + " by flexarm " + ThisBuild().version + " (" + BuildId() +
            "). " +
            (is_thesis ? "Every number on this page, but those that a source prints, is computed "
                         "by this program; every verdict follows from numbers by a rule. "
                       : "Every number on this page is computed by this program. ") +
            "The arm is simulated. Click on a figure to see it in full size.");
  std::filesystem::path file = request.folder / "report.html";
  WriteFile(file, page.Text(), ReplaceAny("a report"));
  return file;
}

}  // namespace flexarm
