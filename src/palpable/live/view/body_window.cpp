#include "palpable/live/view/body_window.h"

#include "palpable/live/view/panel_parts.h"
#include "palpable/live/view/show_names.h"
#include "palpable/live/view/view_controls.h"

#include <chrono>
#include <imgui.h>
#include <optional>

namespace palpable {
namespace {

// Sets what the scene shows, and the caption below it: the press, and the keys.
void write_caption(const ViewControls& controls, double level, StudioScene& scene) {
  scene.field = controls.field;
  scene.component = controls.component;
  scene.sites_shown = controls.sites_shown;
  scene.legend_shown = controls.legend_shown && level > 0;
  scene.caption = {level > 0 ? scene.reading() : scene.title()};
  if (!controls.note.empty()) scene.caption.push_back(controls.note);
  if (!controls.help_shown) return;
  scene.caption.insert(scene.caption.end(), ViewControls::help().begin(),
                       ViewControls::help().end());
}

// Lays out the panel. @return whether something was switched
bool lay_out(ViewControls& controls) {
  if (!controls.panel_shown) return false;
  bool switched = false;
  begin_panel("view", {0, 0});
  switched |= choice("Painted", kFieldNames, controls.field);
  if (controls.field == SceneShow::Field::kComponent) {
    switched |= choice("Component", kComponentNames, controls.component);
  }
  switched |= ImGui::Checkbox("sites", &controls.sites_shown);
  switched |= ImGui::Checkbox("legend", &controls.legend_shown);
  switched |= ImGui::Checkbox("help", &controls.help_shown);
  if (button_in_row("Picture", 2)) controls.picture_wanted = switched = true;
  ImGui::SameLine();
  if (button_in_row("Reset", 2)) {
    controls.reset();
    switched = true;
  }
  ImGui::End();
  return switched;
}

// Presses the body by the mouse: with a finger anywhere, or at a site.
class MousePress {
 public:
  // @param from_site  whether a site is pressed at the start
  MousePress(const std::shared_ptr<const TouchableBody>& body, bool from_site, StudioScene& scene)
      : scene_(scene) {
    if (!body->touch) return;
    finger_.emplace(body);
    if (!from_site) scene.show_finger(&*finger_);
  }

  // As ViewControls::SiteAt.
  std::optional<int> begin_at(double x_px, double y_px) {
    const auto point = scene_.point_at(x_px, y_px);
    if (!point) return std::nullopt;
    if (!finger_) return scene_.pressed().nearest_site(*point);
    place_ = finger_->place_at(*point);
    scene_.show_finger(&*finger_);
    return 0;
  }

  void press(int site, double level) {
    if (!place_) {
      scene_.pressed().press(site, level);
    } else if (level > 0) {
      finger_->press(*place_, level);
    } else {
      finger_->rest();
    }
  }

  // Whether the body shown has not yet reached the level.
  [[nodiscard]] bool is_behind(double level) const {
    return level != (place_ ? finger_->level() : scene_.pressed().level()) ||
           (place_ && finger_->moving());
  }

 private:
  StudioScene& scene_;
  std::optional<FingerPress> finger_;
  std::optional<FingerPress::Place> place_;  // of the finger; nothing: a site is pressed
};

}  // namespace

void show_body(Window& window, const std::shared_ptr<const TouchableBody>& body,
               const BodyWindowSettings& settings,
               const std::function<std::string(const ColorImage&)>& keep_picture) {
  StudioScene scene(body->body, settings.size);
  scene.colors = settings.colors;
  ViewControls controls(usual_camera(body->body, settings.size.aspect()), settings.paint);
  MousePress mouse(body, settings.site >= 0, scene);
  if (settings.site >= 0) {
    controls.keep(settings.site, settings.level);
    controls.camera =
        camera_towards(body->body.sites[static_cast<std::size_t>(settings.site)], controls.camera);
  }
  const auto opened = std::chrono::steady_clock::now();
  const auto now = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - opened).count();
  };
  const auto site_at = [&](double x_px, double y_px) { return mouse.begin_at(x_px, y_px); };
  bool changed = true;
  window.set_panel([&] { changed |= lay_out(controls); });
  while (!controls.quit && !window.closed()) {
    const bool busy = changed || controls.moving(now()) || mouse.is_behind(controls.level(now()));
    for (const WindowEvent& event : window.events(busy ? 0.0 : 0.05)) {
      controls.handle(event, now(), site_at);
      changed = true;
    }
    if (settings.close_after > 0 && now() > settings.close_after) controls.quit = true;
    const double level = controls.level(now());
    if (!changed && !mouse.is_behind(level)) continue;
    mouse.press(controls.site(), level);
    write_caption(controls, level, scene);
    const ColorImage& picture = scene.draw(controls.camera);
    changed = false;
    window.show(picture);
    if (controls.picture_wanted) {
      controls.picture_wanted = false;
      controls.note = keep_picture(picture);
      changed = true;
    }
  }
  window.set_panel({});
  window.gl_errors().throw_if_any();
}

}  // namespace palpable
