/// @file
/// The files that a live run leaves behind, written on a thread of their own. clip_files has the
/// formats, in the header that is named here. Once a second all of them go to the disk: a run that
/// is killed leaves files that can be read, up to its last second or two.
///
/// The texts have every frame. Of what is large (film, images, meshes, figures) a run that is not
/// to wait for the disk leaves out the frames for which there is no time
/// (LiveOutputSettings::complete).
///
///   touch.mp4                 the pictures (video_file_writer.h)
///   timing.csv                ms per stage per frame (timing_file.h)
///   touches.jsonl             where bodies are pressed (touches_file.h)
///   trajectory.txt            where the camera was (trajectory_file.h)
///   rectification.jsonl       stereo: each change of the correction of rows (rectification_file.h)
///   pose.jsonl                where bodies were drawn (pose_file.h)
///   depth/%06d.png            the measured Z (depth_image_file.h)
///   visible/%06d.png          255 where a body is seen (mask_image_file.h)
///   body_depth/%06d.png       Z of the whole bodies at half size (depth_image_file.h)
///   moving/%06d.png           255 where something moves, at the depth's size (mask_image_file.h)
///   meshes/%06d.ply rest.ply  the body as it is drawn, with its stress, if asked for
///   (mesh_file.h);
///                             of several bodies each in a folder of its name in meshes/
///   pictures/%06d.png         what was shown, of the frames that are asked for
///   hand_nearer.png body_nearer.png touch.png   the three situations of Fig. 9, if asked for
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/mesh_file.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/clip_files/text_file.h"
#include "palpable/live/live_writer/video_file_writer.h"
#include "palpable/live/player/bounded_queue.h"
#include "palpable/live/view/drawn_frame.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace palpable {

struct LiveOutputSettings {
  std::filesystem::path folder;  ///< made if it is not there
  double starts_at = 0;          ///< s: FrameFormat::starts_at, which times of trajectory.txt have
  /// Whether every frame is in all files, and who plays waits for the disk; else nobody waits, and
  /// frames are left out and counted.
  bool complete = true;
  bool depth = true;
  bool masks = true;
  bool figures = false;
  bool all_pictures = false;             ///< every frame's picture is kept as pictures/NUMBER.png
  std::vector<int> kept_pictures = {};   ///< those of these frames are, rising
  std::vector<std::string> bodies = {};  ///< names, where there are several; else none
  /// The bodies at rest where every frame's are to be written; none: nothing is.
  std::vector<SurfaceMesh> meshes_of = {};
  /// Frames that touch.png is chosen from, rising; without them, any frame that feels a touch.
  std::optional<std::vector<int>> touch_frames = {};
};

/// The frames of a filmed clip in which the object truly is at least 4 mm inside the undeformed
/// body (what a camera's depth is wrong by matters little there). Without a truth beside the
/// pictures, nothing.
/// @param images  the clip's frames/
/// @throws Error when the truth cannot be read
[[nodiscard]] std::optional<std::vector<int>> truly_touching_frames(
    const std::filesystem::path& images);

/// Keeps runs apart: what an earlier run left in `folder` (the files listed above and live.json,
/// nothing else); empty when there is none. Removes nothing yet.
/// @param needed  paths that this run reads; empty ones are skipped
/// @throws Error when there is such a run and `overwrite` is false, when one of these names is
/// there without timing.csv, and so of somebody else, when a needed path would go with them, or
/// when `folder` itself is one
[[nodiscard]] std::vector<std::filesystem::path> earlier_run(
    const std::filesystem::path& folder, bool overwrite,
    const std::vector<std::filesystem::path>& needed);

/// Removes what earlier_run found. @throws Error when that cannot be done
void remove_earlier_run(const std::vector<std::filesystem::path>& there);

/// What the texts say of one frame.
struct FrameLines {
  struct Body {
    Rigid3 camera_from_body = Rigid3::Identity();
    std::optional<StatedError> stated_error;
  };
  int number = 0;
  double time = 0;  // s
  std::vector<Touch> touches;
  std::vector<Body> bodies;
  TrackedPose camera;
  double row_correction_px = 0;
  double row_error_px = 0;
  StageTimes times;
};

/// Writes the frames of one run; one run at a time writes into a folder (base/folder_lock.h).
/// Frames go round between the caller, who fills one, and the thread, which writes it:
///
///     complete       blank() waits while all four are under way
///     not complete   a fifth one always comes back at once, with in_files false: of it the texts
///                    are written, which are copied into one of kLines small records
///
/// Where the disk stands still for so long that all records wait (17 s of 30 frames a second),
/// lines are left out, too.
class LiveOutput {
 public:
  /// @throws Error when the folder or files in it cannot be made
  explicit LiveOutput(const LiveOutputSettings& settings);
  LiveOutput(const LiveOutput&) = delete;
  LiveOutput& operator=(const LiveOutput&) = delete;
  ~LiveOutput();

  static constexpr std::size_t kLines = 512;

  /// A frame to fill; waits while too many are under way, if all have to be written. Allocates
  /// nothing.
  std::unique_ptr<DrawnFrame> blank();
  /// Hands a filled frame to the thread; of one that is in no file its lines. @throws Error what
  /// went wrong while writing an earlier one
  void write(std::unique_ptr<DrawnFrame> frame);
  /// Ends the files. @throws Error when something could not be written. What follows the counts
  /// is for after it.
  void finish();

  /// Frames that are in the texts only.
  [[nodiscard]] int left_out() const { return left_out_; }
  /// Frames that are not even there.
  [[nodiscard]] int lines_left_out() const { return lines_left_out_; }
  /// The video's codec, e.g. "avc1"; empty when there was no frame.
  [[nodiscard]] const std::string& codec() const { return codec_; }
  /// The pictures of situations that occurred.
  [[nodiscard]] const std::vector<std::string>& figures() const { return figures_; }
  /// (stage -> ms per frame), every stage of timing.csv in its order, "total" last.
  [[nodiscard]] const std::vector<std::pair<std::string, std::vector<double>>>& times() const {
    return times_;
  }

 private:
  // What the thread gets of a frame.
  struct Written {
    FrameLines lines;
    std::unique_ptr<DrawnFrame> drawn;  // null: it is left out of what is large
  };
  void close_queues();
  void run();
  void write_frame(Written& frame);
  void write_pictures(const DrawnFrame& frame);
  void write_lines(const FrameLines& scene);
  void write_depth(const DrawnFrame& frame);
  void write_masks(const DrawnFrame& frame);
  void write_meshes(const Scene& scene);
  [[nodiscard]] std::string name_of(std::size_t body) const;
  [[nodiscard]] std::filesystem::path meshes_folder(std::size_t body) const;
  void write_video(const DrawnFrame& frame);
  void write_picture(const DrawnFrame& frame);
  void open_video(const ColorImage& picture, double frames_per_second);
  void flush();
  void keep_if_best(const DrawnFrame& frame);
  void end_files();
  void rethrow();

  LiveOutputSettings settings_;
  BoundedQueue<std::unique_ptr<Written>> ready_;
  BoundedQueue<std::unique_ptr<Written>> free_lines_;
  BoundedQueue<std::unique_ptr<DrawnFrame>> free_;
  std::unique_ptr<DrawnFrame> spare_;  // of a run that does not wait: what is left out
  int left_out_ = 0;
  int lines_left_out_ = 0;
  /// The text files, open from the constructor on.
  struct Texts {
    explicit Texts(const std::filesystem::path& folder);
    void flush();
    void close();
    TextFile timing;
    TextFile touches;
    TextFile trajectory;
    TextFile poses;
    TextFile corrections;
  };
  std::optional<Texts> texts_;
  std::vector<ValuedSurface> drawn_;  // of write_meshes, body by body
  std::optional<double> last_correction_;
  std::unique_ptr<VideoFileWriter> video_;
  ColorImage first_picture_;  // held back until the second frame's time says the video's rate
  double first_time_ = 0;
  int last_number_ = 0;  // of the picture before
  int written_ = 0;
  std::chrono::steady_clock::time_point flushed_;
  std::array<ColorImage, 3> best_;
  std::array<double, 3> best_score_{};
  std::string codec_;
  std::vector<std::string> figures_;
  std::vector<std::pair<std::string, std::vector<double>>> times_;
  std::exception_ptr trouble_;
  std::thread thread_;
};

}  // namespace palpable
