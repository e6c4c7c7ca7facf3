#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "config/config.h"
#include "tools/analysis/statement.h"
#include "tools/html/html_page.h"

namespace flexarm {

/// Data shared by the chapters of a report.
struct ReportContext {
  RigConfig config;
  Experiment experiment;  ///< of the overview's run
  std::filesystem::path experiments;
  std::filesystem::path published;  ///< file of the published cases
  std::filesystem::path folder;
  std::vector<std::string> laws{};      ///< of the benchmark; empty: all
  int runs = 5;                         ///< of random moves for each law and scenario
  std::vector<Statement> statements{};  ///< of the chapters written so far
  std::vector<std::string> results{};   ///< what they found, a sentence each: for the overview

  std::filesystem::path Figure(const std::string& name) const {
    return folder / "figures" / (name + ".png");
  }
};

/// Adds a table: statement of the thesis, result of the model, verdict; and keeps the statements.
void Say(const std::vector<Statement>& statements, ReportContext* context, HtmlPage* page);

// One function per chapter: computes the chapter, draws into `folder` and adds to the page.
void Chapter3(ReportContext* context, HtmlPage* page);  ///< beams, damping, friction
void Chapter4(ReportContext* context, HtmlPage* page);  ///< the rig, figures 4.4 and 4.5
void Chapter5(ReportContext* context, HtmlPage* page);  ///< parameters, figures 5.1 to 5.5
void Chapter6(ReportContext* context, HtmlPage* page);  ///< order reduction, figures 6.1 to 6.9
void Chapter7(ReportContext* context, HtmlPage* page);  ///< control, figures 7.1 to 7.34
/// Zeros, poles at the origin, model following, cost, torsion.
void ControlFeatures(ReportContext* context, HtmlPage* page);
void AppendixB(ReportContext* context, HtmlPage* page);  ///< gauges, figure B.2
void Baselines(ReportContext* context, HtmlPage* page);  ///< the benchmark of the laws
/// The laws that estimate the payload, compared with the others and with the design study, and
/// their limits.
void PayloadChapter(ReportContext* context, HtmlPage* page);
void PublishedChapter(ReportContext* context, HtmlPage* page);  ///< arms of other authors

}  // namespace flexarm
