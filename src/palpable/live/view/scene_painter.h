/// @file
/// Draws a session's scenes: the camera's picture with the body in it, the sensed depth or motion,
/// the room from outside, or the surface that contact uses near the body. Optionally in a window
/// with a panel.
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
  bool window = false;                ///< show the pictures in a window; else draw off screen
  LiveView view = LiveView::kCamera;  ///< at the start
  SceneShow show = {};                ///< at the start
  bool paused = false;  ///< pause at the first scene until the user of the window continues
  bool masks = true;    ///< also fill DrawnFrame::visible and body_depth, which costs a read-back
  /// Whether the user of the window may change the run itself (LiveControls::wishes, which the
  /// caller must then fulfil).
  bool run_may_change = false;
  /// Views to be shown side by side in one picture; empty: `view` alone. Not in a window.
  std::vector<Tile> tiles = {};
  /// For Tile::kTruth: returns the true depth of the frame with this number, or nothing where it is
  /// not known.
  std::function<std::optional<DepthImage>(int number)> true_depth = {};
  /// Called with the present picture when the user of the window wants to keep it; returns a line
  /// about the result for the panel.
  std::function<std::string(const ColorImage&)> keep_picture = {};
};

/// Draws the scenes of one frame loop, in their order. Main thread only.
class ScenePainter {
 public:
  /// @param loop  must outlive this object and keep its address
  /// @throws Error when there is no OpenGL context, no display for a window, or a shader does not
  ///         compile
  ScenePainter(const ScenePainterSettings& settings, const FrameLoop& loop);
  ScenePainter(const ScenePainter&) = delete;  // the window's panel holds its address
  ScenePainter& operator=(const ScenePainter&) = delete;

  /// Fills in everything of `drawn` except the scores; the time is added to the stage "draw".
  /// `visible` and `body_depth` are left unchanged without masks, and for frames that are not
  /// in_files. A frame that is neither written to files nor shown in the window is not drawn.
  /// @param wanted    whether anybody wants pictures of frames that are in_files
  /// @param for_page  whether a page wants it, even if it is not in_files
  /// @return whether it was drawn
  bool draw(DrawnFrame& drawn, const Session& session, bool wanted = true, bool for_page = false);

  /// Shows the picture drawn last in the window, unless the user has paused it, and handles the
  /// user's input. Does nothing without a window.
  void show(const ColorImage& picture);

  /// Handles input of mouse and keyboard: turns the views from outside, switches what is shown, and
  /// notes whether the user wants to quit. Draws the held scene again if needed.
  /// @param wait  s, the longest time to wait for input
  void handle_events(double wait = 0);

  /// Whether the user has paused, so that the window holds one scene. The caller should then stop
  /// reading a recording and call handle_events(); a camera continues, and the next step shows its
  /// newest frame.
  [[nodiscard]] bool holds() const {
    return held_ && controls_.paused && !controls_.step_wanted && !ended_;
  }

  /// Whether the user has closed the window or pressed Escape or Q.
  [[nodiscard]] bool ended() const { return ended_; }

  /// The extras that the next scenes must have (Session::keep) because they are painted, or may be
  /// painted while the window holds one of them.
  [[nodiscard]] SceneExtras wants() const;

  /// The state of the controls. With run_may_change, `wishes` holds what the user wants changed in
  /// the run; the caller resets a wish that it has fulfilled.
  [[nodiscard]] LiveControls& controls() { return controls_; }
  /// The panel, on which the caller can write a note.
  [[nodiscard]] LivePanel& panel() { return panel_; }
  /// The scene that the window shows while it is paused; else null.
  [[nodiscard]] const Scene* held() const { return held_ ? &*held_ : nullptr; }
  /// Its picture; empty without held().
  [[nodiscard]] const ColorImage& held_picture() const { return held_picture_; }

  /// To be called after the loop's session was replaced by another one with the same bodies, whose
  /// poses and parameters may differ.
  void begin_anew();
  /// Paints the window again with the panel's present content, if it is paused.
  void refresh_panel();
  /// Takes over the parameters of the session's bodies into the panel.
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
  std::unique_ptr<MapPicture> map_;          // null if this view is never shown
  std::unique_ptr<SurfacePicture> surface_;  // likewise
  double scale_;                             // Pa, top of the stress's colours
  SceneViews views_;
  LightEstimator light_;  // in the first body's frame
  ColorImage inside_;     // the camera's picture, for the inset of another view
  bool masks_;
  std::vector<Tile> tiles_;
  std::function<std::optional<DepthImage>(int)> true_depth_;
  ColorImage seen_, tile_;  // of draw_tiles()
  std::function<std::string(const ColorImage&)> keep_picture_;
  LiveControls controls_;
  LivePanel panel_;
  bool drawn_for_window_ = false;  // whether the picture drawn last is for the window
  std::optional<Scene> held_;      // the scene in the window while the user has paused
  ColorImage held_picture_;
  LiveView held_view_ = LiveView::kCamera;  // of held_picture_
  SceneShow held_show_;                     // likewise
  bool ended_ = false;
};

}  // namespace palpable
