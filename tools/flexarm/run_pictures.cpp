#include "tools/flexarm/run_pictures.h"

#include "controller/files/input_error.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/plot_script.h"
#include "tools/plot/run_page.h"

namespace flexarm {
namespace {

std::vector<LoadedRun> LoadRuns(const std::vector<std::filesystem::path>& files) {
  std::vector<LoadedRun> runs;
  for (const auto& file : files) {
    runs.push_back(LoadRun(file));
    if (runs.back().contents.tick.empty()) {
      throw InputError(file.string() + ": has no ticks; expected a run with at least one");
    }
  }
  return runs;
}

OutputRules PageRules(const RunPictures& pictures, const std::vector<std::filesystem::path>& runs) {
  return pictures.picture.Rules("a page of runs", kRunPageMark, runs);
}

}  // namespace

void RunPictures::Check(const std::vector<std::filesystem::path>& runs) const {
  if (!picture.given() && page.empty()) {
    throw InputError(
        "plot: nothing to write; expected -o FILE.png, -o FILE.svg or --html FILE.html");
  }
  if (picture.given()) CheckPicture(picture.file, PictureRules(runs, picture.overwrite));
  if (!page.empty()) CheckOutput(page, PageRules(*this, runs));
}

void RunPictures::Draw(const std::vector<std::filesystem::path>& files) const {
  Check(files);
  const std::vector<LoadedRun> runs = LoadRuns(files);
  if (picture.given()) {
    std::vector<PlotRun> plots;
    for (const LoadedRun& run : runs) plots.push_back(PlotDataOf(run));
    DrawPicture(PlotScript(plots, picture.file), picture.file,
                PictureRules(files, picture.overwrite));
    ReportWritten(picture.file);
  }
  if (!page.empty()) {
    WriteFile(page, RunPage(runs), PageRules(*this, files));
    ReportWritten(page);
  }
}

}  // namespace flexarm
