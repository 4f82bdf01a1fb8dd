#include "bench/live/memory_film.h"

#include "palpable/common/base/error.h"
#include "palpable/live/sources/folder_source.h"
#include "palpable/live/sources/raw_picture.h"
#include "palpable/live/sources/side_by_side.h"

#include <fmt/core.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace palpable::app {
namespace {

constexpr double kFramesPerSecond = 30;

ColorImage resampled(const ColorImage& image, int width, int height) {
  if (image.width() == width && image.height() == height) return image;
  // Only read; OpenCV has no matrix of const data.
  const cv::Mat from(image.height(), image.width(), CV_8UC3,
                     const_cast<Rgb*>(image.data()));  // NOLINT
  ColorImage result(width, height);
  cv::Mat to(height, width, CV_8UC3, result.data());
  cv::resize(from, to, to.size(), 0, 0, width < image.width() ? cv::INTER_AREA : cv::INTER_CUBIC);
  return result;
}

// The centre of a pixel keeps its relative position in the picture.
PinholeCamera resampled(const PinholeCamera& camera, int width, int height) {
  const double x = static_cast<double>(width) / camera.width;
  const double y = static_cast<double>(height) / camera.height;
  return {width,
          height,
          camera.fx_px * x,
          camera.fy_px * y,
          (camera.cx_px + 0.5) * x - 0.5,
          (camera.cy_px + 0.5) * y - 0.5};
}

// BT.601 with luma in 16 .. 235, as cameras send it; two neighbouring pixels share
// their mean chroma.
void add_eye(const ColorImage& eye, int at_column, int row_pixels,
             std::vector<std::uint8_t>& picture) {
  const auto byte = [](double value) {
    return static_cast<std::uint8_t>(std::clamp(static_cast<int>(value + 0.5), 0, 255));
  };
  for (int y = 0; y < eye.height(); ++y) {
    const Rgb* in = eye.row(y);
    std::uint8_t* out = picture.data() + 2 * (static_cast<std::size_t>(y) * row_pixels + at_column);
    for (int x = 0; x + 1 < eye.width(); x += 2) {
      double U = 0, V = 0;
      for (int i = 0; i < 2; ++i) {
        const Rgb c = in[x + i];
        out[2 * (x + i)] = byte(16 + 0.257 * c.r + 0.504 * c.g + 0.098 * c.b);
        U += 0.5 * (-0.148 * c.r - 0.291 * c.g + 0.439 * c.b);
        V += 0.5 * (0.439 * c.r - 0.368 * c.g - 0.071 * c.b);
      }
      out[2 * x + 1] = byte(128 + U);
      out[2 * x + 3] = byte(128 + V);
    }
  }
}

class FilmSource final : public FrameSource {
 public:
  FilmSource(const MemoryFilm& film, bool converted) : film_(film), converted_(converted) {}

  const FrameFormat& format() const override { return film_.format; }
  int frame_count() const override { return -1; }
  std::string last_trouble() const override { return trouble_; }

  FrameStatus next(Frame& frame) override {
    const int count = static_cast<int>(film_.pictures.size());
    const int lap = std::max(2 * count - 2, 1);  // there and back, the ends once
    const int at = next_ % lap;
    const auto& bytes = film_.pictures[static_cast<std::size_t>(at < count ? at : lap - at)];
    frame.number = next_++;
    frame.time = frame.number / kFramesPerSecond;
    const int width = 2 * film_.format.width;
    const RawPicture raw{.format = four_letters("YUYV"),
                         .width = width,
                         .height = film_.format.height,
                         .row_bytes = 2 * static_cast<std::size_t>(width),
                         .data = bytes.data(),
                         .size = bytes.size()};
    trouble_ = converted_ ? to_color(raw, both_) : to_yuyv(raw, frame.both);
    if (!trouble_.empty()) return FrameStatus::kUnreadable;
    if (converted_) split_side_by_side(both_, frame.left, frame.right);
    return FrameStatus::kFrame;
  }

 private:
  const MemoryFilm& film_;
  bool converted_;
  int next_ = 0;
  ColorImage both_;
  std::string trouble_;
};

}  // namespace

MemoryFilm read_film(const std::filesystem::path& folder, const FilmSize& size) {
  const std::unique_ptr<FrameSource> source = value_or_throw(open_folder(folder));
  MemoryFilm film{source->format(), {}};
  if (film.format.kind != FrameFormat::Kind::kStereo || film.format.already_rectified) {
    throw Error(
        fmt::format("{}: raw stereo pairs are played, and these are none", folder.string()));
  }
  const int width = (size.width > 0 ? size.width : film.format.width) / 2 * 2;
  const int height = size.height > 0 ? size.height : film.format.height;
  StereoRig rig = film.format.rig;
  for (DistortedCamera* eye : {&rig.left, &rig.right}) {
    eye->pinhole = resampled(eye->pinhole, width, height);
  }
  film.format = format_of(rig);
  Frame frame;
  while (static_cast<int>(film.pictures.size()) < size.frames) {
    const FrameStatus status = source->next(frame);
    if (status == FrameStatus::kEnd) break;
    if (status != FrameStatus::kFrame) continue;
    auto& picture = film.pictures.emplace_back(4 * static_cast<std::size_t>(width) * height);
    add_eye(resampled(frame.left, width, height), 0, 2 * width, picture);
    add_eye(resampled(frame.right, width, height), width, 2 * width, picture);
  }
  if (film.pictures.empty()) {
    throw Error(fmt::format("{}: no frame could be read", folder.string()));
  }
  return film;
}

std::unique_ptr<FrameSource> play(const MemoryFilm& film, bool converted) {
  return std::make_unique<FilmSource>(film, converted);
}

}  // namespace palpable::app
