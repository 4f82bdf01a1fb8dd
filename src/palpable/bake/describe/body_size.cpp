#include "palpable/bake/describe/body_size.h"

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/size_text.h"

#include <fmt/format.h>

namespace palpable {
namespace {

constexpr const char* kInDescription = "unit = \"{}\" in [shape]";

struct Unit {
  const char* name;
  const char* words;
  double metres;
};

// The unit with which the body would have a usual size. Small units are tried first, since files of
// parts and scans use them.
std::optional<Unit> likely_unit(double largest, double unit) {
  for (const Unit& other : {Unit{"mm", "millimetres", 1e-3}, Unit{"cm", "centimetres", 1e-2},
                            Unit{"in", "inches", 0.0254}, Unit{"m", "metres", 1.0}}) {
    const double would_be = largest / unit * other.metres;
    if (other.metres != unit && would_be >= kSmallBody && would_be <= kLargeBody) return other;
  }
  return std::nullopt;
}

std::string advice(double largest, std::optional<double> unit, const std::string& write) {
  if (!unit) return "look at the height that it was scaled to";
  const std::optional<Unit> likely = likely_unit(largest, *unit);
  if (!likely)
    return "no unit of its lengths (m, cm, mm, in) makes it a usual size; give its height";
  return fmt::format("if lengths in its file are {}, write {}", likely->words,
                     fmt::format(fmt::runtime(write), likely->name));
}

std::optional<double> unit_of(const BodyDescription::Shape& shape) {
  return shape.height ? std::nullopt : std::optional(shape.unit);
}

}  // namespace

std::optional<std::string> size_warning(const Eigen::Vector3d& size, std::optional<double> unit,
                                        const std::string& write) {
  const double largest = size.maxCoeff();
  if (largest >= kSmallBody && largest <= kLargeBody) return std::nullopt;
  return fmt::format("the body is {}, {} than {}: {}", size_text(size),
                     largest > kLargeBody ? "larger" : "smaller",
                     largest > kLargeBody ? "3 m" : "3 mm", advice(largest, unit, write));
}

void require_possible_size(const Eigen::Vector3d& size, std::optional<double> unit,
                           const std::string& write, const std::string& place) {
  const double largest = size.maxCoeff();
  if (largest >= kSmallestBody && largest <= kLargestBody) return;
  throw Error(fmt::format("{}: the body is {}; bodies are from 0.1 mm to 100 m: {}", place,
                          size_text(size), advice(largest, unit, write)));
}

std::optional<std::string> size_warning(const BodyDescription::Shape& shape,
                                        const Eigen::Vector3d& size) {
  std::optional<std::string> warning = size_warning(size, unit_of(shape), kInDescription);
  if (warning) warning = fmt::format("{}: {}", shape.place, *warning);
  return warning;
}

void require_possible_size(const BodyDescription::Shape& shape, const Eigen::Vector3d& size) {
  require_possible_size(size, unit_of(shape), kInDescription, shape.place);
}

}  // namespace palpable
