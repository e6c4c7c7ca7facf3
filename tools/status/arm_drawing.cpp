#include "tools/status/arm_drawing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace flexarm {
namespace {

// Of a cell in UTF-8: the bits of a Braille sign, U+2800 and above, by row and column of the dot.
constexpr std::array<std::array<std::uint8_t, 2>, 4> kDotBit = {
    {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}}};

// How far behind the base the arm can reach, as a share of its length: both joints at 90 degrees.
constexpr double kBehind = 0.55;

struct Point {
  double x_m, y_m;  // to the right, and upwards
};

/// Dots in the cells of a screen, and signs that stand in for them.
class Canvas {
 public:
  Canvas(int columns, int rows, bool utf8)
      : columns_(columns),
        rows_(rows),
        utf8_(utf8),
        cells_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

  /// The dot nearest to a place, in cells from the upper left corner.
  void Dot(double column, double row) {
    Cell* cell = At(column, row);
    if (cell == nullptr) return;
    const auto part = [](double place, int parts) {
      return static_cast<std::size_t>((place - std::floor(place)) * parts);
    };
    cell->dots |= kDotBit[part(row, 4)][part(column, 2)];
  }
  void Put(double column, double row, char sign) {
    if (Cell* cell = At(column, row)) cell->sign = sign;
  }

  Rows Take() const {
    Rows rows;
    for (int row = 0; row < rows_; ++row) {
      std::string text;
      for (int column = 0; column < columns_; ++column) {
        text += SignOf(cells_[Index(column, row)]);
      }
      rows.emplace_back(text);
    }
    return rows;
  }

 private:
  struct Cell {
    std::uint8_t dots = 0;
    char sign = 0;
  };

  std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  Cell* At(double column, double row) {
    const bool within = column >= 0.0 && row >= 0.0 && column < columns_ && row < rows_;
    if (!within) return nullptr;  // also what is no number
    return &cells_[Index(static_cast<int>(column), static_cast<int>(row))];
  }
  std::string SignOf(const Cell& cell) const {
    if (cell.sign != 0) return {cell.sign};
    if (cell.dots == 0) return " ";
    if (!utf8_) return ".";
    // U+2800 + dots in UTF-8.
    return {static_cast<char>(0xE2), static_cast<char>(0xA0 | (cell.dots >> 6)),
            static_cast<char>(0x80 | (cell.dots & 0x3F))};
  }

  int columns_, rows_;
  bool utf8_;
  std::vector<Cell> cells_;
};

/// A screen cell is about twice as high as wide.
struct View {
  double cells_per_m;  // rows
  double base_column, base_row;

  std::pair<double, double> Cell(const Point& at) const {
    return {base_column + 2.0 * cells_per_m * at.x_m, base_row - cells_per_m * at.y_m};
  }
};

Point Ahead(const Point& from, double angle_rad, double along_m, double across_m) {
  const double s = std::sin(angle_rad), c = std::cos(angle_rad);
  return {.x_m = from.x_m - s * along_m - c * across_m,
          .y_m = from.y_m + c * along_m - s * across_m};
}

// Deflection of a cantilever with a force at its end, relative to that of the end.
double Shape(double share) { return share * share * (3.0 - share) / 2.0; }

// Draws a link and returns its end.
Point DrawLink(const Point& root, double angle_rad, double length_m, double bending_m,
               const View& view, Canvas* canvas) {
  constexpr int kSteps = 400;  // more than a screen has dots
  Point end = root;
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    end = Ahead(root, angle_rad, share * length_m, kBendingScale * bending_m * Shape(share));
    const auto [column, row] = view.Cell(end);
    canvas->Dot(column, row);
  }
  return end;
}

}  // namespace

Rows ArmDrawing(const ArmPose& pose, int columns, int rows, bool utf8) {
  if (columns < 1 || rows < 1) return {};
  Canvas canvas(columns, rows, utf8);
  const double reach_m = pose.length_m[0] + pose.length_m[1];
  if (!(pose.length_m[0] > 0.0 && pose.length_m[1] > 0.0) || !std::isfinite(reach_m)) {
    return canvas.Take();
  }
  const double across = static_cast<double>(columns) / (4.0 * reach_m);
  const double along = static_cast<double>(rows) / ((1.0 + kBehind) * reach_m);
  const double scale = 0.95 * std::min(across, along);
  const View view{.cells_per_m = scale,
                  .base_column = columns / 2.0,
                  .base_row = (rows + (1.0 - kBehind) * reach_m * scale) / 2.0};
  const Point base{.x_m = 0.0, .y_m = 0.0};
  const Point elbow =
      DrawLink(base, pose.angle_rad[0], pose.length_m[0], pose.bending_m[0], view, &canvas);
  // A cantilever's end turns by 3/2 of its deflection over its length.
  const double turned_rad = 1.5 * pose.bending_m[0] / pose.length_m[0];
  const Point tip = DrawLink(elbow, pose.angle_rad[0] + turned_rad + pose.angle_rad[1],
                             pose.length_m[1], pose.bending_m[1], view, &canvas);
  const auto mark = [&](const Point& at, char sign) {
    const auto [column, row] = view.Cell(at);
    canvas.Put(column, row, sign);
  };
  mark(tip, 'x');
  mark(elbow, 'o');
  mark(base, 'O');
  return canvas.Take();
}

}  // namespace flexarm
