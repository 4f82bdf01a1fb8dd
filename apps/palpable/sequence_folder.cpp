#include "apps/palpable/sequence_folder.h"

#include "palpable/base/error.h"
#include "palpable/calibrate/calibration_file.h"
#include "palpable/script/contact_truth.h"

#include <fmt/core.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <future>
#include <mutex>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

constexpr int kFramesForTwo = 30;  // of a film for which a second renderer is worth its start
constexpr int kJpegQuality = 96;
constexpr int kIgnoreStaticFrames = 15;   // what these show does not press
constexpr double kDepthUnit = 0.00025;    // m per count
constexpr double kTruthSpacing = 0.0015;  // m between points of the body that are looked at
constexpr double kAtSite = 0.010;         // m: farther from every site a touch lies between them

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
      const double value = std::round(static_cast<double>(depth(x, y)) / kDepthUnit);
      counts.at<std::uint16_t>(y, x) =
          value >= 1.0 && value <= 65534.0 ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
    }
  write_image(path, counts, {cv::IMWRITE_PNG_COMPRESSION, 1});
}

void write_labels(const fs::path& path, MaskImage& labels) {
  write_image(path, cv::Mat(labels.height(), labels.width(), CV_8UC1, labels.data()),
              {cv::IMWRITE_PNG_COMPRESSION, 1});
}

std::string capsule_line(int frame, const Movers& movers, const Rigid3& camera_from_desk) {
  std::string line = fmt::format("{{\"frame\":{},\"capsules\":[", frame);
  bool first = true;
  for (const HandCapsule& capsule : movers.capsules) {
    const Eigen::Vector3d a = camera_from_desk * capsule.shape.a;
    const Eigen::Vector3d b = camera_from_desk * capsule.shape.b;
    line +=
        fmt::format("{}[{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}]", first ? "" : ",",
                    a.x(), a.y(), a.z(), b.x(), b.y(), b.z(), capsule.shape.ra, capsule.shape.rb);
    first = false;
  }
  return line + "]}\n";
}

std::string contact_line(int frame, const Movers& movers, const SurfacePoints& in_desk,
                         const DeskBody& body, const Rigid3& desk_from_body) {
  const PressTruth truth = press_truth(shapes_of(movers.capsules), in_desk);
  if (!truth.touching)
    return fmt::format("{{\"frame\":{},\"touching\":false,\"depth_m\":0,\"site\":-1}}\n", frame);
  const Eigen::Vector3d point = desk_from_body.inverse() * in_desk.points.col(truth.point);
  int site = nearest_site(body, point);
  if (site >= 0) {
    const int vertex = body.site_vertices[static_cast<std::size_t>(site)];
    if ((body.surface.vertices.col(vertex) - point).norm() > kAtSite) site = -1;
  }
  return fmt::format(
      "{{\"frame\":{},\"touching\":true,\"depth_m\":{:.6f},\"site\":{},\"point\":[{:.6f},{:.6f},{:."
      "6f}"
      "]}}\n",
      frame, truth.depth, site, point.x(), point.y(), point.z());
}

std::string trajectory_line(int frame, const Rigid3& world_from_camera) {
  const Eigen::Quaterniond q(world_from_camera.linear());
  const Eigen::Vector3d t = world_from_camera.translation();
  return fmt::format("{:.6f} {:.7f} {:.7f} {:.7f} {:.9f} {:.9f} {:.9f} {:.9f}\n",
                     frame / kFramesPerSecond, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

std::string matrix_text(const Rigid3& transform) {
  std::string text = "[";
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      text +=
          fmt::format("{}{:.12g}", row + column > 0 ? ", " : "", transform.matrix()(row, column));
  return text + "]";
}

void write_texts(const fs::path& out, const Sequence& sequence) {
  TextFile scene(out / "frames" / "scene.toml");
  scene.write(fmt::format(
      "# Where the body stands: camera_from_body, row by row, in the first frame's rectified left\n"
      "# camera (m).\ncamera_from_body = {}\nfps = {}\n"
      "# What the first frames show does not press.\nignore_static_frames = {}\n",
      matrix_text(sequence.camera_from_body()), kFramesPerSecond, kIgnoreStaticFrames));
  scene.close();

  TextFile script(out / "truth" / "script.toml");
  script.write(fmt::format("frames = {}\nframes_without_hand = {}\n", sequence.frames,
                           std::min(sequence.frames, kFramesWithoutHand)));
  for (const NamedSpan& span : sequence.spans)
    script.write(fmt::format("\n[[span]]\nwhat = \"{}\"\nframes = [{}, {}]\n", span.name,
                             span.frames.first, span.frames.last));
  for (const PlannedTouch& touch : sequence.touches)
    script.write(fmt::format(
        "\n[[touch]]\nwhat = \"{}\"\nsite = {}\nbetween_sites = {}\n"
        "depth = {:.6f}  # m from the first touch on\nseconds_to_depth = {:.3f}\nframes = [{}, "
        "{}]\n"
        "view_angle = {:.1f}  # degrees between the touching surface's normal and the ray\n",
        touch.what, touch.site, touch.between, touch.depth, touch.seconds_to_depth,
        touch.frames.first, touch.frames.last, touch.view_angle * 57.29578));
  script.close();
}

// Without it a folder is no truth: it is written last, so that nobody scores half a film.
void write_truth_camera(const fs::path& out, const Sequence& sequence, const SequenceOrder& order,
                        const PinholeCamera& view, double baseline) {
  TextFile camera(out / "truth" / "camera.toml");
  camera.write(fmt::format(
      "# The rectified left camera at half size: px; baseline in m.\n"
      "width = {}\nheight = {}\nfx = {:.12g}\nfy = {:.12g}\ncx = {:.12g}\ncy = {:.12g}\n"
      "baseline_m = {:.12g}\nfps = {}\ndepth_unit_m = {}\nsequence = \"{}\"\nseed = {}\n"
      "body = '''{}'''\n",
      view.width, view.height, view.fx_px, view.fy_px, view.cx_px, view.cy_px, baseline,
      kFramesPerSecond, kDepthUnit, sequence.name, sequence.seed, order.body_name));
  camera.close();
}

void make_folders(const fs::path& out) {
  for (const char* part : {"frames", "truth"})
    if (fs::exists(out / part))
      throw Error(fmt::format("{}: exists; give another folder, or remove it first",
                              (out / part).string()));
  for (const char* folder : {"frames/left", "frames/right", "truth/depth", "truth/labels"}) {
    std::error_code error;
    fs::create_directories(out / folder, error);
    if (error)
      throw Error(fmt::format("{}: cannot be made: {}", (out / folder).string(), error.message()));
  }
}

DeskRenderer make_renderer(const Sequence& sequence, const DeskScene& scene, const StereoRig& rig,
                           const RectifiedGeometry& geometry) {
  return value_or_throw(DeskRenderer::make({rig, sequence.faults, geometry.rectified_from_left},
                                           scene, sequence.look));
}

void check_gl(const DeskRenderer& renderer) {
  if (renderer.gl_error_count() > 0)
    throw Error(fmt::format("OpenGL reported {} errors on {}; the pictures may be wrong",
                            renderer.gl_error_count(), renderer.gl_description()));
}

/// What one frame adds to the texts of the truth.
struct FrameLines {
  std::string hand, contact, trajectory, rig;
};

/// Films single frames; may be used by several threads, each with its own renderer.
struct FrameWriter {
  const fs::path& folder;
  const Sequence& sequence;
  const DeskBody& body;
  PinholeCamera view;  ///< of the truth
  double baseline;
  SurfacePoints body_in_desk;

  /// Writes the frame's images.
  [[nodiscard]] FrameLines write(DeskRenderer& renderer, int frame) const {
    const DeskMoment moment = moment_of(sequence, frame);
    RawPair pair;
    DeskTruth truth;
    renderer.draw(moment, pair);
    renderer.draw_truth(moment, view, baseline, truth);
    const std::string name = fmt::format("{:06d}", frame);
    write_jpeg(folder / "frames" / "left" / (name + ".jpg"), pair.left);
    write_jpeg(folder / "frames" / "right" / (name + ".jpg"), pair.right);
    write_depth(folder / "truth" / "depth" / (name + ".png"), truth.depth);
    write_labels(folder / "truth" / "labels" / (name + ".png"), truth.labels);

    const Movers movers = moment.movers(frame);
    FrameLines lines;
    lines.hand = capsule_line(frame, movers, moment.camera_from_desk(frame));
    lines.contact = contact_line(frame, movers, body_in_desk, body, sequence.desk_from_body);
    lines.trajectory = trajectory_line(frame, world_from_camera(sequence, frame));
    lines.rig = fmt::format("{{\"frame\":{},\"row_offset_px\":{:.4f}{}}}\n", frame,
                            sequence.faults.row_error_px + moment.rig.row_offset_px,
                            moment.rig.row_step ? ",\"step\":true" : "");
    return lines;
  }
};

}  // namespace

fs::path default_body() {
  constexpr std::array kBodies = {"build/bodies/bunny-dense.palpable", "out/demo/bunny.palpable"};
  for (const char* body : kBodies)
    if (fs::exists(body)) return body;
  throw Error(fmt::format("neither {} nor {} is there; bake one, or give --body FILE", kBodies[0],
                          kBodies[1]));
}

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

Film film_of(const Sequence& sequence) {
  const StereoRig rig = zed_mini_rig();
  const RectifiedGeometry geometry = rectified_geometry(rig);
  return {rig, geometry, make_renderer(sequence, desk_scene(sequence.look), rig, geometry)};
}

void write_sequence(const ReducedBody& reduced, const SequenceOrder& order, const fs::path& folder,
                    const Progress& progress) {
  const DeskBody body = desk_body(reduced);
  const Sequence sequence = plan_sequence(order.name, body, order.frames, order.seed);
  const StereoRig rig = zed_mini_rig();
  const RectifiedGeometry geometry = rectified_geometry(rig);
  const DeskScene scene = desk_scene(sequence.look);
  const PinholeCamera view = geometry.stereo.camera.scaled_down(2);
  const FrameWriter writer{
      folder,
      sequence,
      body,
      view,
      geometry.stereo.baseline,
      transformed(sample_surface(body.surface, kTruthSpacing), sequence.desk_from_body)};

  // Two threads film, each with its own renderer, whichever frame comes next: while one waits for
  // the GPU, or for the threads that stand in for it, the other makes meshes and encodes.
  const int threads = order.threads > 0 ? order.threads : sequence.frames < kFramesForTwo ? 1 : 2;
  std::vector<FrameLines> lines(static_cast<std::size_t>(sequence.frames));
  std::once_flag folders;
  std::atomic<int> next = 0, written = 0;
  std::atomic<bool> stop = false;
  const auto film = [&](const Progress& show) {
    try {
      DeskRenderer renderer = make_renderer(sequence, scene, rig, geometry);
      // Nothing is written where nothing can be drawn.
      std::call_once(folders, [&] {
        if (stop) return;
        make_folders(folder);
        write_stereo_calibration(folder / "frames" / "calibration.yml", {rig, kFramesPerSecond});
        write_texts(folder, sequence);
      });
      for (int frame = next++; frame < sequence.frames && !stop; frame = next++) {
        lines[static_cast<std::size_t>(frame)] = writer.write(renderer, frame);
        report(show, {"writing the sequence", static_cast<double>(++written),
                      static_cast<double>(sequence.frames), ""});
      }
      check_gl(renderer);
    } catch (...) {
      stop = true;
      throw;
    }
  };
  std::future<void> other = std::async(std::launch::async, [&] {
    if (threads > 1) film({});
  });
  film(progress);
  other.get();
  report(progress, {"writing the sequence", static_cast<double>(sequence.frames),
                    static_cast<double>(sequence.frames), ""});

  const auto write_lines = [&](const char* name, std::string FrameLines::*line) {
    TextFile file(folder / "truth" / name);
    for (const FrameLines& frame : lines) file.write(frame.*line);
    file.close();
  };
  write_lines("hand.jsonl", &FrameLines::hand);
  write_lines("contact.jsonl", &FrameLines::contact);
  write_lines("trajectory.txt", &FrameLines::trajectory);
  write_lines("rig.jsonl", &FrameLines::rig);
  write_truth_camera(folder, sequence, order, view, geometry.stereo.baseline);
}

}  // namespace palpable::app
