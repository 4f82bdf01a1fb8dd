/// @file
/// The output files of a live run, written by a thread of their own. Their formats are documented
/// in the headers of clip_files that are named here. All files are flushed to the disk once a
/// second, so that a killed run leaves readable files that lack at most its last one or two
/// seconds.
///
/// The text files contain every frame. A run that must not wait for the disk leaves frames out of
/// the large files (film, images, meshes, figures) when the disk is too slow
/// (LiveOutputSettings::complete).
///
///   touch.mp4                 the pictures (video_file_writer.h)
///   timing.csv                ms per stage per frame (frame_records.h)
///   touches.jsonl             the touches of each body (frame_records.h)
///   trajectory.txt            the camera's poses (camera_paths.h)
///   rectification.jsonl       stereo: each change of the row correction (frame_records.h)
///   pose.jsonl                the bodies' poses as drawn (frame_records.h)
///   depth/%06d.png            the measured Z (image_files.h)
///   visible/%06d.png          255 where a body is visible (image_files.h)
///   body_depth/%06d.png       Z of the complete bodies at half size (image_files.h)
///   moving/%06d.png           255 where something moves, at the depth's size (image_files.h)
///   meshes/%06d.ply rest.ply  the deformed skin with its stress, optional (mesh_file.h);
///                             of several bodies each in a folder meshes/NAME
///   pictures/%06d.png         the pictures of selected frames
///   hand_nearer.png body_nearer.png touch.png   the three situations of Fig. 9, optional
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
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace palpable {

/// The groups of files of a run, of which users choose.
struct RunFiles {
  bool film = true;     ///< touch.mp4
  bool data = true;     ///< the text files
  bool depth = true;    ///< depth/
  bool masks = true;    ///< visible/, body_depth/ and moving/
  bool meshes = false;  ///< meshes/
  bool stills = false;  ///< the three situations of Fig. 9

  friend bool operator==(const RunFiles&, const RunFiles&) = default;
};

struct LiveOutputSettings {
  std::filesystem::path folder;  ///< made if it does not exist
  RunFiles files = {};
  /// False: no camera takes part; trajectory.txt, rectification.jsonl and pose.jsonl are not
  /// written.
  bool has_camera = true;
  double starts_at = 0;  ///< s, FrameFormat::starts_at, for trajectory.txt
  /// True: every frame is in all files, and the caller waits for the disk. False: the caller never
  /// waits; frames are left out and counted.
  bool complete = true;
  bool all_pictures = false;             ///< the pictures of all frames go to pictures/
  std::vector<int> kept_pictures = {};   ///< those of these frames do, in rising order
  std::vector<std::string> bodies = {};  ///< names of several bodies; empty for one
  /// The bodies at rest, for RunFiles::meshes; else empty.
  std::vector<SurfaceMesh> meshes_of = {};
  /// The frames from which touch.png is chosen, in rising order. Empty optional: all frames with a
  /// touch.
  std::optional<std::vector<int>> touch_frames = {};
};

/// The frames of a filmed clip in which the object truly penetrates the undeformed body by at least
/// 4 mm, a depth at which the error of a measured depth matters little. Empty optional if the clip
/// has no truth.
/// @param images  the clip's folder frames/
/// @throws Error when the truth cannot be read
[[nodiscard]] std::optional<std::vector<int>> truly_touching_frames(
    const std::filesystem::path& images);

/// Whether `folder` holds an earlier run: files listed above or live.json. Removes nothing.
/// @param needed  files and folders that this run reads; empty ones are skipped
/// @throws Error when there is an earlier run and `overwrite` is false; when a file with one of
/// these names exists without a timing.csv or live.json of a run, and so is not the output of a
/// run; when a folder has the name of such a file; when a needed path would be removed; or when
/// `folder` is a needed folder or lies in one, where the next run would read the results as input
[[nodiscard]] bool holds_earlier_run(const std::filesystem::path& folder, bool overwrite,
                                     const std::vector<std::filesystem::path>& needed);

/// Removes the files of an earlier run by their names, and folders of a run that are empty then.
/// What somebody else put there stays. @throws Error when that is impossible
void remove_earlier_run(const std::filesystem::path& folder);

/// The content of one frame's lines in the text files.
struct FrameLines {
  struct Body {
    Rigid3 camera_from_body = Rigid3::Identity();
    std::optional<StatedError> stated_error;
  };
  int number = 0;
  double time = 0;  // s
  std::vector<Touch> touches;
  std::vector<std::int64_t> things = {};  // Scene::things
  std::optional<Reached> answer = {};     // Scene::answer
  std::vector<Body> bodies;
  TrackedPose camera;
  double row_correction_px = 0;
  double row_error_px = 0;
  StageTimes times;
};

/// Writes the frames of one run; only one run at a time may write into a folder
/// (base/folder_lock.h). The caller fills frames and the thread writes them:
///
///     complete       4 frames circulate; blank() waits until one of them is free
///     not complete   if none is free, blank() returns a fifth one at once, with in_files false: it
///                    is written to the text files only, from a small copy (one of kLines)
///
/// When the disk blocks for so long that all copies are in use (17 s at 30 frames a second), frames
/// are left out of the text files, too.
class LiveOutput {
 public:
  /// @throws Error when the folder or files in it cannot be made
  explicit LiveOutput(const LiveOutputSettings& settings);
  LiveOutput(const LiveOutput&) = delete;
  LiveOutput& operator=(const LiveOutput&) = delete;
  ~LiveOutput();

  static constexpr std::size_t kLines = 512;

  /// Returns a frame to fill. With LiveOutputSettings::complete it waits until one is free.
  /// Allocates nothing.
  std::unique_ptr<DrawnFrame> blank();
  /// Passes a filled frame to the thread, or only its lines if in_files is false. @throws Error for
  /// a failure while an earlier frame was written
  void write(std::unique_ptr<DrawnFrame> frame);
  /// Completes the files. @throws Error when something could not be written. The results after the
  /// counts below are available only after this call.
  void finish();

  [[nodiscard]] const RunFiles& files() const { return settings_.files; }
  /// Number of frames that are in the text files only.
  [[nodiscard]] int left_out() const { return left_out_; }
  /// Number of frames that are in no file.
  [[nodiscard]] int lines_left_out() const { return lines_left_out_; }
  /// The share of the pixels that have a depth in depth/, for each of its images.
  [[nodiscard]] const std::vector<double>& depth_written() const { return depth_written_; }
  /// The film's codec, e.g. "avc1"; empty if there was no frame.
  [[nodiscard]] const std::string& codec() const { return codec_; }
  /// The files of the situations of Fig. 9 that occurred.
  [[nodiscard]] const std::vector<std::string>& figures() const { return figures_; }
  /// (stage -> ms per frame), every stage of timing.csv in its order, "total" last.
  [[nodiscard]] const std::vector<std::pair<std::string, std::vector<double>>>& times() const {
    return times_;
  }

 private:
  // What the thread receives of a frame.
  struct Written {
    FrameLines lines;
    std::unique_ptr<DrawnFrame> drawn;  // null: not in the large files
  };
  /// The text files, open from the constructor on.
  struct Texts {
    Texts(const std::filesystem::path& folder, bool has_camera);
    void flush();
    void close();
    TextFile timing;
    TextFile touches;
    // What a camera's frames have in addition.
    struct OfCamera {
      explicit OfCamera(const std::filesystem::path& folder);
      TextFile trajectory;
      TextFile poses;
      TextFile corrections;
    };
    std::optional<OfCamera> of_camera;
  };
  void close_queues();
  void run();
  void write_frame(Written& frame);
  void write_pictures(const DrawnFrame& frame);
  void write_lines(const FrameLines& scene);
  void write_camera_lines(const FrameLines& scene, Texts::OfCamera& texts);
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
  std::unique_ptr<DrawnFrame> spare_;  // not complete: the fifth frame
  int left_out_ = 0;
  int lines_left_out_ = 0;
  std::optional<Texts> texts_;        // empty without RunFiles::data
  std::vector<ValuedSurface> drawn_;  // reused by write_meshes(), one per body
  std::optional<double> last_correction_;
  std::unique_ptr<VideoFileWriter> video_;
  ColorImage first_picture_;  // kept until the second frame's time gives the film's rate
  double first_time_ = 0;
  int last_number_ = 0;  // of the previous picture
  int written_ = 0;
  std::chrono::steady_clock::time_point flushed_;
  std::array<ColorImage, 3> best_;
  std::array<double, 3> best_score_{};
  std::vector<double> depth_written_;
  std::string codec_;
  std::vector<std::string> figures_;
  std::vector<std::pair<std::string, std::vector<double>>> times_;
  std::exception_ptr trouble_;
  std::thread thread_;
};

}  // namespace palpable
