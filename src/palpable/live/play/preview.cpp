#include "palpable/live/play/preview.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/folder_lock.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/depth/depth_survey.h"
#include "palpable/live/live_writer/video_file_writer.h"
#include "palpable/live/render/window.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/slam/slam.h"
#include "palpable/live/sources/open_source.h"
#include "palpable/live/sources/source_guard.h"
#include "palpable/live/view/sensed_picture.h"
#include "palpable/live/view/tiles.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

namespace palpable {
namespace {

constexpr double kFilmRate = 30;  // 1/s

double known_share(const DepthImage& depth) {
  const auto known = std::count_if(depth.begin(), depth.end(), [](float Z) { return Z > 0; });
  return depth.empty() ? 0 : static_cast<double>(known) / static_cast<double>(depth.size());
}

// The camera's picture, the depth and what moves, side by side.
class PreviewPicture {
 public:
  const ColorImage& draw(const Scene& scene) {
    put_tile(scene.seen.color, 0, 3, "camera", sheet_);
    draw_depth(scene, tile_);
    put_tile(tile_, 1, 3, "depth", sheet_);
    draw_moving(scene, tile_);
    put_tile(tile_, 2, 3, "moving", sheet_);
    return sheet_;
  }

 private:
  ColorImage tile_, sheet_;
};

// Where the pictures go: a window, a film, both or neither.
class PreviewOutput {
 public:
  explicit PreviewOutput(const PreviewSettings& settings)
      : file_(settings.out.empty() ? std::filesystem::path() : settings.out / "preview.mp4"),
        opens_window_(settings.window) {
    if (file_.empty()) return;
    require_folder_name(settings.out);
    refuse_among_inputs(settings.out, settings.inputs);
    lock_.emplace(settings.out);
    std::error_code ignored;
    if (std::filesystem::exists(file_, ignored) && !settings.overwrite) {
      throw Error(fmt::format("{}: is there already; --overwrite replaces it", file_.string()));
    }
  }

  void show(const ColorImage& picture) {
    if (opens_window_ && !window_) {
      Result<Window> window =
          Window::open("Palpable: camera, depth, moving", picture.width(), picture.height());
      if (!window.ok()) {
        throw Error(fmt::format("{}; --out DIR writes a film instead", window.problem().message));
      }
      window_.emplace(std::move(window).value());
    }
    if (!file_.empty() && !film_) {
      film_ =
          std::make_unique<VideoFileWriter>(file_, picture.width(), picture.height(), kFilmRate);
    }
    if (window_) window_->show(picture);
    if (film_) film_->append(picture);
  }

  // Whether the user has ended the preview in the window.
  bool ended() {
    if (!window_) return false;
    for (const WindowEvent& event : window_->events(0)) {
      const bool key = event.kind == WindowEvent::Kind::kKey;
      if (key && (event.key == WindowEvent::kEscape || event.key == 'Q')) return true;
    }
    return window_->closed();
  }

  std::filesystem::path finish() {
    if (!film_) return {};
    film_->close();
    return file_;
  }

 private:
  std::filesystem::path file_;
  bool opens_window_;
  std::optional<FolderLock> lock_;  // against other runs that write into the folder
  std::optional<Window> window_;
  std::unique_ptr<VideoFileWriter> film_;
};

}  // namespace

PreviewResult preview(const PreviewSettings& settings, const PlayUser& user) {
  const std::string& name = settings.images.device;
  const std::unique_ptr<FrameSource> source = value_or_throw(open_source(settings.images));
  DepthCamera camera = [&] {
    Result<DepthCamera> made = DepthCamera::make(source->format(), settings.depth);
    if (!made.ok()) throw Error(name + ": " + made.problem().message);
    return std::move(made).value();
  }();
  Slam slam(camera, {.track = settings.track});
  PreviewOutput output(settings);
  PreviewPicture picture;
  PreviewResult result;
  SourceGuard guard(*source);
  DepthSurvey survey(name, source->format(), camera.rectified());
  Frame frame;
  Scene scene;
  const int total = settings.frames > 0 ? settings.frames : source->frame_count();
  user.begin();
  const auto begin = std::chrono::steady_clock::now();
  while ((settings.frames < 0 || result.frames < settings.frames) && !user.asked_to_end() &&
         !output.ended()) {
    const FrameStatus status = guard.next(frame);
    for (const std::string& line : guard.take_reports()) user.say(line);
    if (status == FrameStatus::kEnd) break;
    if (status != FrameStatus::kFrame) continue;
    camera.see(frame, scene.seen);
    survey.add(scene.seen);
    for (const std::string& line : survey.take_warnings()) user.say(line);
    if (scene.seen.misfit) throw Error(name + ": " + scene.seen.misfit->message());
    const SlamFrame& found = slam.advance(scene.seen, scene.times);
    if (found.moving != nullptr) {
      scene.moving = *found.moving;
    } else {
      scene.moving.resize(0, 0);
    }
    result.known += known_share(scene.seen.depth);
    ++result.frames;
    output.show(picture.draw(scene));
    if (total > 0) {
      report(user.progress,
             {"preview", static_cast<double>(result.frames), static_cast<double>(total), ""});
    }
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  result.unreadable = guard.troubles().unreadable;
  if (result.frames == 0) {
    throw Error(fmt::format("{}: no frame could be read ({} unreadable; {})", name,
                            result.unreadable, guard.last_trouble()));
  }
  survey.finish();
  for (const std::string& line : survey.take_warnings()) user.say(line);
  result.depth = survey.figures();
  result.known /= result.frames;
  result.frames_per_second = result.frames / taken.count();
  result.film = output.finish();
  return result;
}

std::string text_of(const PreviewResult& result) {
  std::string text = fmt::format(
      "{} frames, {:.1f} a second{}; depth is known in {:.0f} % of the "
      "picture\n",
      result.frames, result.frames_per_second,
      result.unreadable > 0 ? fmt::format(", {} unreadable", result.unreadable) : "",
      100 * result.known);
  text += text_of(result.depth);
  if (!result.film.empty()) text += result.film.string() + "\n";
  return text;
}

Json json_of(const PreviewResult& result) {
  return {{"frames", result.frames},
          {"unreadable", result.unreadable},
          {"known_share", result.known},
          {"median_m", result.depth.median > 0 ? Json(result.depth.median) : Json()},
          {"frames_per_s", result.frames_per_second},
          {"film", result.film.empty() ? Json() : Json(result.film.string())}};
}

}  // namespace palpable
