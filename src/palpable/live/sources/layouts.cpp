#include "palpable/live/sources/layouts.h"

#include "palpable/common/base/order_statistics.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/live/sources/name_pattern.h"
#include "palpable/live/sources/natural_order.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <system_error>
#include <utility>

namespace palpable::layouts {
namespace {

namespace fs = std::filesystem;

// The last number in a name before its extension; empty without a number.
std::optional<long long> number_in(const fs::path& image) {
  const std::string name = image.stem().string();
  const auto last = name.find_last_of("0123456789");
  if (last == std::string::npos) return std::nullopt;
  const auto before = name.find_last_not_of("0123456789", last);
  const std::size_t from = before == std::string::npos ? 0 : before + 1;
  return to_whole_number(std::string_view(name).substr(from, last + 1 - from));
}

// The first image whose number does not occur on the other side, if most numbers occur on
// both sides, so that they number the frames. Empty otherwise: then each side has its own
// stamps or counters.
std::optional<fs::path> without_partner(const std::vector<fs::path>& first,
                                        const std::vector<fs::path>& second) {
  std::map<long long, int> sides;  // bit 0: in the first, bit 1: in the second
  std::map<long long, const fs::path*> images;
  for (const auto* list : {&first, &second}) {
    for (const fs::path& image : *list) {
      const std::optional<long long> number = number_in(image);
      if (!number) return std::nullopt;
      sides[*number] |= list == &first ? 1 : 2;
      images[*number] = &image;
    }
  }
  const auto alone = [](const auto& side) { return side.second != 3; };
  const auto both =
      static_cast<std::size_t>(std::count_if(sides.begin(), sides.end(), std::not_fn(alone)));
  const auto odd = std::find_if(sides.begin(), sides.end(), alone);
  if (odd == sides.end() || 2 * both <= first.size()) return std::nullopt;
  return *images.at(odd->first);
}

}  // namespace

std::vector<fs::path> images_in(const fs::path& folder, std::string_view pattern) {
  std::vector<fs::path> images;
  const bool of_exr = pattern.ends_with(".exr");
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    const std::string name = it->path().filename().string();
    if (name.front() != '.' && matches_pattern(name, pattern) &&
        (of_exr || is_image_name(it->path())) && it->is_regular_file(ignored)) {
      images.push_back(it->path());
    }
  }
  std::sort(images.begin(), images.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return images;
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

std::vector<std::string> lines_in(const fs::path& path) {
  Result<std::vector<std::string>> lines = read_lines(path);
  return lines ? std::move(lines).value() : std::vector<std::string>{};
}

Result<Recording> pair_up(const fs::path& folder, std::string layout, ImagePair pair,
                          const Side& first, const Side& second) {
  if (first.images.size() != second.images.size()) {
    return Problem{fmt::format(
        "{} has {} {} and {} {} images; each needs its partner, so add or "
        "remove what is left over",
        folder.string(), first.images.size(), first.name, second.images.size(), second.name)};
  }
  if (const std::optional<fs::path> odd = without_partner(first.images, second.images)) {
    return Problem{
        fmt::format("{} has no partner of its number among the {} and {} images of {}; "
                    "add what is missing or remove what is left over",
                    odd->filename().string(), first.name, second.name, folder.string())};
  }
  Recording recording;
  recording.layout = std::move(layout);
  recording.pair = pair;
  for (std::size_t i = 0; i < first.images.size(); ++i) {
    recording.frames.push_back({first.images[i], second.images[i], std::nullopt, std::nullopt});
  }
  return recording;
}

std::map<long long, fs::path> numbered_files(const fs::path& folder, std::string_view ending) {
  std::map<long long, fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    std::error_code ignored;
    if (!name.ends_with(ending) || !it->is_regular_file(ignored)) continue;
    const auto number =
        to_whole_number(std::string_view(name).substr(0, name.size() - ending.size()));
    if (number && *number >= 0) files.emplace(*number, it->path());
  }
  return files;
}

FrameLens median_lens(const std::vector<FrameLens>& lenses, std::string_view file,
                      std::vector<std::string>& notes) {
  const auto median = [&](double FrameLens::*number) {
    std::vector<double> values;
    values.reserve(lenses.size());
    for (const FrameLens& lens : lenses) values.push_back(lens.*number);
    return upper_median(values);
  };
  const FrameLens middle{median(&FrameLens::fx), median(&FrameLens::fy), median(&FrameLens::cx),
                         median(&FrameLens::cy)};
  const auto [least, most] =
      std::minmax_element(lenses.begin(), lenses.end(),
                          [](const FrameLens& a, const FrameLens& b) { return a.fx < b.fx; });
  constexpr double kSteady = 0.002;  // of f: 1 mm at 0.5 m
  if (most->fx - least->fx > kSteady * middle.fx) {
    notes.push_back(
        fmt::format("{}: the lens focuses while it films, f from {:.1f} to {:.1f} px; "
                    "{:.1f} px, the middle of all frames, is taken",
                    file, least->fx, most->fx, middle.fx));
  }
  return middle;
}

SourceCalibration lens_calibration(const FrameLens& lens, std::string file) {
  SourceCalibration calibration;
  calibration.file = std::move(file);
  calibration.format.kind = FrameFormat::Kind::kColorDepth;
  calibration.format.depth_camera = {0, 0, lens.fx, lens.fy, lens.cx, lens.cy};
  return calibration;
}

Rigid3 pose_of(const Eigen::Vector3d& position, double qw, double qx, double qy, double qz) {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = Eigen::Quaterniond(qw, qx, qy, qz).normalized().toRotationMatrix();
  pose.translation() = position;
  return pose;
}

std::optional<Rigid3> pose_of(const std::vector<double>& n) {
  if (n.size() != 12 && n.size() != 16) return std::nullopt;
  Rigid3 pose = Rigid3::Identity();
  pose.matrix().topRows<3>() =
      Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(n.data());
  return pose;
}

}  // namespace palpable::layouts
