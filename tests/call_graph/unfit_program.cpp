// Functions that a real-time thread must not run, one reason each, and one that it may: what
// check_realtime_test.py expects the check to find in this program.
#include <alloca.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <vector>

namespace unfit {

class Shape {
 public:
  virtual ~Shape() = default;
  virtual double Area(double scale) const noexcept = 0;
};

class Square : public Shape {
 public:
  double Area(double scale) const noexcept override { return scale * scale; }
};

class Polygon : public Shape {
 public:
  double Area(double scale) const noexcept override {
    const std::vector<double> sides(static_cast<std::size_t>(scale), scale);
    return sides.empty() ? 0.0 : sides.back() * sides.front();
  }
};

volatile double sink = 0.0;

[[gnu::noinline]] double Adds(double x) noexcept { return x + sink; }

[[gnu::noinline]] double Throws(double x) {
  if (x < sink) throw std::invalid_argument("x");
  return x;
}

[[gnu::noinline]] double Allocates(double x) {
  const std::vector<double> values(static_cast<std::size_t>(x), x);
  return values.empty() ? 0.0 : values.back();
}

[[gnu::noinline]] double CallsMathLibrary(double x) noexcept { return std::pow(x, sink); }

[[gnu::noinline]] double TakesAnyStack(double x) noexcept {
  auto* const values = static_cast<volatile double*>(alloca(static_cast<std::size_t>(x) * 8));
  values[0] = x;
  return values[static_cast<std::size_t>(sink)];
}

[[gnu::noinline]] double TakesMuchStack(double x) noexcept {
  std::array<volatile double, 5'000> values;
  for (volatile double& value : values) value = x;
  return values[static_cast<std::size_t>(sink)];
}

[[gnu::noinline]] double Recurses(double x) noexcept {
  return x < 1.0 ? sink : Recurses(x - sink) * Recurses(x - 2.0);
}

[[gnu::noinline]] double CallsPointer(double (*volatile* function)(double)) {
  return (*function)(sink) + 1.0;
}

[[gnu::noinline]] double CallsInterface(const Shape& shape) noexcept {
  return shape.Area(sink) + 1.0;
}

// The fault is two calls away.
[[gnu::noinline]] double CallsOneThatThrows(double x) { return Throws(x) + sink; }

}  // namespace unfit

int main() {
  double (*volatile pointer)(double) = unfit::Adds;
  const std::unique_ptr<const unfit::Shape> shape =
      unfit::sink > 0.0 ? std::unique_ptr<const unfit::Shape>(new unfit::Square)
                        : std::unique_ptr<const unfit::Shape>(new unfit::Polygon);
  const double sum = unfit::Adds(1.0) + unfit::CallsOneThatThrows(1.0) + unfit::Allocates(1.0) +
                     unfit::CallsMathLibrary(1.0) + unfit::TakesAnyStack(1.0) +
                     unfit::TakesMuchStack(1.0) + unfit::Recurses(0.5) +
                     unfit::CallsPointer(&pointer) + unfit::CallsInterface(*shape);
  std::printf("%g\n", sum);
}
