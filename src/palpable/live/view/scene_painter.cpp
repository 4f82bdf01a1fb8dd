#include "palpable/live/view/scene_painter.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/stage_clock.h"
#include "palpable/live/view/painted_stress.h"
#include "palpable/live/view/sensed_picture.h"
#include "palpable/live/view/stress_scale.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

std::vector<std::string> names_of_bodies(const Session& session) {
  std::vector<std::string> names;
  for (int k = 0; k < session.body_count(); ++k) names.push_back(session.body(k).name);
  return names;
}

}  // namespace

ScenePainter::ScenePainter(const ScenePainterSettings& settings, const FrameLoop& loop)
    : session_(loop.session),
      scale_(stress_scale(loop.session)),
      views_(scale_),
      masks_(settings.masks),
      tiles_(settings.tiles),
      true_depth_(settings.true_depth),
      keep_picture_(settings.keep_picture),
      controls_(settings.view, settings.show, loop.session.body_count()),
      panel_(names_of_bodies(loop.session)) {
  const PinholeCamera& camera = loop.camera.camera();
  if (settings.window) {
    Result<Window> window = Window::open("Palpable", camera.width, camera.height);
    if (!window.ok()) {
      throw Error(fmt::format(
          "{}; with --no-window it plays all the same, and --out writes what would be seen",
          window.problem().message));
    }
    window_.emplace(std::move(window).value());
    window_->set_panel([this] { panel_.lay_out(controls_); });
    controls_.paused = settings.paused;
  } else {
    offscreen_.emplace(value_or_throw(GlContext::offscreen()));
  }
  renderer_.emplace(value_or_throw(SceneRenderer::make()));
  make_outside_views(settings.view);
  controls_.run_may_change = settings.run_may_change;
  gather_parameters();
}

// Makes the views from outside that may be shown; in a window the user can switch to each.
void ScenePainter::make_outside_views(LiveView view) {
  if (window_ || view == LiveView::kMap || has_tile(Tile::kMap)) {
    map_ = std::make_unique<MapPicture>(value_or_throw(MapRenderer::make()),
                                        session_.body().world_from_body);
  }
  if (window_ || view == LiveView::kSurface || has_tile(Tile::kSurface)) {
    surface_ = std::make_unique<SurfacePicture>(value_or_throw(MapRenderer::make()), session_);
  }
}

void ScenePainter::gather_parameters() {
  controls_.parameters.clear();
  for (int k = 0; controls_.run_may_change && k < session_.body_count(); ++k) {
    for (const FurtherParameter& p : session_.body(k).model().further) {
      controls_.parameters.push_back(
          {k, p.name, p.samples[0], p.samples[p.samples.size() - 1], p.value});
    }
  }
}

void ScenePainter::begin_anew() {
  scale_ = stress_scale(session_);
  views_ = SceneViews(scale_);
  light_ = LightEstimator();
  make_outside_views(controls_.view);
  gather_parameters();
}

SceneExtras ScenePainter::wants() const {
  if (controls_.paused) return {.components = true, .contact_pressure = true};
  return extras_for(controls_.show.field);
}

bool ScenePainter::draw(DrawnFrame& drawn, const Session& session, bool wanted, bool for_page) {
  drawn_for_window_ = window_ && !holds();
  const bool is_unused = !drawn_for_window_ && !for_page && !(drawn.in_files && wanted);
  const bool draws_map = controls_.view == LiveView::kMap || has_tile(Tile::kMap);
  if (map_ && (is_unused || !draws_map)) map_->follow(drawn.scene);
  if (is_unused) return false;
  {
    const StageTimer timer(drawn.scene.times, "draw");
    const bool masks = masks_ && drawn.in_files;
    if (!tiles_.empty()) {
      draw_tiles(drawn, session);
    } else {
      draw_look(drawn.scene, session, drawn.picture, masks ? &drawn.visible : nullptr,
                masks ? &drawn.body_depth : nullptr);
    }
  }
  if (!drawn_for_window_) return true;
  panel_.add(drawn.scene);
  if (!controls_.paused) {
    held_.reset();
    return true;
  }
  controls_.step_wanted = false;
  held_ = drawn.scene;
  held_picture_ = drawn.picture;
  held_view_ = controls_.view;
  held_show_ = controls_.show;
  return true;
}

void ScenePainter::draw_look(const Scene& scene, const Session& session, ColorImage& picture,
                             MaskImage* visible, DepthImage* body_depth) {
  const LiveView look = controls_.view;
  const bool outside = look == LiveView::kMap || look == LiveView::kSurface;
  if (look == LiveView::kCamera || outside || visible != nullptr) {
    SceneView& view = views_.of(scene, session, controls_.show);
    const Rigid3& camera_from_body = scene.bodies.front().camera_from_body;
    light_.see(scene.seen, camera_from_body);
    view.light = light_in_camera(light_.light(), camera_from_body);
    if (outside) {  // that view has a caption of its own
      view.legend_title.clear();
      view.caption.clear();
      view.warning.clear();
    }
    renderer_->draw(view, look == LiveView::kCamera ? picture : inside_, visible, body_depth);
  }
  switch (look) {
    case LiveView::kCamera:
      break;
    case LiveView::kDepth:
      draw_depth(scene, picture);
      break;
    case LiveView::kMoving:
      draw_moving(scene, picture);
      break;
    case LiveView::kSurface:
      surface_->draw(scene, session, scale_, controls_.show.colors, inside_, picture);
      break;
    case LiveView::kMap:
      map_->draw(scene, session, scale_, controls_.show.colors, inside_, picture);
      break;
  }
}

bool ScenePainter::has_tile(Tile tile) const {
  return std::find(tiles_.begin(), tiles_.end(), tile) != tiles_.end();
}

void ScenePainter::draw_tiles(DrawnFrame& drawn, const Session& session) {
  const bool masks = masks_ || has_tile(Tile::kMask) || has_tile(Tile::kTruth);
  controls_.view = LiveView::kCamera;
  draw_look(drawn.scene, session, seen_, masks ? &drawn.visible : nullptr,
            masks ? &drawn.body_depth : nullptr);
  for (std::size_t k = 0; k < tiles_.size(); ++k) {
    const Tile tile = tiles_[k];
    switch (tile) {
      case Tile::kCamera:
        break;
      case Tile::kMask:
        draw_mask(drawn.visible, tile_);
        break;
      case Tile::kTruth:
        if (const auto depth = true_depth_(drawn.scene.number)) {
          draw_true_mask(drawn.visible, drawn.body_depth, *depth, tile_);
        } else {
          tile_.resize(seen_.width(), seen_.height());
          std::fill(tile_.begin(), tile_.end(), Rgb{});
        }
        break;
      default:
        controls_.view = static_cast<LiveView>(tile);
        draw_look(drawn.scene, session, tile_, nullptr, nullptr);
    }
    put_tile(tile == Tile::kCamera ? seen_ : tile_, static_cast<int>(k),
             static_cast<int>(tiles_.size()), kTileNames[static_cast<std::size_t>(tile)],
             drawn.picture);
  }
}

void ScenePainter::show(const ColorImage& picture) {
  if (!window_) return;
  if (drawn_for_window_) {
    window_->show(picture);
    if (controls_.picture_wanted) keep_picture(picture);
  }
  handle_events();
}

void ScenePainter::handle(const WindowEvent& event) {
  const bool places = controls_.placing;
  controls_.handle(event);
  if (places) return;
  const bool key = event.kind == WindowEvent::Kind::kKey;
  // The key R resets both views; the mouse turns the one that is shown.
  if (key || controls_.view == LiveView::kMap) map_->handle(event);
  if (key || controls_.view == LiveView::kSurface) surface_->handle(event);
}

void ScenePainter::handle_events(double wait) {
  if (!window_) return;
  bool happened = false;
  for (const WindowEvent& event : window_->events(wait)) {
    handle(event);
    happened = true;
  }
  ended_ |= controls_.ended || window_->closed();
  // A wish is fulfilled with the next frame, which must be shown for that.
  if (controls_.paused && controls_.wishes.of_frame()) controls_.step_wanted = true;
  if (!holds()) return;
  const bool outside = controls_.view == LiveView::kMap || controls_.view == LiveView::kSurface;
  if ((happened && outside) || controls_.view != held_view_ || !(controls_.show == held_show_)) {
    draw_held();
  } else if (happened || controls_.picture_wanted) {
    window_->show(held_picture_);  // with the panel's present content
  }
  if (controls_.picture_wanted) keep_picture(held_picture_);
}

void ScenePainter::refresh_panel() {
  if (holds()) window_->show(held_picture_);
}

void ScenePainter::draw_held() {
  held_view_ = controls_.view;
  held_show_ = controls_.show;
  draw_look(*held_, session_, held_picture_, nullptr, nullptr);
  window_->show(held_picture_);
}

void ScenePainter::keep_picture(const ColorImage& picture) {
  controls_.picture_wanted = false;
  if (keep_picture_) panel_.note = keep_picture_(picture);
}

void ScenePainter::throw_gl_errors() const {
  (window_ ? window_->gl_errors() : offscreen_->errors()).throw_if_any();
}

}  // namespace palpable
