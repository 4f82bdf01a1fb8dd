#include "palpable/desk/clip_files/film_friction.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/whole_file.h"

#include <fmt/core.h>

#include <string>
#include <system_error>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr double kMostFriction = 10.0;
constexpr std::uintmax_t kLongestFriction = 100;  // bytes

fs::path friction_file(const fs::path& clip) { return clip / "truth" / "friction.txt"; }

}  // namespace

std::optional<double> read_film_friction(const fs::path& clip) {
  const fs::path file = friction_file(clip);
  std::error_code error;
  if (!fs::exists(file, error)) return std::nullopt;
  const Result<std::string> text = read_text_file(file, {.most = kLongestFriction});
  if (!text) throw Error(fmt::format("{}: {}", file.string(), text.problem().message));
  std::string number = text.value();
  while (!number.empty() && (number.back() == '\n' || number.back() == ' ')) number.pop_back();
  const std::optional<double> coefficient = to_number(number);
  if (!coefficient || !(*coefficient >= 0.0 && *coefficient <= kMostFriction)) {
    throw Error(fmt::format("{}: '{}' is no coefficient of friction, a number from 0 to {:g}",
                            file.string(), number, kMostFriction));
  }
  return coefficient;
}

void write_film_friction(const fs::path& clip, double coefficient) {
  write_whole_file(friction_file(clip), fmt::format("{}\n", coefficient));
}

}  // namespace palpable
