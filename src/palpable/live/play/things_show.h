/// @file
/// The picture of a run without a camera (view/things_picture.h), in a window or for its film.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/image.h"
#include "palpable/live/play/live_play.h"
#include "palpable/live/render/gl_context.h"
#include "palpable/live/render/window.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/view/things_picture.h"
#include "palpable/live/view/view_controls.h"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// Main thread only. In the window any button of the mouse turns the view and the wheel zooms; L
/// shows and hides the legend, R resets the view, P keeps a picture, Escape and Q end the run. The
/// other keys of ViewControls do nothing here.
class ThingsShow {
 public:
  /// @param options  of these window, colors and opaque
  /// @param keep     called with the picture that the user wants to keep; returns a line about it
  /// @throws Error when there is no OpenGL, or no screen for a window
  ThingsShow(const PlayOptions& options, std::vector<ThingsPicture::Body> bodies, double scale,
             std::function<std::string(const ColorImage&)> keep);
  ThingsShow(const ThingsShow&) = delete;  // what it draws with belongs to its context
  ThingsShow& operator=(const ThingsShow&) = delete;

  /// Draws a scene as the user has turned it, and shows it if there is a window.
  /// @return valid until the next call
  const ColorImage& draw(const Scene& scene, std::span<const Capsule> things);

  /// Handles the input of a window. @return whether the next picture will be another one or is to
  /// be kept: then the caller draws soon
  [[nodiscard]] bool handle_events();

  [[nodiscard]] bool in_window() const { return window_.has_value(); }

  /// Whether the user has closed the window or pressed Escape or Q.
  [[nodiscard]] bool ended() const { return controls_.quit || (window_ && window_->closed()); }

  /// @throws Error when OpenGL reported errors
  void throw_gl_errors() const;

 private:
  std::optional<GlContext> offscreen_;
  std::optional<Window> window_;
  std::optional<ThingsPicture> picture_;
  ViewControls controls_{OrbitCamera{}};
  std::function<std::string(const ColorImage&)> keep_;
};

}  // namespace palpable
