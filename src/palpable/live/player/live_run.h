/// @file
/// From "these bodies, these images, this place" to a source and a frame loop that are ready to go.
///
///     LiveSettings wanted;
///     wanted.images.device = "my/clip";
///     LiveRun run = open_live(body, wanted);
///     LiveLoop loop(run);                               // live_loop.h
///     while (const Scene* scene = loop.next()) ...
///
/// examples/run_session.cpp is that, as a program.
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
  CameraRequest images;            ///< folder, images by name, video or camera (open_source.h)
  bool paced = false;              ///< a recording at its own pace; else it waits for the loop
  Anchor anchor = Anchor::kPlace;  ///< where bodies stand that have no anchor of their own
  std::optional<Rigid3> place;     ///< of kPlace: world_from_body
  std::optional<Eigen::Vector2d> at_px;  ///< of kPlane: at which pixel; nothing: it is looked for
  BoardPattern board;                    ///< of kBoard
  /// Whom to ask for exact answers; nothing: nobody. Whether frames wait for them is found out:
  /// those of a camera and of a paced recording do not.
  std::optional<RefinerSettings> refine;
  /// Of the run altogether (thread_shares.h); 0: as many as the machine has.
  int threads = 0;
  /// press_static is set if scene.toml asks for it; depth.threads follows from `threads`.
  SessionSettings session{.track = true, .map = true};
};

/// A run that is about to begin with the source's first frame.
struct LiveRun {
  std::unique_ptr<FrameSource> source;
  FrameLoop loop;
  std::filesystem::path images;  ///< the folder, file or device that is played
};

/// Finds the places, opens the images, and makes the loop. OpenCV's threads are set for the whole
/// process. For kPlane and kBoard the images are opened, played for a second, closed and opened
/// again.
/// @throws NoPlaceError (place.h) when nothing says where a body stands, Error for everything else
///         that is not as hoped, bodies that stand in each other among it
[[nodiscard]] LiveRun open_live(std::vector<LiveBody> bodies, const LiveSettings& settings);
/// The same with one body.
[[nodiscard]] LiveRun open_live(TouchableBody body, const LiveSettings& settings);
/// The same with images that are open already; settings.images says what they are called, and what
/// lies beside them (scene.toml).
[[nodiscard]] LiveRun open_live(std::vector<LiveBody> bodies, const LiveSettings& settings,
                                std::unique_ptr<FrameSource> source);

/// Where bodies stand if a run begins anew with a frame: as open_live() puts them, but by this one
/// frame, whose camera the world then is.
/// @param skins   of the bodies at rest, in the order of their places
/// @param images  LiveRun::images
/// @throws NoPlaceError where the frame does not show what some body is to stand on, or has no free
///         place there
[[nodiscard]] std::vector<Rigid3> places_anew(const std::vector<BodyPlace>& places,
                                              const std::vector<const SurfaceMesh*>& skins,
                                              const LiveSettings& settings,
                                              const std::filesystem::path& images,
                                              const SeenFrame& seen, const DepthNoise& noise);

/// Gives a run its threads (thread_shares.h): OpenCV's, of the whole process, and the matcher's.
/// @param threads  of the run altogether; 0: as many as the machine has
void share_threads(int threads, SessionSettings& session);

/// A run whose bodies stand already, on a source that is open: a recording's.
/// @param images  what messages call the source. @throws Error that names it
[[nodiscard]] LiveRun run_of(std::vector<PlacedBody> standing, std::unique_ptr<FrameSource> source,
                             const SessionSettings& settings, const std::filesystem::path& images);

}  // namespace palpable
