#include "palpable/desk/clip_files/frame_names.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"

#include <fmt/core.h>

#include <algorithm>
#include <system_error>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr double kLargestFrameNumber = 10'000'000;  // a name with a larger number is not a frame

bool is_of_digits(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

std::string frame_name(int frame, std::string_view ending) {
  return fmt::format("{:06d}{}", frame, ending);
}

int frames_in(const fs::path& folder) {
  int frames = 0;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string stem = entry.path().stem().string();
    if (!is_of_digits(stem)) continue;
    const double number = to_number(stem).value_or(kLargestFrameNumber);
    if (number < kLargestFrameNumber) frames = std::max(frames, static_cast<int>(number) + 1);
  }
  return frames;
}

void expect_frames_in(const fs::path& folder, std::string_view ending) {
  if (!fs::is_directory(folder)) throw Error(fmt::format("{}: is no folder", folder.string()));
  std::string other;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path name = entry.path().filename();
    const std::string stem = name.stem().string();
    if (name.extension() == ending && stem.size() == 6 && is_of_digits(stem)) return;
    if (stem.front() != '.' && (other.empty() || name.string() < other)) other = name.string();
  }
  if (!other.empty()) {
    throw Error(fmt::format("{}: {} is no frame's name: they are 000000{}, 000001{} and so on",
                            folder.string(), other, ending, ending));
  }
}

}  // namespace palpable
