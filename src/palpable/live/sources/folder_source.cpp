#include "palpable/live/sources/folder_source.h"

#include "palpable/live/sources/image_file.h"
#include "palpable/live/sources/read_ahead.h"
#include "palpable/live/sources/side_by_side.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

struct ImageSize {
  int width;
  int height;
  fs::path path;
};

// The size of the first readable image.
std::optional<ImageSize> first_readable_size(const Recording& recording) {
  ImageFileReader reader;
  ColorImage image;
  for (const RecordedFrame& frame : recording.frames) {
    if (reader.read_color(frame.first, image).ok()) {
      return ImageSize{image.width(), image.height(), frame.first};
    }
  }
  return std::nullopt;
}

// The calibration file of the settings, or the layout's calibration, or the folder's file.
Result<SourceCalibration> calibration_of_folder(const fs::path& folder, const Recording& recording,
                                                const FolderSettings& settings,
                                                const std::optional<ImageSize>& image) {
  int width = image ? image->width : 0;
  const int height = image ? image->height : 0;
  const bool side_by_side = recording.pair == ImagePair::kSideBySide;
  if (side_by_side) width /= 2;
  const bool wants_depth = recording.pair == ImagePair::kColorDepth;
  const auto read = [&](const fs::path& path) -> Result<SourceCalibration> {
    Result<SourceCalibration> calibration = read_source_calibration(path, width, height);
    if (!calibration.ok()) return calibration;
    FrameFormat& format = calibration.value().format;
    const bool of_depth = format.kind == FrameFormat::Kind::kColorDepth;
    if (of_depth && !format.color_sensor) {
      format.color_sensor = color_sensor_of(recording, format.depth_camera);
    }
    if (of_depth == wants_depth) return calibration;
    return Problem{fmt::format("{} holds {} but {} has {}", path.string(),
                               of_depth ? "one camera's intrinsics" : "a stereo rig",
                               folder.string(), wants_depth ? "colour and depth" : "stereo pairs")};
  };
  if (!settings.calibration.empty()) return read(settings.calibration);
  if (settings.without_calibration && !wants_depth) {
    SourceCalibration none;
    none.format.width = width;
    none.format.height = height;
    return none;
  }
  if (recording.calibration) return *recording.calibration;
  const std::vector<fs::path>& files = recording.calibration_files;
  if (files.size() == 1) return read(files.front());
  if (files.empty() && !recording.calibration_trouble.empty()) {
    return Problem{recording.calibration_trouble};
  }
  if (wants_depth) {
    if (!files.empty()) return read(files.front());
    return Problem{fmt::format("{} has no intrinsics.txt: write one line `fx fy cx cy` in pixels",
                               folder.string())};
  }
  if (files.size() > 1) {
    return Problem{fmt::format("{} has both {} and {}: keep one, or name it with --calibration",
                               folder.string(), files[0].filename().string(),
                               files[1].filename().string())};
  }
  return Problem{fmt::format(
      "{} has no calibration: put calibration.yml (raw images; palpable calibrate makes one) or "
      "rectified.yml (rectified ones; lines of `fx: 500`, fy, cx, cy, width, height, baseline_m, "
      "doffs_px below `%YAML:1.0` and `---`) {}, or name one with --calibration",
      folder.string(), is_image_name(folder) ? "beside it" : "into it")};
}

// The message for images of one eye that do not form pairs, in a folder or named singly.
Problem not_recognised(const fs::path& name, const ImageSize& found) {
  if (is_image_name(name) || is_pattern(name)) {
    return Problem{fmt::format(
        "{} is {} x {} px, which is no pair side by side: name the other eye's with --right, or "
        "depth with --depth-source",
        found.path.string(), found.width, found.height)};
  }
  return Problem{fmt::format(
      "the layout of {} was not recognised: {} is {} x {} px, which is no pair side by side. {}",
      name.string(), found.path.filename().string(), found.width, found.height, known_layouts())};
}

// Compares the images' size with the calibration's; sets the format's size if the
// calibration has none.
std::optional<Problem> fit_size(const fs::path& folder, const Recording& recording,
                                const ImageSize& found, FrameFormat& format) {
  const bool side_by_side = recording.pair == ImagePair::kSideBySide;
  const int eye_width = side_by_side ? found.width / 2 : found.width;
  if (format.width == 0 && !side_by_side) {  // KITTI, and intrinsics without a size
    set_size(format, found.width, found.height);
    if (format.already_rectified) {
      format.rectified.camera.width = found.width;
      format.rectified.camera.height = found.height;
    }
    return std::nullopt;
  }
  if (format.width == eye_width && format.height == found.height &&
      (!side_by_side || found.width % 2 == 0)) {
    return std::nullopt;
  }
  return Problem{fmt::format(
      "{}: the calibration is for images of {} x {} px{} but {} is {} x {}; calibrate at this size "
      "or bring the images to the calibration's",
      folder.string(), format.width, format.height,
      side_by_side ? fmt::format(", side by side {} x {},", 2 * format.width, format.height)
                   : std::string(),
      found.path.filename().string(), found.width, found.height)};
}

// Reads single frames of a recording, without a thread.
class ImageReader final : public FrameReader {
 public:
  ImageReader(Recording recording, const SourceCalibration& calibration)
      : recording_(std::move(recording)),
        format_(calibration.format),
        frames_per_second_(calibration.frames_per_second),
        depth_unit_(calibration.depth_unit.value_or(recording_.depth_unit)) {
    format_.starts_at = recording_.starts_at;
  }

  const FrameFormat& format() const override { return format_; }
  int count() const override { return static_cast<int>(recording_.frames.size()); }
  std::vector<std::string> notes() const override {
    if (recording_.unmatched == 0) return {};
    return {fmt::format(
        "{} images have no partner of the same moment, or no stamp of their own, and are left out",
        recording_.unmatched)};
  }

  FrameStatus read(int number, Frame& frame, std::string& trouble) override {
    if (number >= count()) return FrameStatus::kEnd;
    const RecordedFrame& recorded = recording_.frames[number];
    frame.number = number;
    frame.time = recorded.time.value_or(number / frames_per_second_);
    trouble = read_images(recorded, frame);
    return trouble.empty() ? FrameStatus::kFrame : FrameStatus::kUnreadable;
  }

 private:
  std::string read_images(const RecordedFrame& recorded, Frame& frame) {
    if (recording_.pair == ImagePair::kSideBySide) return read_side_by_side(recorded.first, frame);
    std::string trouble = read_color(recorded.first, frame.left);
    if (!trouble.empty()) return trouble;
    if (recording_.pair == ImagePair::kLeftRight) return read_color(recorded.second, frame.right);
    return read_depth(recorded.second, frame.depth);
  }

  std::string of_another_size(const fs::path& path, int width, int height) const {
    return fmt::format("image {} is {} x {} px; the others are {} x {}", path.string(), width,
                       height, format_.width, format_.height);
  }

  std::string read_color(const fs::path& path, ColorImage& image) {
    const Result<bool> read = reader_.read_color(path, image);
    if (!read.ok()) return read.problem().message;
    if (image.width() == format_.width && image.height() == format_.height) return {};
    return of_another_size(path, image.width(), image.height());
  }

  std::string read_side_by_side(const fs::path& path, Frame& frame) {
    const Result<bool> read = reader_.read_color(path, image_);
    if (!read.ok()) return read.problem().message;
    if (image_.width() != 2 * format_.width || image_.height() != format_.height) {
      return of_another_size(path, image_.width(), image_.height());
    }
    split_side_by_side(image_, frame.left, frame.right);
    return {};
  }

  std::string read_depth(const fs::path& path, DepthImage& depth) {
    const Result<bool> read = reader_.read_16bit(path, steps_);
    if (!read.ok()) return read.problem().message;
    if (steps_.width() != format_.width || steps_.height() != format_.height) {
      return of_another_size(path, steps_.width(), steps_.height());
    }
    depth.resize(format_.width, format_.height);
    const auto unit = static_cast<float>(depth_unit_);
    std::transform(steps_.begin(), steps_.end(), depth.begin(), [unit](std::uint16_t step) {
      return step == 0 || step == 65535 ? kUnknown : static_cast<float>(step) * unit;
    });
    return {};
  }

  Recording recording_;
  FrameFormat format_;
  double frames_per_second_;
  double depth_unit_;  // m per step
  ImageFileReader reader_;
  ColorImage image_;
  Image<std::uint16_t> steps_;
};

Result<std::unique_ptr<FrameSource>> open_images(const fs::path& name, Result<Recording> recognised,
                                                 const FolderSettings& settings) {
  if (!recognised.ok()) return recognised.problem();
  Recording recording = std::move(recognised).value();
  const std::optional<ImageSize> found = first_readable_size(recording);
  const bool maybe_one_eye = recording.pair == ImagePair::kSideBySide && found &&
                             !looks_side_by_side(found->width, found->height);
  Result<SourceCalibration> calibration = calibration_of_folder(name, recording, settings, found);
  // Images side by side are recognised by a calibration for eyes of half their width, or
  // by their aspect.
  if (maybe_one_eye && (!calibration.ok() || settings.without_calibration ||
                        2 * calibration.value().format.width != found->width)) {
    return not_recognised(name, *found);
  }
  if (!calibration.ok()) return calibration.problem();
  if (!found) {
    return Problem{fmt::format("none of the {} images of {} can be read", recording.frames.size(),
                               name.string())};
  }
  if (auto problem = fit_size(name, recording, *found, calibration.value().format)) {
    return *problem;
  }
  return read_ahead(std::make_unique<ImageReader>(std::move(recording), calibration.value()));
}

}  // namespace

Result<std::unique_ptr<FrameSource>> open_folder(const fs::path& folder,
                                                 const FolderSettings& settings) {
  return open_images(folder, recognise_folder(folder), settings);
}

Result<std::unique_ptr<FrameSource>> open_patterns(const fs::path& first, const fs::path& second,
                                                   bool second_is_depth,
                                                   const FolderSettings& settings) {
  return open_images(first, recognise_patterns(first, second, second_is_depth), settings);
}

}  // namespace palpable
