#include "palpable/live/player/live_run.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/film_friction.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/live/depth/image_threads.h"
#include "palpable/live/player/anchoring.h"
#include "palpable/live/player/thread_shares.h"
#include "palpable/live/sources/open_source.h"
#include "palpable/live/sources/paced_source.h"

#include <fmt/core.h>

#include <map>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// The pose of a body at an anchor, found in the first frames.
Rigid3 anchored_pose(Anchor anchor, const LiveSettings& settings, const Footprint& room) {
  const std::unique_ptr<FrameSource> source = value_or_throw(open_source(settings.images));
  const DepthSettings& depth = settings.session.depth;
  return anchor == Anchor::kPlane
             ? pose_on_plane(*source, settings.images.device, depth, {room, settings.at_px})
             : pose_on_board(*source, settings.images.device, depth, settings.board);
}

Rigid3 place_of(const LiveSettings& settings, const SceneFile& scene) {
  if (settings.place) return *settings.place;
  if (scene.camera_from_body) return *scene.camera_from_body;
  throw NoPlaceError(fmt::format("{}: has no scene.toml beside it that says where the body stands",
                                 settings.images.device));
}

// The poses of those anchors that have to be found in the first frames and that some body uses.
std::map<Anchor, Rigid3> looked_for_places(const std::vector<LiveBody>& bodies,
                                           const LiveSettings& settings) {
  std::vector<BodyPlace> stands;
  std::vector<const SurfaceMesh*> skins;
  for (const LiveBody& body : bodies) {
    stands.push_back(body.place);
    skins.push_back(&body.body.body.surface);
  }
  std::map<Anchor, Rigid3> places;
  for (const LiveBody& body : bodies) {
    const Anchor anchor = body.place.anchor.value_or(settings.anchor);
    const bool looks = anchor != Anchor::kPlace && body.place.beside < 0 && !body.place.place;
    if (looks && !places.contains(anchor)) {
      places[anchor] =
          anchored_pose(anchor, settings, footprint_of(stands, skins, settings.anchor));
    }
  }
  return places;
}

// The folder that holds the images, from its own name or that of a file in it.
fs::path folder_of_images(const fs::path& images) {
  std::error_code ignored;
  return fs::is_directory(images, ignored) ? images : images.parent_path();
}

}  // namespace

SceneFile scene_file_beside(const fs::path& images) {
  return read_scene_file(folder_of_images(images) / "scene.toml");
}

std::optional<double> friction_of_images(const fs::path& images) {
  if (images.string().starts_with("/dev/")) return std::nullopt;  // as open_source()
  if (const SceneFile scene = scene_file_beside(images); scene.friction) return scene.friction;
  const fs::path clip = folder_of_images(images) / "..";
  return read_film_friction(clip).value_or(0.0);
}

LiveRun open_live(TouchableBody body, const LiveSettings& settings) {
  std::vector<LiveBody> bodies;
  bodies.push_back({std::move(body)});
  return open_live(std::move(bodies), settings);
}

LiveRun open_live(std::vector<LiveBody> bodies, const LiveSettings& settings,
                  std::unique_ptr<FrameSource> source) {
  const fs::path images = settings.images.device;
  // The search opens the source, plays it and closes it again, before it is opened here: a camera
  // can be opened only once at a time.
  const std::map<Anchor, Rigid3> looked_for = looked_for_places(bodies, settings);
  if (!source) source = value_or_throw(open_source(settings.images));
  const SceneFile scene = scene_file_beside(images);
  std::vector<PlacedBody> standing = placed(std::move(bodies), settings.anchor, [&](Anchor anchor) {
    return anchor == Anchor::kPlace ? place_of(settings, scene) : looked_for.at(anchor);
  });
  if (const auto overlap = overlap_of(standing)) throw Error(*overlap);
  if (settings.paced && !source->is_live()) source = paced(std::move(source));
  SessionSettings session = settings.session;
  share_threads(settings.threads, session);
  session.press_static |= scene.press_static;
  LiveRun run = run_of(std::move(standing), std::move(source), session, images);
  if (settings.refine) {
    RefinerSettings refine = *settings.refine;
    refine.waits = !settings.paced && !run.source->is_live();
    run.loop.session.refine_with(value_or_throw(Refiner::start(refine)));
  }
  return run;
}

std::vector<Rigid3> places_anew(const std::vector<BodyPlace>& places,
                                const std::vector<const SurfaceMesh*>& skins,
                                const LiveSettings& settings, const fs::path& images,
                                const SeenFrame& seen, const DepthNoise& noise) {
  const SceneFile scene = scene_file_beside(images);
  return world_from_bodies(places, settings.anchor, [&](Anchor anchor) {
    switch (anchor) {
      case Anchor::kPlace:
        break;
      case Anchor::kPlane:
        if (settings.at_px) {
          if (const auto pose = pose_at_pixel(seen, noise, *settings.at_px)) return *pose;
          throw NoPlaceError(fmt::format("no surface is seen at pixel {}, {}", settings.at_px->x(),
                                         settings.at_px->y()));
        }
        if (const auto pose =
                pose_on_desk(seen, noise, footprint_of(places, skins, settings.anchor))) {
          return *pose;
        }
        throw NoPlaceError("no desk or floor with a free place to stand on is seen");
      case Anchor::kBoard:
        if (const auto pose = find_board_pose(seen.color, seen.camera, settings.board)) {
          return *pose;
        }
        throw NoPlaceError("the chessboard is not seen");
    }
    return place_of(settings, scene);
  });
}

void share_threads(int threads, SessionSettings& session) {
  const ThreadShares shares = thread_shares(threads > 0 ? threads : usual_threads());
  use_image_threads(shares.images);
  session.depth.threads = shares.matching;
}

LiveRun run_of(std::vector<PlacedBody> standing, std::unique_ptr<FrameSource> source,
               const SessionSettings& settings, const fs::path& images) {
  Result<FrameLoop> loop = FrameLoop::make(std::move(standing), source->format(), settings);
  if (!loop.ok()) throw Error(fmt::format("{}: {}", images.string(), loop.problem().message));
  return {std::move(source), std::move(loop).value(), images};
}

}  // namespace palpable
