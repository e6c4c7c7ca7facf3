#include "tools/report/report.h"

#include <iterator>

#include "controller/files/write_file.h"
#include "controller/runlog/build_info.h"
#include "controller/runlog/errors.h"
#include "tools/report/chapters.h"
#include "tools/support/parallel_for.h"

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

}  // namespace

std::filesystem::path WriteReport(const ReportRequest& request) {
  CheckFolder(request.folder);
  for (const char* part : {"figures", "tables", "runs"}) {
    MakeFolder(request.folder / part);
  }
  ReportContext context{.config = request.config,
                        .experiments = request.experiments,
                        .published = request.published,
                        .folder = request.folder,
                        .statements = {}};
  HtmlPage page("The flexible arm of the thesis, recomputed: " + request.config.rig_name);
  const auto chapters = {Chapter3, Chapter4,  Chapter5,  Chapter6,       ControlFeatures,
                         Chapter7, AppendixB, Baselines, PayloadChapter, PublishedChapter};
  std::size_t done = 0;
  const auto progress = ProgressBar("chapters", chapters.size());
  for (auto* chapter : chapters) {
    chapter(&context, &page);
    ++done;
    if (progress) progress(done);
  }
  page.Lead(Count(std::ssize(context.statements)) + " statements of the thesis (" +
            Counted(context.statements) +
            "). Every number on this page, but those that a source prints, is computed by the "
            "program that "
            "wrote it (flexarm " +
            ThisBuild().version + ", " + BuildId() +
            "); every verdict follows from numbers by a rule. The arm is simulated.");
  std::filesystem::path file = request.folder / "report.html";
  WriteFile(file, page.Text(), ReplaceAny("a report"));
  return file;
}

}  // namespace flexarm
