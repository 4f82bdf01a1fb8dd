#include "palpable/live/sources/video_file_source.h"

#include "palpable/live/sources/film_file.h"
#include "palpable/live/sources/name_pattern.h"
#include "palpable/live/sources/read_ahead.h"
#include "palpable/live/sources/side_by_side.h"
#include "palpable/live/sources/source_calibration.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

class VideoReader final : public FrameReader {
 public:
  // @param left  its rate is known
  VideoReader(FilmFile left, FilmFile right, const SourceCalibration& calibration)
      : left_(std::move(left)),
        right_(std::move(right)),
        format_(calibration.format),
        notes_(calibration.guesses) {
    for (const FilmFile* file : {&left_, &right_}) {
      if (file->turn == FilmTurn::kNone) continue;
      notes_.push_back(
          fmt::format("{} was filmed on its side: its pictures are turned {}, as it says",
                      file->path.string(), turn_text(file->turn)));
    }
  }

  const FrameFormat& format() const override { return format_; }
  std::vector<std::string> notes() const override { return notes_; }
  int count() const override {
    return right_.path.empty() ? left_.frames : std::min(left_.frames, right_.frames);
  }

  FrameStatus read(int number, Frame& frame, std::string& trouble) override {
    frame.number = number;
    if (is_damaged_) return FrameStatus::kEnd;
    frame.time = number / left_.rate;
    const bool two = !right_.path.empty();
    if (!left_.next(two ? frame.left : both_)) return end(left_, number, trouble);
    // Times are relative to the first frame's.
    const double time = left_.time();
    if (number == 0) begin_ = time;
    // Some containers have time 0 for all frames.
    if (std::isfinite(time) && time - begin_ > last_time_) frame.time = time - begin_;
    last_time_ = frame.time;
    if (two) {
      if (!right_.next(frame.right)) return end(right_, number, trouble);
    } else {
      split_side_by_side(both_, frame.left, frame.right);
    }
    for (const ColorImage* image : {&frame.left, &frame.right}) {
      if (image->width() == format_.width && image->height() == format_.height) continue;
      trouble = fmt::format("frame {} of {} is {} x {} px; the others are {} x {}", number,
                            left_.path.string(), image->width(), image->height(), format_.width,
                            format_.height);
      return FrameStatus::kUnreadable;
    }
    return FrameStatus::kFrame;
  }

 private:
  // A video with fewer frames than stated is damaged: one unreadable frame reports that,
  // then the video ends.
  FrameStatus end(const FilmFile& file, int number, std::string& trouble) {
    if (number >= count()) return FrameStatus::kEnd;
    is_damaged_ = true;
    trouble = fmt::format("{} is damaged: it ends after {} of {} frames", file.path.string(),
                          number, file.frames);
    return FrameStatus::kUnreadable;
  }

  FilmFile left_;
  FilmFile right_;
  FrameFormat format_;
  std::vector<std::string> notes_;
  double begin_ = 0;
  double last_time_ = -1;
  bool is_damaged_ = false;
  ColorImage both_;
};

// The calibration file of the settings, or the one beside the video; empty without one.
Result<fs::path> calibration_file_of(const fs::path& video, const VideoSettings& settings) {
  std::error_code error;
  const fs::path own = fs::path(video).replace_extension(".yml");
  if (!settings.calibration.empty()) return settings.calibration;
  if (fs::exists(own, error)) return own;
  const fs::path folder = video.parent_path().empty() ? fs::path(".") : video.parent_path();
  std::vector<fs::path> found;
  for (const char* name : {"calibration.yml", "rectified.yml"}) {
    if (fs::exists(folder / name, error)) found.push_back(folder / name);
  }
  const bool has_yaml = !found.empty();
  for (fs::directory_iterator it(folder, error), end; !has_yaml && !error && it != end;
       it.increment(error)) {
    if (matches_pattern(it->path().filename().string(), "SN*.conf")) found.push_back(it->path());
  }
  if (found.size() > 1) {
    return Problem{
        fmt::format("{} has both {} and {} beside it: keep one, or name it with "
                    "--calibration",
                    video.string(), found[0].filename().string(), found[1].filename().string())};
  }
  return found.empty() ? fs::path() : found.front();
}

std::optional<Problem> unequal_sizes(const FilmFile& left, const FilmFile& right) {
  if (left.width == right.width && left.height == right.height) return std::nullopt;
  return Problem{fmt::format("{} is {} x {} px and {} is {} x {}; they should be equal",
                             left.path.string(), left.width, left.height, right.path.string(),
                             right.width, right.height)};
}

Problem not_side_by_side(const FilmFile& both) {
  return Problem{fmt::format(
      "{} is {} x {} px{}, which is no pair side by side; name the other eye's file "
      "with --right",
      both.path.string(), both.width, both.height, both.turn == FilmTurn::kNone ? "" : " upright")};
}

// Only the size, and how it was found.
SourceCalibration without_calibration(const FilmFile& first, int eye_width) {
  SourceCalibration none;
  none.format.width = eye_width;
  none.format.height = first.height;
  if (eye_width != first.width) {
    none.guesses.push_back(guess_of_two_eyes(first.path, first.width, first.height));
  }
  return none;
}

// The calibration of a stereo rig for the eyes of this video. What it says of their width counts;
// without a calibration the picture's aspect decides whether it shows both eyes.
// @param two  whether the other eye has a file of its own
Result<SourceCalibration> fitting_calibration(const FilmFile& first, bool two,
                                              const VideoSettings& settings) {
  const int eye_width = two ? first.width : first.width / 2;
  const bool may_be_pair = two || looks_side_by_side(first.width, first.height);
  if (settings.without_calibration) {
    if (!may_be_pair) return not_side_by_side(first);
    return without_calibration(first, eye_width);
  }
  const Result<fs::path> file = calibration_file_of(first.path, settings);
  if (!file.ok()) return file.problem();
  if (file.value().empty()) {
    if (!may_be_pair) return not_side_by_side(first);
    return Problem{fmt::format(
        "{} has no calibration: name it with --calibration, or put {} beside it",
        first.path.string(), fs::path(first.path).replace_extension(".yml").filename().string())};
  }
  Result<SourceCalibration> read = read_source_calibration(file.value(), eye_width, first.height);
  if (!read.ok()) return read;
  const FrameFormat& format = read.value().format;
  if (format.kind != FrameFormat::Kind::kStereo) {
    return Problem{fmt::format("{} needs a stereo rig's calibration, not one camera's intrinsics",
                               first.path.string())};
  }
  const bool fits = format.width == eye_width && format.height == first.height;
  if (!two && !fits && (!may_be_pair || format.width == first.width)) {
    return Problem{fmt::format("{}; the calibration {} is for eyes of {} x {} px",
                               not_side_by_side(first).message, file.value().string(), format.width,
                               format.height)};
  }
  if (!fits) {
    return Problem{
        fmt::format("{}: the calibration is for eyes of {} x {} px but these are {} x "
                    "{}; calibrate at this size",
                    first.path.string(), format.width, format.height, eye_width, first.height)};
  }
  if (auto problem = problem_with(read.value(), settings.baselines)) return *problem;
  return read;
}

}  // namespace

bool is_video_name(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kVideoEndings.begin(), kVideoEndings.end(), extension) != kVideoEndings.end();
}

Result<std::unique_ptr<FrameSource>> open_video(const fs::path& left, const fs::path& right,
                                                const VideoSettings& settings) {
  FilmFile first;
  FilmFile second;
  first.path = left;
  second.path = right;
  for (FilmFile* file : {&first, &second}) {
    if (file->path.empty()) continue;
    const std::string wrong = file->open();
    if (!wrong.empty()) return Problem{fmt::format("{} {}", file->path.string(), wrong)};
  }
  const bool two = !right.empty();
  if (two) {
    if (auto problem = unequal_sizes(first, second)) return *problem;
  }
  Result<SourceCalibration> calibration = fitting_calibration(first, two, settings);
  if (!calibration.ok()) return calibration.problem();
  if (!(first.rate > 0)) {
    first.rate = calibration.value().frames_per_second;
    if (!calibration.value().rate_is_stated) {
      calibration.value().guesses.push_back(
          fmt::format("{} states no rate: {} Hz is assumed", left.string(), first.rate));
    }
  }
  return read_ahead(
      std::make_unique<VideoReader>(std::move(first), std::move(second), calibration.value()));
}

}  // namespace palpable
