/// @file
/// From bodies, images and a pose to a source and a frame loop that are ready to run.
///
///     LiveSettings wanted;
///     wanted.images.device = "my/clip";
///     LiveRun run = open_live(body, wanted);
///     LiveLoop loop(run);                               // live_loop.h
///     while (const Scene* scene = loop.next()) ...
///
/// examples/run_session.cpp is a complete program of this kind.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/calibrate/board_calibration.h"
#include "palpable/live/player/body_place.h"
#include "palpable/live/session/frame_loop.h"
#include "palpable/live/session/refiner.h"
#include "palpable/live/session/session.h"
#include "palpable/live/sources/camera_source.h"
#include "palpable/live/sources/frame_source.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace palpable {

struct LiveSettings {
  CameraRequest images;            ///< folder, named images, video or camera (open_source.h)
  bool paced = false;              ///< play a recording at its own pace; else it waits for the loop
  Anchor anchor = Anchor::kPlace;  ///< for bodies without an anchor of their own
  std::optional<Rigid3> place;     ///< for kPlace: world_from_body
  std::optional<Eigen::Vector2d> at_px;  ///< for kPlane: pixel; empty: a free position is searched
  BoardPattern board;                    ///< for kBoard
  /// The program that computes full-order solutions; empty: none. Frames wait for a solution,
  /// except those of a camera or of a paced recording.
  std::optional<RefinerSettings> refine;
  /// Threads of the whole run (thread_shares.h); 0: one for each processor.
  int threads = 0;
  /// press_static is also set if scene.toml has it; depth.threads is overwritten
  /// according to `threads`.
  SessionSettings session{.track = true, .map = true};
};

/// A run that is ready to begin with the source's first frame.
struct LiveRun {
  std::unique_ptr<FrameSource> source;
  FrameLoop loop;
  std::filesystem::path images;  ///< folder, file or device of the source
};

/// The scene.toml beside a source's images; the default without one. @param images  a folder, or a
/// file in it. @throws Error as read_scene_file()
[[nodiscard]] SceneFile scene_file_beside(const std::filesystem::path& images);

/// Coulomb's coefficient of the bodies in recorded images: that of the scene.toml beside them, else
/// of the clip's truth/friction.txt (film_friction.h), else 0, as recorded images of version 0.1
/// are without friction. Nothing for a camera: there each body's own coefficient counts.
/// @param images  CameraRequest::device
/// @throws Error as read_scene_file() and read_film_friction()
[[nodiscard]] std::optional<double> friction_of_images(const std::filesystem::path& images);

/// Determines the poses, opens the images, and makes the loop. Sets OpenCV's number of threads for
/// the whole process. For anchors kPlane and kBoard the images are opened, played for one second,
/// closed and opened again.
/// @throws NoPlaceError (scene_files.h) when the pose of a body cannot be determined; Error for
/// other failures, e.g. bodies that penetrate each other
/// @param source  already open; settings.images gives its name and the folder in which scene.toml
/// is searched. Null: settings.images is opened
[[nodiscard]] LiveRun open_live(std::vector<LiveBody> bodies, const LiveSettings& settings,
                                std::unique_ptr<FrameSource> source = nullptr);
/// The same with one body.
[[nodiscard]] LiveRun open_live(TouchableBody body, const LiveSettings& settings);

/// New poses of the bodies when a run restarts with a given frame: determined as in open_live(),
/// but from this frame only, whose camera becomes the world frame.
/// @param skins   of the bodies at rest, in the order of `places`
/// @param images  LiveRun::images
/// @throws NoPlaceError where the frame does not show the desk or board that a body needs, or no
/// position there is free
[[nodiscard]] std::vector<Rigid3> places_anew(const std::vector<BodyPlace>& places,
                                              const std::vector<const SurfaceMesh*>& skins,
                                              const LiveSettings& settings,
                                              const std::filesystem::path& images,
                                              const SeenFrame& seen, const DepthNoise& noise);

/// Sets the numbers of threads of a run (thread_shares.h): OpenCV's, for the whole process,
/// and the matcher's.
/// @param threads  of the whole run; 0: one for each processor
void share_threads(int threads, SessionSettings& session);

/// A run of bodies with known poses on an open source, e.g. a recording.
/// @param images  name of the source in messages. @throws Error that names it
[[nodiscard]] LiveRun run_of(std::vector<PlacedBody> standing, std::unique_ptr<FrameSource> source,
                             const SessionSettings& settings, const std::filesystem::path& images);

}  // namespace palpable
