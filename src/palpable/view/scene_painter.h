/// @file
/// A session's scenes, drawn: what its camera sees with the body in it, the room from outside, or
/// what contact knows near the body.
#pragma once

#include "palpable/geometry/image.h"
#include "palpable/render/gl_context.h"
#include "palpable/render/scene_renderer.h"
#include "palpable/render/window.h"
#include "palpable/session/frame_loop.h"
#include "palpable/view/drawn_frame.h"
#include "palpable/view/map_picture.h"
#include "palpable/view/scene_light.h"
#include "palpable/view/scene_picture.h"
#include "palpable/view/scene_show.h"
#include "palpable/view/surface_picture.h"

#include <memory>
#include <optional>

namespace palpable {

struct ScenePainterSettings {
  enum class View {
    kCamera,  ///< what the camera sees
    kMap,     ///< the room from outside (map_picture.h)
    kSurface  ///< what contact knows near the body, from outside (surface_picture.h)
  };
  bool window = false;  ///< also show the pictures in a window; else draw off screen
  View view = View::kCamera;
  SceneShow show = {};  ///< what of a scene is shown to begin with
  bool masks = true;  ///< also fill DrawnFrame::visible and body_depth, which are read back for it
};

/// Draws the scenes of one frame loop, in their order. Main thread only.
class ScenePainter {
 public:
  /// @throws Error when there is no OpenGL context, no display for a window, or a shader does not
  ///         compile
  ScenePainter(const ScenePainterSettings& settings, const FrameLoop& loop);

  /// Fills in what drawing adds to a scene, but for the scores; its time goes to the stage "draw".
  /// Without masks, and for a frame that is in no file, `visible` and `body_depth` stay as they
  /// are. What is in no file and in no window is drawn only where later pictures need it (the map's
  /// path).
  void draw(DrawnFrame& drawn, const Session& session);

  /// Shows a picture in the window, and handles what the user did there; nothing without one.
  void show(const ColorImage& picture);

  /// Turns what is seen from outside as the mouse says, and notes whether the user wants to end.
  void handle_events();

  /// Whether the user has closed the window or pressed Escape or Q.
  [[nodiscard]] bool ended() const { return ended_; }

  /// @throws Error when OpenGL reported errors
  void throw_gl_errors() const;

 private:
  std::optional<GlContext> offscreen_;
  std::optional<Window> window_;
  std::optional<SceneRenderer> renderer_;
  std::unique_ptr<MapPicture> map_;          // if it is to be shown
  std::unique_ptr<SurfacePicture> surface_;  // likewise
  SceneViews views_;
  LightEstimator light_;  // in the first body's frame
  ColorImage inside_;     // what the camera sees, where the picture is another
  double scale_;          // Pa, top of the stress's colours
  bool masks_;
  SceneShow shown_;
  bool ended_ = false;
};

}  // namespace palpable
