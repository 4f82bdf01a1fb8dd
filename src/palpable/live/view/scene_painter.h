/// @file
/// A session's scenes, drawn: what its camera sees with the body in it, what it senses, the room
/// from outside, or what contact knows near the body. In a window with a panel, if it is wanted.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/render/gl_context.h"
#include "palpable/live/render/scene_renderer.h"
#include "palpable/live/render/window.h"
#include "palpable/live/session/frame_loop.h"
#include "palpable/live/view/drawn_frame.h"
#include "palpable/live/view/live_controls.h"
#include "palpable/live/view/live_panel.h"
#include "palpable/live/view/map_picture.h"
#include "palpable/live/view/scene_light.h"
#include "palpable/live/view/scene_picture.h"
#include "palpable/live/view/scene_show.h"
#include "palpable/live/view/surface_picture.h"
#include "palpable/live/view/tiles.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct ScenePainterSettings {
  bool window = false;                ///< also show the pictures in a window; else draw off screen
  LiveView view = LiveView::kCamera;  ///< to begin with
  SceneShow show = {};                ///< what of a scene is shown to begin with
  bool paused = false;  ///< stop at the first scene, until the user of the window goes on
  bool masks = true;  ///< also fill DrawnFrame::visible and body_depth, which are read back for it
  /// Whether the user of the window may change the run itself: who plays it looks at wishes().
  bool run_may_change = false;
  /// Several views in one picture, instead of `view`; none: that one. Not in a window.
  std::vector<Tile> tiles = {};
  /// For Tile::kTruth: the true depth of the frame with this number; nothing: it is not known.
  std::function<std::optional<DepthImage>(int number)> true_depth = {};
  /// Called with the picture that is shown when the user of the window asks to keep it; returns
  /// what became of it, in a line for the panel.
  std::function<std::string(const ColorImage&)> keep_picture = {};
};

/// Draws the scenes of one frame loop, in their order. Main thread only.
class ScenePainter {
 public:
  /// @param loop  outlives this, at its place
  /// @throws Error when there is no OpenGL context, no display for a window, or a shader does not
  ///         compile
  ScenePainter(const ScenePainterSettings& settings, const FrameLoop& loop);
  ScenePainter(const ScenePainter&) = delete;  // the window's panel knows where it is
  ScenePainter& operator=(const ScenePainter&) = delete;

  /// Fills in what drawing adds to a scene, but for the scores; its time goes to the stage "draw".
  /// Without masks, and for a frame that is in no file, `visible` and `body_depth` stay as they
  /// are. What is in no file and not shown in the window is not drawn.
  void draw(DrawnFrame& drawn, const Session& session);

  /// Shows a picture that was just drawn in the window, unless the user has paused it, and handles
  /// what the user did there; nothing without a window.
  void show(const ColorImage& picture);

  /// Does what mouse and keys say: turns what is seen from outside, switches, notes whether the
  /// user wants to end. What is held is drawn again when it changes.
  /// @param wait  s, at most, for something to happen
  void handle_events(double wait = 0);

  /// Whether the user has paused, so that a scene is held in the window. A recording should wait
  /// then, in handle_events(); a camera goes on, and its newest frame is shown at the next step.
  [[nodiscard]] bool holds() const {
    return held_ && controls_.paused && !controls_.step_wanted && !ended_;
  }

  /// Whether the user has closed the window or pressed Escape or Q.
  [[nodiscard]] bool ended() const { return ended_; }

  /// What the scenes to come should have (Session::keep): it is painted, or may be while the window
  /// holds one of them.
  [[nodiscard]] SceneExtras wants() const;

  /// What the user wants changed of the run; with run_may_change alone there is something. Who has
  /// done it resets it.
  [[nodiscard]] LiveControls& controls() { return controls_; }
  /// Says something on the panel.
  [[nodiscard]] LivePanel& panel() { return panel_; }
  /// The scene that the window shows while it is paused; else null.
  [[nodiscard]] const Scene* held() const { return held_ ? &*held_ : nullptr; }

  /// The loop's session is another one from now on, of the same bodies perhaps elsewhere and of
  /// other stiffness.
  void begin_anew();
  /// Paints the window again while it is paused, with what the panel says now.
  void refresh_panel();
  /// Has the panel show the values that the session's bodies have.
  void gather_parameters();

  /// @throws Error when OpenGL reported errors
  void throw_gl_errors() const;

 private:
  void make_outside_views(LiveView view);
  void handle(const WindowEvent& event);
  void draw_look(const Scene& scene, const Session& session, ColorImage& picture,
                 MaskImage* visible, DepthImage* body_depth);
  [[nodiscard]] bool has_tile(Tile tile) const;
  void draw_tiles(DrawnFrame& drawn, const Session& session);
  void draw_held();
  void keep_picture(const ColorImage& picture);

  const Session& session_;
  std::optional<GlContext> offscreen_;
  std::optional<Window> window_;
  std::optional<SceneRenderer> renderer_;
  std::unique_ptr<MapPicture> map_;          // if it may be shown
  std::unique_ptr<SurfacePicture> surface_;  // likewise
  double scale_;                             // Pa, top of the stress's colours
  SceneViews views_;
  LightEstimator light_;  // in the first body's frame
  ColorImage inside_;     // what the camera sees, where the picture is another
  bool masks_;
  std::vector<Tile> tiles_;
  std::function<std::optional<DepthImage>(int)> true_depth_;
  ColorImage seen_, tile_;  // of draw_tiles()
  std::function<std::string(const ColorImage&)> keep_picture_;
  LiveControls controls_;
  LivePanel panel_;
  bool drawn_for_window_ = false;  // the picture drawn last
  std::optional<Scene> held_;      // what the window has shown since the user paused
  ColorImage held_picture_;
  LiveView held_view_ = LiveView::kCamera;  // with which it was drawn,
  SceneShow held_show_;                     // and what of it
  bool ended_ = false;
};

}  // namespace palpable
