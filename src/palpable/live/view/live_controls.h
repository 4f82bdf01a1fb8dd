/// @file
/// The state that the user of a live run's window can switch, by keys or by the panel
/// (live_panel.h). Does not depend on a window: events are passed in, so that a test can be the
/// user.
#pragma once

#include "palpable/live/render/window_events.h"
#include "palpable/live/view/scene_show.h"
#include "palpable/live/view/show_names.h"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// The kind of picture that is shown.
enum class LiveView {
  kCamera,   ///< the camera's picture with the bodies
  kDepth,    ///< its depth (sensed_picture.h)
  kMoving,   ///< what moves in it (likewise)
  kSurface,  ///< the surface that contact uses near the bodies, from outside (surface_picture.h)
  kMap       ///< the room from outside (map_picture.h)
};

class LiveControls;

/// A key and its effect.
struct LiveKey {
  const char* key;
  const char* meaning;           ///< in a word or two
  int code;                      ///< as WindowEvent::key; 0: the row stands for several keys
  void (*press)(LiveControls&);  ///< null likewise
};

/// A parameter of a body that the user may set during the run (ReducedBody::further).
struct LiveParameter {
  int body = 0;
  std::string name;
  double low = 0, high = 1;  ///< bounds for which the body was baked
  double value = 0;

  friend bool operator==(const LiveParameter&, const LiveParameter&) = default;
};

/// Requests of the user that change the run itself, not only the picture.
struct LiveWishes {
  /// The position at which a body is to stand: px of the camera's picture.
  std::optional<Eigen::Vector2d> place = {};
  bool anew = false;        ///< begin the run anew with the next frame
  bool recording = false;   ///< begin a recording, or end the present one
  bool parameters = false;  ///< apply the values of LiveControls::parameters

  /// True if a request can only be fulfilled together with the next frame of the camera.
  [[nodiscard]] bool of_frame() const { return place || anew || parameters; }
};

/// The state of the controls.
class LiveControls {
 public:
  /// @param view, show  at the start, and after R
  /// @param bodies      number of bodies
  LiveControls(LiveView view, const SceneShow& show, int bodies);

  void handle(const WindowEvent& event);

  /// The effects of keys, for the panel. next_...() switch to the next value, and from the last one
  /// to the first.
  void next_field();
  void next_occlusion();
  void next_body();
  void reset();
  /// Advances by one frame if paused; pauses otherwise.
  void step();
  /// Makes the next click into the picture place a body; called again, cancels that.
  void begin_placing();
  void begin_anew();

  [[nodiscard]] int body_count() const { return bodies_; }
  /// The list of keys, for the help.
  [[nodiscard]] static std::span<const LiveKey> keys();

  LiveView view;
  SceneShow show;
  int body = -1;  ///< the one to be placed, whose touches are listed; -1: all
  bool paused = false;
  bool step_wanted = false;     ///< reset by the caller that fulfils it
  bool picture_wanted = false;  ///< likewise
  bool panel_shown = true;
  bool help_shown = false;
  bool ended = false;

  /// Whether the run itself may be changed; if not, `placing` and `wishes` are never set.
  bool run_may_change = false;
  bool placing = false;  ///< the next click places a body
  LiveWishes wishes;     ///< reset by the caller that fulfils them
  std::vector<LiveParameter> parameters = {};

 private:
  // Whether pixels of the picture are pixels of the camera.
  [[nodiscard]] bool shows_camera() const;

  LiveView first_view_;
  SceneShow first_show_;
  int bodies_;
};

/// Names of the views, in their order.
inline constexpr std::array<const char*, 5> kViewNames{"camera", "depth", "moving", "surface",
                                                       "map"};

}  // namespace palpable
