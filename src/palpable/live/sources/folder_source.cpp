#include "palpable/live/sources/folder_source.h"

#include "palpable/live/sources/depth_unit.h"
#include "palpable/live/sources/film_file.h"
#include "palpable/live/sources/image_file.h"
#include "palpable/live/sources/picture_sizes.h"
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

// @pre  first_color_size() found none
std::string why_first_is_unreadable(const Recording& recording) {
  if (recording.is_film) {
    FilmFile film;
    film.path = recording.frames.front().first;
    return fmt::format("{} {}", film.path.string(), film.open(FilmPose::kAsFilmed));
  }
  ImageFileReader reader;
  ColorImage image;
  const Result<bool> read = reader.read_color(recording.frames.front().first, image);
  return read.ok() ? std::string() : read.problem().message;
}

// The calibration file of the settings, or the layout's calibration, or the folder's file.
Result<SourceCalibration> calibration_of_folder(const fs::path& folder, const Recording& recording,
                                                const FolderSettings& settings,
                                                const std::optional<SizedPicture>& image) {
  int width = image ? image->width : 0;
  const int height = image ? image->height : 0;
  const bool side_by_side = recording.pair == ImagePair::kSideBySide;
  if (side_by_side) width /= 2;
  const bool wants_depth = recording.pair == ImagePair::kColorDepth;
  const auto read = [&](const fs::path& path) -> Result<SourceCalibration> {
    Result<SourceCalibration> calibration = read_source_calibration(
        path, width, height,
        wants_depth ? FrameFormat::Kind::kColorDepth : FrameFormat::Kind::kStereo);
    if (!calibration.ok()) return calibration;
    const bool of_depth = calibration.value().format.kind == FrameFormat::Kind::kColorDepth;
    if (of_depth) add_color_sensor(recording, calibration.value());
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
    if (!files.empty()) {
      Result<SourceCalibration> first = read(files.front());
      if (first.ok()) {
        first.value().guesses.push_back(fmt::format("{} has {}, too: {} is taken", folder.string(),
                                                    files.back().filename().string(),
                                                    files.front().filename().string()));
      }
      return first;
    }
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
Problem not_recognised(const fs::path& name, const SizedPicture& found) {
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

// Reads single frames of a recording, without a thread.
class ImageReader final : public FrameReader {
 public:
  // @param calibration  its format's depth_unit is decided
  ImageReader(Recording recording, const SourceCalibration& calibration,
              std::vector<std::string> notes)
      : recording_(std::move(recording)),
        format_(calibration.format),
        frames_per_second_(calibration.frames_per_second),
        notes_(calibration.guesses) {
    notes_.insert(notes_.end(), notes.begin(), notes.end());
    format_.starts_at = recording_.starts_at;
    if (recording_.is_film) open_film();
    const bool has_times = recording_.frames.front().time.has_value();
    if (!has_times && !calibration.rate_is_stated && recording_.frames.size() > 1) {
      notes_.push_back(fmt::format(
          "the pictures have no times: a rate of {} Hz is assumed{}", frames_per_second_,
          recording_.pair == ImagePair::kColorDepth
              ? ""
              : "; a line `fps: ...` of the calibration states another rate"));
    }
    if (recording_.unmatched > 0) {
      notes_.push_back(fmt::format(
          "{} images have no partner of the same moment, or no stamp of their own, and are left "
          "out",
          recording_.unmatched));
    }
  }

  const FrameFormat& format() const override { return format_; }
  int count() const override { return static_cast<int>(recording_.frames.size()); }
  std::vector<std::string> notes() const override { return notes_; }

  FrameStatus read(int number, Frame& frame, std::string& trouble) override {
    if (number >= count() || film_is_damaged_) return FrameStatus::kEnd;
    const RecordedFrame& recorded = recording_.frames[number];
    frame.number = number;
    frame.time = recorded.time.value_or(number / frames_per_second_);
    trouble = read_images(recorded, frame);
    return trouble.empty() ? FrameStatus::kFrame : FrameStatus::kUnreadable;
  }

 private:
  std::string read_images(const RecordedFrame& recorded, Frame& frame) {
    if (recording_.pair == ImagePair::kSideBySide) return read_side_by_side(recorded.first, frame);
    std::string trouble = recording_.is_film ? read_film(recorded.in_film, frame.left)
                                             : read_color(recorded.first, frame.left);
    if (!trouble.empty()) return trouble;
    if (recording_.pair == ImagePair::kLeftRight) return read_color(recorded.second, frame.right);
    trouble = read_depth(recorded.second, frame.depth);
    if (!trouble.empty() || recorded.confidence.empty()) return trouble;
    return leave_out_unsure(recorded.confidence, frame.depth);
  }

  // Leaves out the frames behind the film's end, and those without a time get the film's.
  void open_film() {
    film_.path = recording_.frames.front().first;
    (void)film_.open(FilmPose::kAsFilmed);  // it was opened before, when its size was read
    std::vector<RecordedFrame>& frames = recording_.frames;
    if (film_.frames > 0) {
      const std::size_t before = frames.size();
      const int first = frames.front().in_film;
      std::erase_if(frames, [&](const RecordedFrame& frame) {
        return frame.in_film >= film_.frames && frame.in_film != first;
      });
      recording_.unmatched += static_cast<int>(before - frames.size());
    }
    if (frames.front().time) return;
    const double rate = film_.rate > 0 ? film_.rate : frames_per_second_;
    for (RecordedFrame& frame : frames) {
      frame.time = (frame.in_film - frames.front().in_film) / rate;
    }
  }

  std::string read_film(int picture, ColorImage& image) {
    bool there = true;
    for (; there && film_at_ < picture; ++film_at_) there = film_.skip();
    there = there && film_.next(image);
    ++film_at_;
    film_is_damaged_ = !there;
    if (!there) {
      return fmt::format("{} is damaged: it ends before its picture {}", film_.path.string(),
                         picture);
    }
    if (image.width() == format_.width && image.height() == format_.height) return {};
    return of_another_size(film_.path, image.width(), image.height(), color_size());
  }

  std::string leave_out_unsure(const fs::path& path, DepthImage& depth) {
    const Result<bool> read = reader_.read_8bit(path, confidence_);
    if (!read.ok()) return read.problem().message;
    if (confidence_.width() != depth.width() || confidence_.height() != depth.height()) {
      return of_another_size(path, confidence_.width(), confidence_.height(),
                             depth_size_of(format_));
    }
    std::transform(
        depth.begin(), depth.end(), confidence_.begin(), depth.begin(),
        [](float Z, std::uint8_t sure) { return sure < kLeastPhoneConfidence ? kUnknown : Z; });
    return {};
  }

  static std::string of_another_size(const fs::path& path, int width, int height,
                                     const std::pair<int, int>& others) {
    return fmt::format("image {} is {} x {} px; the others are {} x {}", path.string(), width,
                       height, others.first, others.second);
  }

  std::pair<int, int> color_size() const { return {format_.width, format_.height}; }

  std::string read_color(const fs::path& path, ColorImage& image) {
    const Result<bool> read = reader_.read_color(path, image);
    if (!read.ok()) return read.problem().message;
    if (image.width() == format_.width && image.height() == format_.height) return {};
    return of_another_size(path, image.width(), image.height(), color_size());
  }

  std::string read_side_by_side(const fs::path& path, Frame& frame) {
    const Result<bool> read = reader_.read_color(path, image_);
    if (!read.ok()) return read.problem().message;
    if (image_.width() != 2 * format_.width || image_.height() != format_.height) {
      return of_another_size(path, image_.width(), image_.height(), color_size());
    }
    split_side_by_side(image_, frame.left, frame.right);
    return {};
  }

  std::string read_depth(const fs::path& path, DepthImage& depth) {
    const auto size = depth_size_of(format_);
    if (is_exr(path)) {
      const Result<bool> read = reader_.read_metres(path, depth);
      if (!read.ok()) return read.problem().message;
      if (std::pair(depth.width(), depth.height()) == size) return {};
      return of_another_size(path, depth.width(), depth.height(), size);
    }
    const Result<bool> read = reader_.read_16bit(path, steps_);
    if (!read.ok()) return read.problem().message;
    if (std::pair(steps_.width(), steps_.height()) != size) {
      return of_another_size(path, steps_.width(), steps_.height(), size);
    }
    depth.resize(size.first, size.second);
    const auto unit = static_cast<float>(format_.depth_unit);
    std::transform(steps_.begin(), steps_.end(), depth.begin(), [unit](std::uint16_t step) {
      return step == 0 || step == 65535 ? kUnknown : static_cast<float>(step) * unit;
    });
    return {};
  }

  Recording recording_;
  FrameFormat format_;
  double frames_per_second_;
  std::vector<std::string> notes_;
  ImageFileReader reader_;
  ColorImage image_;
  Image<std::uint16_t> steps_;
  MaskImage confidence_;
  FilmFile film_;
  int film_at_ = 0;  // number of its next picture
  bool film_is_damaged_ = false;
};

// Whether a calibration says that a picture of this size is one eye's, although it has the aspect
// of two.
bool is_of_one_eye(const SizedPicture& found, const Recording& recording,
                   const FolderSettings& settings) {
  fs::path file = settings.calibration;
  if (file.empty() && recording.calibration_files.size() == 1) {
    file = recording.calibration_files.front();
  }
  if (file.empty()) return false;
  const auto calibration = read_source_calibration(file, found.width, found.height);
  return calibration.ok() && calibration.value().format.width == found.width;
}

void part_into_two_frames(Recording& recording) {
  const RecordedFrame pair = recording.frames.front();
  recording.layout = "side by side";
  recording.pair = ImagePair::kSideBySide;
  recording.frames = {{pair.first, {}, {}, {}}, {pair.second, {}, {}, {}}};
}

// What is wrong with the calibration that the user named, for both eyes in one picture of this
// size; empty if it can be read or none was named.
std::string fault_of_named(const FolderSettings& settings, const SizedPicture& found) {
  if (settings.calibration.empty()) return {};
  const auto read = read_source_calibration(settings.calibration, found.width / 2, found.height);
  return read.ok() ? std::string() : read.problem().message;
}

Result<std::unique_ptr<FrameSource>> open_images(const fs::path& name, Result<Recording> recognised,
                                                 const FolderSettings& settings) {
  if (!recognised.ok()) return recognised.problem();
  Recording recording = std::move(recognised).value();
  const std::optional<SizedPicture> found = first_color_size(recording);
  if (recording.may_be_two_frames && found && !is_of_one_eye(*found, recording, settings)) {
    part_into_two_frames(recording);
  }
  const bool maybe_one_eye = recording.pair == ImagePair::kSideBySide && found &&
                             !looks_side_by_side(found->width, found->height);
  Result<SourceCalibration> calibration = calibration_of_folder(name, recording, settings, found);
  // Images side by side are recognised by a calibration for eyes of half their width, or
  // by their aspect.
  if (maybe_one_eye && (!calibration.ok() || settings.without_calibration ||
                        2 * calibration.value().format.width != found->width)) {
    const std::string fault = fault_of_named(settings, *found);
    return fault.empty() ? not_recognised(name, *found) : Problem{fault};
  }
  if (!calibration.ok()) return calibration.problem();
  if (!found) {
    return Problem{fmt::format("none of the {} images of {} can be read: {}",
                               recording.frames.size(), name.string(),
                               why_first_is_unreadable(recording))};
  }
  if (settings.without_calibration && recording.pair == ImagePair::kSideBySide) {
    calibration.value().guesses.push_back(
        guess_of_two_eyes(found->path, found->width, found->height));
  }
  const std::optional<SizedPicture> depth = first_depth_size(recording);
  if (auto problem = fit_sizes(name, recording, *found, depth, calibration.value())) {
    return *problem;
  }
  if (!settings.without_calibration || recording.pair == ImagePair::kColorDepth) {
    if (auto problem = problem_with(calibration.value(), settings.baselines)) return *problem;
  }
  std::vector<std::string> notes = recording.notes;
  const bool in_metres =
      recording.pair == ImagePair::kColorDepth && is_exr(recording.frames.front().second);
  if (in_metres && settings.depth_unit) {
    return Problem{fmt::format("--depth-unit is of depth in whole numbers, and {} is in metres",
                               recording.frames.front().second.string())};
  }
  if (recording.pair == ImagePair::kColorDepth && !in_metres) {
    std::vector<std::string> of_unit =
        decide_depth_unit({.asked = settings.depth_unit,
                           .calibration = calibration.value().depth_unit,
                           .known = recording.depth_unit,
                           .known_of = "recordings of " + recording.layout},
                          name.string(), calibration.value().format);
    notes.insert(notes.end(), of_unit.begin(), of_unit.end());
  } else if (settings.depth_unit) {
    return Problem{
        fmt::format("--depth-unit is of depth images, and {} has stereo pairs", name.string())};
  }
  return read_ahead(
      std::make_unique<ImageReader>(std::move(recording), calibration.value(), std::move(notes)));
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
