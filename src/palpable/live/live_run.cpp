#include "palpable/live/live_run.h"

#include "palpable/base/error.h"
#include "palpable/clip_files/place.h"
#include "palpable/live/anchoring.h"
#include "palpable/sources/open_source.h"
#include "palpable/sources/paced_source.h"

#include <fmt/core.h>

#include <system_error>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// Where the first frames say that the body stands; nothing when it is to stand at a place.
std::optional<Rigid3> anchored_pose(const LiveSettings& settings) {
  if (settings.anchor == Anchor::kPlace) return std::nullopt;
  const std::unique_ptr<FrameSource> source = value_or_throw(open_source(settings.images));
  const DepthSettings& depth = settings.session.depth;
  return settings.anchor == Anchor::kPlane
             ? pose_on_plane(*source, settings.images.device, depth)
             : pose_on_board(*source, settings.images.device, depth, settings.board);
}

Rigid3 place_of(const LiveSettings& settings, const SceneFile& scene) {
  if (settings.place) return *settings.place;
  if (scene.camera_from_body) return *scene.camera_from_body;
  throw NoPlaceError(fmt::format("{}: has no scene.toml beside it that says where the body stands",
                                 settings.images.device));
}

SceneFile scene_file_beside(const fs::path& images) {
  std::error_code ignored;
  const fs::path folder = fs::is_directory(images, ignored) ? images : images.parent_path();
  return read_scene_file(folder / "scene.toml");
}

}  // namespace

LiveRun open_live(TouchableBody body, const LiveSettings& settings) {
  const std::optional<Rigid3> anchored = anchored_pose(settings);
  std::unique_ptr<FrameSource> source = value_or_throw(open_source(settings.images));
  if (settings.paced && !source->is_live()) source = paced(std::move(source));
  const fs::path images = settings.images.device;
  const SceneFile scene = scene_file_beside(images);
  const Rigid3 world_from_body = anchored ? *anchored : place_of(settings, scene);

  SessionSettings session = settings.session;
  session.press_static |= scene.press_static;
  Result<FrameLoop> loop =
      FrameLoop::make(std::move(body), world_from_body, source->format(), session);
  if (!loop.ok()) throw Error(fmt::format("{}: {}", images.string(), loop.problem().message));
  if (settings.refine) {
    RefinerSettings refine = *settings.refine;
    refine.waits = !settings.paced && !source->is_live();
    loop.value().session.refine_with(value_or_throw(Refiner::start(refine)));
  }
  return {std::move(source), std::move(loop).value(), images};
}

}  // namespace palpable
