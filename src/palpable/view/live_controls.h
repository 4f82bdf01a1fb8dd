/// @file
/// What the user of a live run's window may switch, and what the keys mean. The panel
/// (live_panel.h) switches the same. Knows no window: events come in, so that a test can be the
/// user.
#pragma once

#include "palpable/render/window_events.h"
#include "palpable/view/scene_show.h"
#include "palpable/view/show_names.h"

#include <array>
#include <span>

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

  [[nodiscard]] int body_count() const { return bodies_; }
  /// What the keys do, for the help.
  [[nodiscard]] static std::span<const KeyMeaning> keys();

  LiveView view;
  SceneShow show;
  int body = -1;  ///< whose touches are listed; -1: all
  bool paused = false;
  bool step_wanted = false;     ///< the reader resets it
  bool picture_wanted = false;  ///< likewise
  bool panel_shown = true;
  bool help_shown = false;
  bool ended = false;

 private:
  LiveView first_view_;
  SceneShow first_show_;
  int bodies_;
};

/// Names of the views, in their order.
inline constexpr std::array<const char*, 5> kViewNames{"camera", "depth", "moving", "surface",
                                                       "map"};

}  // namespace palpable
