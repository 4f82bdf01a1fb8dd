#include "palpable/live/play/things_show.h"

#include "palpable/common/base/error.h"
#include "palpable/live/sources/wall_clock.h"
#include "palpable/live/view/show_names.h"

#include <utility>

namespace palpable {
namespace {

constexpr PictureSize kSize{1280, 720};

}  // namespace

ThingsShow::ThingsShow(const PlayOptions& options, std::vector<ThingsPicture::Body> bodies,
                       double scale, std::function<std::string(const ColorImage&)> keep)
    : keep_(std::move(keep)) {
  if (options.window) {
    window_.emplace(value_or_throw(Window::open("palpable", kSize.width, kSize.height)));
  } else {
    Result<GlContext> context = GlContext::offscreen();
    if (!context.ok()) {
      throw Error(context.problem().message + "; --write=-film plays without a picture");
    }
    offscreen_.emplace(std::move(context).value());
  }
  picture_.emplace(std::move(bodies), kSize, scale);
  picture_->colors = value_named<ColorScale>(options.colors, kColorScaleNames);
  picture_->blended = !options.opaque;
  controls_ = ViewControls(picture_->camera);
}

const ColorImage& ThingsShow::draw(const Scene& scene, std::span<const Capsule> things) {
  if (!window_) return picture_->draw(scene, things);
  picture_->camera = controls_.camera;
  picture_->legend = controls_.legend_shown;
  const ColorImage& picture = picture_->draw(scene, things);
  window_->show(picture);
  if (std::exchange(controls_.picture_wanted, false) && keep_) keep_(picture);
  return picture;
}

bool ThingsShow::handle_events() {
  if (!window_) return false;
  const auto on_body = [](double, double) -> std::optional<int> { return std::nullopt; };
  bool changed = false;
  for (const WindowEvent& event : window_->events()) {
    controls_.handle(event, system_clock().now(), on_body);
    changed = true;
  }
  return changed && !ended();
}

void ThingsShow::throw_gl_errors() const {
  (window_ ? window_->gl_errors() : offscreen_->errors()).throw_if_any();
}

}  // namespace palpable
