#pragma once

namespace flexarm {

/// The sheet of a picture of several plots. Plots are placed in pixels from its top left corner;
/// gnuplot wants shares of the sheet from its bottom left one.
struct Sheet {
  int width = 1400, height = 1300;

  double X(double from_left_px) const { return from_left_px / width; }
  double Y(double from_top_px) const { return 1.0 - from_top_px / height; }
};

}  // namespace flexarm
