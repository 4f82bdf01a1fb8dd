#include "palpable/view/scene_painter.h"

#include "palpable/base/error.h"
#include "palpable/base/stage_clock.h"
#include "palpable/view/stress_scale.h"

#include <fmt/core.h>

namespace palpable {

ScenePainter::ScenePainter(const ScenePainterSettings& settings, const FrameLoop& loop)
    : views_(stress_scale(loop.session)),
      scale_(stress_scale(loop.session)),
      masks_(settings.masks),
      shown_(settings.show) {
  const PinholeCamera& camera = loop.camera.camera();
  if (settings.window) {
    window_.emplace(value_or_throw(Window::open("Palpable", camera.width, camera.height)));
  } else {
    offscreen_.emplace(value_or_throw(GlContext::offscreen()));
  }
  renderer_.emplace(value_or_throw(SceneRenderer::make()));
  using View = ScenePainterSettings::View;
  if (settings.view == View::kMap) {
    map_ = std::make_unique<MapPicture>(value_or_throw(MapRenderer::make()),
                                        loop.session.world_from_body());
  } else if (settings.view == View::kSurface) {
    surface_ = std::make_unique<SurfacePicture>(value_or_throw(MapRenderer::make()), loop.session);
  }
}

void ScenePainter::draw(DrawnFrame& drawn, const Session& session) {
  if (!window_ && !drawn.in_files && !map_) return;
  const StageTimer timer(drawn.scene.times, "draw");
  const bool masks = masks_ && drawn.in_files;
  SceneView& view = views_.of(drawn.scene, session, shown_);
  const Rigid3& camera_from_body = drawn.scene.bodies.front().camera_from_body;
  light_.see(drawn.scene.seen, camera_from_body);
  view.light = light_in_camera(light_.light(), camera_from_body);
  const bool outside = map_ || surface_;
  if (outside) {  // its own caption says it
    view.legend_title.clear();
    view.caption.clear();
    view.warning.clear();
  }
  renderer_->draw(view, outside ? inside_ : drawn.picture, masks ? &drawn.visible : nullptr,
                  masks ? &drawn.body_depth : nullptr);
  if (surface_) { surface_->draw(drawn.scene, session, scale_, inside_, drawn.picture); }
  if (!map_) return;
  map_->draw(drawn.scene, session, scale_, inside_, drawn.picture);
}

void ScenePainter::show(const ColorImage& picture) {
  if (!window_) return;
  window_->show(picture);
  handle_events();
}

void ScenePainter::handle_events() {
  if (!window_) return;
  for (const WindowEvent& event : window_->events()) {
    ended_ |= event.kind == WindowEvent::Kind::kKey &&
              (event.key == WindowEvent::kEscape || event.key == 'Q');
    if (map_) map_->handle(event);
    if (surface_) surface_->handle(event);
  }
  ended_ |= window_->closed();
}

void ScenePainter::throw_gl_errors() const {
  (window_ ? window_->gl_errors() : offscreen_->errors()).throw_if_any();
}

}  // namespace palpable
