#include "apps/palpable/press_clip_folder.h"

#include "palpable/base/error.h"
#include "palpable/synth/contact_truth.h"
#include "palpable/synth/desk_renderer.h"
#include "palpable/synth/press_clip.h"
#include "palpable/vision/calibration_file.h"
#include "palpable/vision/rectification.h"

#include <fmt/core.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

constexpr double kFramesPerSecond = 30.0;
constexpr int kJpegQuality = 96;
constexpr double kDepthUnit = 0.00025;   // m per count (docs/benchmark.md)
constexpr int kIgnoreStaticFrames = 15;  // what these show does not press

DeskBody desk_body(const ReducedBody& body) {
  DeskBody desk;
  desk.surface = body.surface;
  desk.directions.resize(3, static_cast<Eigen::Index>(body.sites.size()));
  for (std::size_t s = 0; s < body.sites.size(); ++s) {
    desk.site_vertices.push_back(body.sites[s].vertex);
    desk.directions.col(static_cast<Eigen::Index>(s)) = body.sites[s].direction;
  }
  return desk;
}

/// A text file that complains when the disk is full instead of being short.
class TextFile {
 public:
  explicit TextFile(fs::path path) : path_(std::move(path)), stream_(path_) {
    if (!stream_) throw Error(fmt::format("{}: cannot be written", path_.string()));
  }
  void write(const std::string& text) { stream_ << text; }
  void close() {
    stream_.close();
    if (!stream_) throw Error(fmt::format("{}: cannot be written (disk full?)", path_.string()));
  }

 private:
  fs::path path_;
  std::ofstream stream_;
};

void write_image(const fs::path& path, const cv::Mat& image, const std::vector<int>& settings) {
  bool written = false;
  try {
    written = cv::imwrite(path.string(), image, settings);
  } catch (const cv::Exception& error) {
    throw Error(fmt::format("{}: {}", path.string(), error.err));
  }
  if (!written) throw Error(fmt::format("{}: cannot be written (disk full?)", path.string()));
}

void write_jpeg(const fs::path& path, ColorImage& picture) {
  const cv::Mat rgb(picture.height(), picture.width(), CV_8UC3, picture.data());
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  write_image(path, bgr, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
}

void write_depth(const fs::path& path, const DepthImage& depth) {
  cv::Mat counts(depth.height(), depth.width(), CV_16UC1);
  for (int y = 0; y < depth.height(); ++y)
    for (int x = 0; x < depth.width(); ++x) {
      const float value = std::round(depth(x, y) / static_cast<float>(kDepthUnit));
      counts.at<std::uint16_t>(y, x) =
          value >= 1.0F && value <= 65535.0F ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
    }
  write_image(path, counts, {cv::IMWRITE_PNG_COMPRESSION, 1});
}

std::string capsule_line(int frame, const std::vector<HandCapsule>& hand,
                         const Rigid3& camera_from_desk) {
  std::string line = fmt::format("{{\"frame\":{},\"capsules\":[", frame);
  for (std::size_t i = 0; i < hand.size(); ++i) {
    const Eigen::Vector3d a = camera_from_desk * hand[i].shape.a;
    const Eigen::Vector3d b = camera_from_desk * hand[i].shape.b;
    line +=
        fmt::format("{}[{:.7f},{:.7f},{:.7f},{:.7f},{:.7f},{:.7f},{:.7f},{:.7f}]", i > 0 ? "," : "",
                    a.x(), a.y(), a.z(), b.x(), b.y(), b.z(), hand[i].shape.ra, hand[i].shape.rb);
  }
  return line + "]}\n";
}

std::string matrix_text(const Rigid3& transform) {
  std::string text = "[";
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      text +=
          fmt::format("{}{:.12g}", row + column > 0 ? ", " : "", transform.matrix()(row, column));
  return text + "]";
}

void write_texts(const fs::path& out, const PressClip& clip, const RectifiedStereo& stereo) {
  TextFile scene(out / "frames" / "scene.toml");
  scene.write(fmt::format(
      "# Where the body stands: camera_from_body, row by row, in the rectified left camera (m).\n"
      "camera_from_body = {}\nfps = {}\n"
      "# What the first frames show does not press.\nignore_static_frames = {}\n",
      matrix_text(clip.camera_from_body()), kFramesPerSecond, kIgnoreStaticFrames));
  scene.close();

  TextFile camera(out / "truth" / "camera.toml");
  camera.write(fmt::format(
      "# The rectified left camera (px; baseline in m). Depth images have half its size.\n"
      "fx = {:.12g}\nfy = {:.12g}\ncx = {:.12g}\ncy = {:.12g}\nwidth = {}\nheight = {}\n"
      "baseline = {:.12g}\nfps = {}\ndepth_unit_m = {}\n",
      stereo.camera.fx_px, stereo.camera.fy_px, stereo.camera.cx_px, stereo.camera.cy_px,
      stereo.camera.width, stereo.camera.height, stereo.baseline, kFramesPerSecond, kDepthUnit));
  camera.close();

  TextFile script(out / "truth" / "script.toml");
  script.write(fmt::format("hand_in_front = [{}, {}]\nhand_behind = [{}, {}]\n",
                           clip.passes_in_front().first, clip.passes_in_front().last,
                           clip.passes_behind().first, clip.passes_behind().last));
  for (const PlannedPress& press : clip.presses())
    script.write(fmt::format(
        "\n[[press]]\nsite = {}\ndepth = {:.6f}  # m from the first touch, along the load\n"
        "frames = [{}, {}]\nview_angle = {:.1f}  # degrees between touching surface and eye\n",
        press.site, press.depth, press.first_frame, press.last_frame, press.view_angle * 57.29578));
  script.close();
}

void make_folders(const fs::path& out) {
  for (const char* part : {"frames", "truth"})
    if (fs::exists(out / part))
      throw Error(fmt::format("{}: exists; give another folder, or remove it first",
                              (out / part).string()));
  for (const char* folder : {"frames/left", "frames/right", "truth/depth"}) {
    std::error_code error;
    fs::create_directories(out / folder, error);
    if (error)
      throw Error(fmt::format("{}: cannot be made: {}", (out / folder).string(), error.message()));
  }
}

}  // namespace

void write_press_clip(const ReducedBody& reduced, int frames, std::uint64_t seed,
                      const fs::path& folder, const Progress& progress) {
  const DeskBody body = desk_body(reduced);
  const PressClip clip = PressClip::plan(body, frames, seed);
  const StereoRig rig = zed_mini_rig();
  const RectifiedGeometry geometry = rectified_geometry(rig);
  DeskRenderer renderer = value_or_throw(DeskRenderer::make(
      {rig, sensor_faults(seed), geometry.rectified_from_left}, desk_scene(seed), seed));

  make_folders(folder);
  write_stereo_calibration(folder / "frames" / "calibration.yml", {rig, kFramesPerSecond});
  write_texts(folder, clip, geometry.stereo);
  TextFile hands(folder / "truth" / "hand.jsonl");
  TextFile contacts(folder / "truth" / "contact.jsonl");

  const PinholeCamera view = geometry.stereo.camera.scaled_down(2);
  const Eigen::Matrix3Xd vertices =
      (clip.desk_from_body().linear() * body.surface.vertices).colwise() +
      clip.desk_from_body().translation();

  // Pictures are encoded while the next ones are drawn.
  struct Shot {
    RawPair pair;
    DepthImage depth;
  };
  std::future<void> encoding;
  for (int frame = 0; frame < frames; ++frame) {
    const std::optional<HandPose> pose = clip.hand(frame);
    const std::vector<HandCapsule> hand = pose ? hand_capsules(*pose) : std::vector<HandCapsule>{};
    auto shot = std::make_unique<Shot>();
    renderer.draw(clip.camera_from_desk(), hand, frame, shot->pair);
    renderer.draw_depth(clip.camera_from_desk(), hand, view, shot->depth);

    hands.write(capsule_line(frame, hand, clip.camera_from_desk()));
    const ContactTruth truth = contact_truth(shapes_of(hand), vertices);
    const PlannedPress* press = truth.touching ? clip.press_at(frame) : nullptr;
    contacts.write(fmt::format(
        "{{\"frame\":{},\"touching\":{},\"depth\":{:.6f},\"site\":{},\"advance\":{:.6f}}}\n", frame,
        truth.touching, truth.depth, press != nullptr ? press->site : -1, clip.advance(frame)));

    if (encoding.valid()) encoding.get();
    encoding = std::async(std::launch::async, [shot = std::move(shot), frame, &folder] {
      const std::string name = fmt::format("{:06d}", frame);
      write_jpeg(folder / "frames" / "left" / (name + ".jpg"), shot->pair.left);
      write_jpeg(folder / "frames" / "right" / (name + ".jpg"), shot->pair.right);
      write_depth(folder / "truth" / "depth" / (name + ".png"), shot->depth);
    });
    report(progress, {"writing the clip", frame + 1.0, static_cast<double>(frames), ""});
  }
  if (encoding.valid()) encoding.get();
  hands.close();
  contacts.close();
  if (renderer.gl_error_count() > 0)
    throw Error(fmt::format("OpenGL reported {} errors on {}; the pictures may be wrong",
                            renderer.gl_error_count(), renderer.gl_description()));
}

}  // namespace palpable::app
