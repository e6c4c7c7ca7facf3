#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "config/published_cases.h"

namespace flexarm {

/// A published figure and what the program computes for it.
struct PublishedResult {
  PublishedFigure figure;
  double computed = 0.0;  ///< in the unit of the figure's quantity

  bool within_tolerance() const;
  /// The figure agrees, or does not as the file of cases says that it does not.
  bool as_expected() const { return within_tolerance() != figure.differs; }
};

/// A case, and all its figures with what the program computes for them.
struct PublishedComparison {
  PublishedCase of;
  std::vector<PublishedResult> result;
};

/// Reads the cases of a file and the arms that they name, and computes every figure.
/// @throws ConfigError
std::vector<PublishedComparison> ComparePublished(const std::filesystem::path& file);

/// "frequency of mode 2, Hz, link 1" and the like.
std::string LabelOf(const PublishedFigure& figure);

}  // namespace flexarm
