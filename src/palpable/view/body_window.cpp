#include "palpable/view/body_window.h"

#include "palpable/view/view_controls.h"

#include <chrono>
#include <optional>

namespace palpable {
namespace {

// What is said under the picture: the press, and the keys.
void write_caption(const ViewControls& controls, double level, StudioScene& scene) {
  scene.sites_shown = controls.sites_shown;
  scene.legend_shown = controls.legend_shown && level > 0;
  scene.caption = {level > 0 ? scene.reading() : scene.title()};
  if (!controls.note.empty()) scene.caption.push_back(controls.note);
  if (!controls.help_shown) return;
  scene.caption.insert(scene.caption.end(), ViewControls::help().begin(),
                       ViewControls::help().end());
}

}  // namespace

void show_body(Window& window, const ReducedBody& body, const BodyWindowSettings& settings,
               const std::function<std::string(const ColorImage&)>& keep_picture) {
  StudioScene scene(body, settings.size);
  ViewControls controls(usual_camera(body, settings.size.aspect()));
  if (settings.site >= 0) {
    controls.keep(settings.site, settings.level);
    controls.camera = camera_towards(body.sites[settings.site], controls.camera);
  }
  const auto opened = std::chrono::steady_clock::now();
  const auto now = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - opened).count();
  };
  const auto site_at = [&](double x_px, double y_px) -> std::optional<int> {
    const auto point = scene.point_at(x_px, y_px);
    if (!point) return std::nullopt;
    return scene.pressed().nearest_site(*point);
  };
  bool changed = true;
  while (!controls.quit && !window.closed()) {
    const bool busy = changed || controls.moving(now());
    for (const WindowEvent& event : window.events(busy ? 0.0 : 0.05)) {
      controls.handle(event, now(), site_at);
      changed = true;
    }
    if (settings.close_after > 0 && now() > settings.close_after) controls.quit = true;
    const double level = controls.level(now());
    if (!changed && level == scene.pressed().level()) continue;
    scene.pressed().press(controls.site(), level);
    write_caption(controls, level, scene);
    const ColorImage& picture = scene.draw(controls.camera);
    window.show(picture);
    changed = false;
    if (controls.picture_wanted) {
      controls.picture_wanted = false;
      controls.note = keep_picture(picture);
      changed = true;
    }
  }
  window.gl_errors().throw_if_any();
}

}  // namespace palpable
