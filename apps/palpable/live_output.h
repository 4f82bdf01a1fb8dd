/// @file
/// What a live run leaves behind, written on a thread of its own.
///
///   touch.mp4                 the pictures
///   timing.csv                ms per stage per frame
///   touches.jsonl             {"frame","time","site","level","force","press_depth","point"} in SI
///   trajectory.txt            TUM: time tx ty tz qx qy qz qw, world_from_camera
///   rectification.jsonl       stereo: {"frame":n,"row_correction_px":c,"row_error_px":e}: from
///                             this frame on the right image was moved up by c rows beyond the
///                             calibration; e is the error that was left in it (null: too few
///                             points)
///   pose.jsonl                {"frame","camera_from_body"}: where the body was drawn, row by row
///   depth/%06d.png            the measured Z, 16 bit, 0.25 mm, 0 unknown, 65535 too close
///   visible/%06d.png          255 where the body is seen
///   body_depth/%06d.png       Z of the whole body at half size, 16 bit, 0.1 mm, 0 none
///   moving/%06d.png           255 where something moves, at the depth's size
///   hand_nearer.png body_nearer.png touch.png   the three situations of Fig. 9, if asked for
#pragma once

#include "palpable/geometry/image.h"
#include "palpable/live/bounded_queue.h"
#include "palpable/session/scene.h"

#include <array>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace cv {
class VideoWriter;
}

namespace palpable::app {

/// How well a frame shows each situation; 0: not at all.
struct FigureScores {
  double hand_nearer = 0;
  double body_nearer = 0;
  double touch = 0;
};

/// One frame to be written: a scene, and what drawing adds to it. Its memory goes round.
struct DrawnFrame {
  Scene scene;
  ColorImage picture;
  MaskImage visible;
  DepthImage body_depth;  ///< full size
  FigureScores scores;
};

struct LiveOutputSettings {
  std::filesystem::path folder;  ///< made if it is not there
  bool depth = true;
  bool masks = true;
  bool figures = false;
};

/// Keeps runs apart: what an earlier run left in `folder` (the files listed above and live.json,
/// nothing else); empty when there is none. Removes nothing yet.
/// @param needed  paths that this run reads; empty ones are skipped
/// @throws Error when there is such a run and `overwrite` is false, when one of these names is
/// there without timing.csv, and so of somebody else, or when a needed path would go with them
[[nodiscard]] std::vector<std::filesystem::path> earlier_run(
    const std::filesystem::path& folder, bool overwrite,
    const std::vector<std::filesystem::path>& needed);

/// Removes what earlier_run found. @throws Error when that cannot be done
void remove_earlier_run(const std::vector<std::filesystem::path>& there);

class LiveOutput {
 public:
  /// @throws Error when the folder or files in it cannot be made
  explicit LiveOutput(const LiveOutputSettings& settings);
  LiveOutput(const LiveOutput&) = delete;
  LiveOutput& operator=(const LiveOutput&) = delete;
  ~LiveOutput();

  /// A frame to fill; waits while too many are under way.
  std::unique_ptr<DrawnFrame> blank();
  /// Hands a filled frame to the thread. @throws Error what went wrong while writing an earlier one
  void write(std::unique_ptr<DrawnFrame> frame);
  /// Ends the files. @throws Error when something could not be written. After it only:
  void finish();

  /// The video's codec, e.g. "avc1"; empty when there was no frame.
  [[nodiscard]] const std::string& codec() const { return codec_; }
  /// The pictures of situations that occurred.
  [[nodiscard]] const std::vector<std::string>& figures() const { return figures_; }
  /// (stage -> ms per frame), every stage of timing.csv in its order, "total" last.
  [[nodiscard]] const std::vector<std::pair<std::string, std::vector<double>>>& times() const {
    return times_;
  }

 private:
  void run();
  void write_frame(DrawnFrame& frame);
  void write_lines(const DrawnFrame& frame);
  void write_depth(const DrawnFrame& frame);
  void write_masks(const DrawnFrame& frame);
  void write_video(const DrawnFrame& frame);
  void open_video(const ColorImage& picture, double frames_per_second);
  void append(const ColorImage& picture);
  void keep_if_best(const DrawnFrame& frame);
  void end_files();
  void rethrow();

  LiveOutputSettings settings_;
  BoundedQueue<std::unique_ptr<DrawnFrame>> ready_;
  BoundedQueue<std::unique_ptr<DrawnFrame>> free_;
  std::ofstream timing_;
  std::ofstream touches_;
  std::ofstream trajectory_;
  std::ofstream poses_;
  std::ofstream corrections_;
  std::optional<double> last_correction_;
  std::unique_ptr<cv::VideoWriter> video_;
  ColorImage first_picture_;  // held back until the second frame's time says the video's rate
  double first_time_ = 0;
  int written_ = 0;
  std::array<ColorImage, 3> best_;
  std::array<double, 3> best_score_{};
  std::string codec_;
  std::vector<std::string> figures_;
  std::vector<std::pair<std::string, std::vector<double>>> times_;
  std::exception_ptr trouble_;
  std::thread thread_;
};

}  // namespace palpable::app
