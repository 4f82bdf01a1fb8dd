#include "palpable/live/sources/picture_sizes.h"

#include "palpable/live/sources/film_file.h"
#include "palpable/live/sources/image_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// Of pictures of one size; sets it if the calibration has none.
std::optional<Problem> fit_one_size(const fs::path& folder, const Recording& recording,
                                    const SizedPicture& found, SourceCalibration& calibration) {
  FrameFormat& format = calibration.format;
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
  if (!calibration.guesses.empty()) {
    return Problem{fmt::format("{}, but {} is {} x {}: write its `fx fy cx cy` into intrinsics.txt",
                               calibration.guesses.front(), found.path.filename().string(),
                               found.width, found.height)};
  }
  return Problem{fmt::format(
      "{}: the calibration is for images of {} x {} px{} but {} is {} x {}; calibrate at this size "
      "or bring the images to the calibration's",
      folder.string(), format.width, format.height,
      side_by_side ? fmt::format(", side by side {} x {},", 2 * format.width, format.height)
                   : std::string(),
      found.path.filename().string(), found.width, found.height)};
}

std::string two_sizes(const SizedPicture& color, const SizedPicture& depth) {
  return fmt::format("{} is {} x {} px, and {} is {} x {}", depth.path.string(), depth.width,
                     depth.height, color.path.string(), color.width, color.height);
}

// How far the principal point lies from the middle of a picture of this size, as a share of it.
double off_middle(const PinholeCamera& camera, const SizedPicture& size) {
  return std::max(std::abs((camera.cx_px + 0.5) / size.width - 0.5),
                  std::abs((camera.cy_px + 0.5) / size.height - 0.5));
}

bool is_of_size(const FrameFormat& format, const SizedPicture& size) {
  return format.width == size.width && format.height == size.height;
}

// The picture that the numbers of a single camera belong to.
Result<SizedPicture> owner_of_numbers(const fs::path& folder, const Recording& recording,
                                      const SizedPicture& color, const SizedPicture& depth,
                                      SourceCalibration& calibration) {
  const FrameFormat& format = calibration.format;
  if (format.width != 0) {
    if (is_of_size(format, color)) return color;
    if (is_of_size(format, depth)) return depth;
    return *fit_one_size(folder, recording, color, calibration);
  }
  if (recording.calibrates_color) return color;
  const double off_color = off_middle(format.depth_camera, color);
  const double off_depth = off_middle(format.depth_camera, depth);
  constexpr double kMiddle = 0.15, kApart = 0.1;  // shares of a picture: lenses are off by 0.05
  if (std::min(off_color, off_depth) > kMiddle || std::abs(off_color - off_depth) < kApart) {
    return Problem{fmt::format(
        "{}: the numbers of {} may be of either: write `fx fy cx cy width height` with the size of "
        "the pictures that they are of",
        two_sizes(color, depth), calibration.file)};
  }
  const bool of_color = off_color < off_depth;
  const SizedPicture& owner = of_color ? color : depth;
  calibration.guesses.push_back(
      fmt::format("{} states no size: its numbers are taken for the {}'s, {} x {} px, whose middle "
                  "is near (cx, "
                  "cy)",
                  calibration.file, of_color ? "colour" : "depth", owner.width, owner.height));
  return owner;
}

// Whether two pictures may show the same view: the widths agree to a pixel of the smaller one.
bool have_one_shape(const SizedPicture& a, const SizedPicture& b) {
  const SizedPicture& small = a.height < b.height ? a : b;
  const SizedPicture& large = a.height < b.height ? b : a;
  return std::abs(static_cast<double>(large.width) * small.height / large.height - small.width) <=
         1;
}

// Of a depth image that has another size than the colour's.
std::optional<Problem> fit_two_sizes(const fs::path& folder, const Recording& recording,
                                     const SizedPicture& color, const SizedPicture& depth,
                                     SourceCalibration& calibration) {
  FrameFormat& format = calibration.format;
  if (format.color_sensor) {
    if (format.width != 0 && (!is_of_size(format, depth) || !calibration.guesses.empty())) {
      return fit_one_size(folder, recording, is_of_size(format, depth) ? color : depth,
                          calibration);
    }
    set_size(format, color.width, color.height);
    format.depth_camera.width = depth.width;
    format.depth_camera.height = depth.height;
    return std::nullopt;
  }
  if (!have_one_shape(color, depth)) {
    return Problem{fmt::format(
        "{}: these are no two sizes of one view. {}", two_sizes(color, depth),
        have_one_shape({color.height, color.width, {}}, depth)
            ? "One of them lies on its side: turn it as the other lies"
            : "Write the depth camera's `fx fy cx cy` into intrinsics.txt, and in a second line "
              "`color fx fy cx cy` of the colour camera")};
  }
  const Result<SizedPicture> owner = owner_of_numbers(folder, recording, color, depth, calibration);
  if (!owner.ok()) return owner.problem();
  PinholeCamera camera = format.depth_camera;
  camera.width = owner.value().width;
  camera.height = owner.value().height;
  set_size(format, color.width, color.height);
  format.depth_camera = resized(camera, depth.width, depth.height);
  format.color_sensor = {resized(camera, color.width, color.height), Rigid3::Identity()};
  calibration.guesses.push_back(fmt::format(
      "{}: depth of {} x {} px is taken into the view of the colour pictures, {} x {}: f = {:.6g} "
      "px there and {:.6g} px here",
      folder.string(), depth.width, depth.height, color.width, color.height,
      format.depth_camera.fx_px, format.color_sensor->camera.fx_px));
  return std::nullopt;
}

}  // namespace

bool is_exr(const fs::path& path) {
  const std::string ending = path.extension().string();
  return ending == ".exr" || ending == ".EXR";
}

std::optional<SizedPicture> first_color_size(const Recording& recording) {
  if (recording.is_film) {
    FilmFile film;
    film.path = recording.frames.front().first;
    if (!film.open(FilmPose::kAsFilmed).empty()) return std::nullopt;
    return SizedPicture{film.width, film.height, film.path};
  }
  ImageFileReader reader;
  ColorImage image;
  for (const RecordedFrame& frame : recording.frames) {
    if (reader.read_color(frame.first, image).ok()) {
      return SizedPicture{image.width(), image.height(), frame.first};
    }
  }
  return std::nullopt;
}

std::optional<SizedPicture> first_depth_size(const Recording& recording) {
  if (recording.pair != ImagePair::kColorDepth) return std::nullopt;
  ImageFileReader reader;
  Image<std::uint16_t> steps;
  DepthImage metres;
  // Where the first ones are all damaged, each frame is judged when it is read.
  std::size_t left = 10;
  for (const RecordedFrame& frame : recording.frames) {
    if (left-- == 0) break;
    const bool exr = is_exr(frame.second);
    const bool read = exr ? reader.read_metres(frame.second, metres).ok()
                          : reader.read_16bit(frame.second, steps).ok();
    if (!read) continue;
    return exr ? SizedPicture{metres.width(), metres.height(), frame.second}
               : SizedPicture{steps.width(), steps.height(), frame.second};
  }
  return std::nullopt;
}

PinholeCamera resized(const PinholeCamera& camera, int width, int height) {
  const double sx = static_cast<double>(width) / camera.width;
  const double sy = static_cast<double>(height) / camera.height;
  if (sx == 1 && sy == 1) return camera;
  return {width,
          height,
          sx * camera.fx_px,
          sy * camera.fy_px,
          sx * (camera.cx_px + 0.5) - 0.5,
          sy * (camera.cy_px + 0.5) - 0.5};
}

std::optional<Problem> fit_sizes(const fs::path& folder, const Recording& recording,
                                 const SizedPicture& color,
                                 const std::optional<SizedPicture>& depth,
                                 SourceCalibration& calibration) {
  const bool differ = depth && (depth->width != color.width || depth->height != color.height);
  return differ ? fit_two_sizes(folder, recording, color, *depth, calibration)
                : fit_one_size(folder, recording, color, calibration);
}

}  // namespace palpable
