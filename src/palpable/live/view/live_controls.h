/// @file
/// What the user of a live run's window may switch, and what the keys mean. The panel
/// (live_panel.h) switches the same. Knows no window: events come in, so that a test can be the
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

/// What is looked at.
enum class LiveView {
  kCamera,   ///< what the camera sees, with the bodies
  kDepth,    ///< how far away it is (sensed_picture.h)
  kMoving,   ///< what of it moves (likewise)
  kSurface,  ///< what contact knows near the bodies, from outside (surface_picture.h)
  kMap       ///< the room from outside (map_picture.h)
};

/// A key, and what it does, in a word or two.
struct KeyMeaning {
  const char* key;
  const char* meaning;
};

/// A parameter of a body that the user may set while the run goes on (ReducedBody::further).
struct LiveParameter {
  int body = 0;
  std::string name;
  double low = 0, high = 1;  ///< between which the body was baked
  double value = 0;

  friend bool operator==(const LiveParameter&, const LiveParameter&) = default;
};

/// What the user has asked for that changes the run itself, and the picture only in the end.
struct LiveWishes {
  /// Where a body is to stand: px of the camera's picture.
  std::optional<Eigen::Vector2d> place = {};
  bool anew = false;        ///< as if the run began with the next frame
  bool recording = false;   ///< to begin or to end one
  bool parameters = false;  ///< to have the values of LiveControls::parameters

  /// Whether there is one that the next frame is needed for.
  [[nodiscard]] bool of_frame() const { return place || anew || parameters; }
};

class LiveControls {
 public:
  /// @param view, show  to begin with, and to return to with R
  /// @param bodies      how many there are
  LiveControls(LiveView view, const SceneShow& show, int bodies);

  void handle(const WindowEvent& event);

  /// The same by the panel. The next one of the values comes after each, and the first after the
  /// last one.
  void next_field();
  void next_occlusion();
  void next_body();
  void reset();
  /// From a pause on by one frame; begins a pause otherwise.
  void step();
  /// The next click into the picture says where a body stands; or no longer.
  void begin_placing();
  void begin_anew();

  [[nodiscard]] int body_count() const { return bodies_; }
  /// What the keys do, for the help.
  [[nodiscard]] static std::span<const KeyMeaning> keys();

  LiveView view;
  SceneShow show;
  int body = -1;  ///< which is placed, and whose touches are listed; -1: all
  bool paused = false;
  bool step_wanted = false;     ///< the reader resets it
  bool picture_wanted = false;  ///< likewise
  bool panel_shown = true;
  bool help_shown = false;
  bool ended = false;

  /// Whether the run itself may be changed: without it the rest stays as it is.
  bool run_may_change = false;
  bool placing = false;
  LiveWishes wishes;  ///< the reader resets them
  std::vector<LiveParameter> parameters = {};

 private:
  // Whether the picture has the camera's pixels.
  [[nodiscard]] bool shows_camera() const;

  LiveView first_view_;
  SceneShow first_show_;
  int bodies_;
};

/// Names of the views, in their order.
inline constexpr std::array<const char*, 5> kViewNames{"camera", "depth", "moving", "surface",
                                                       "map"};

}  // namespace palpable
