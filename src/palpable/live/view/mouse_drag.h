/// @file
/// Motion of the mouse while a button is held.
#pragma once

#include "palpable/live/render/window_events.h"

#include <optional>

namespace palpable {

/// Any button drags. While several are held, the first one counts until it is released.
class MouseDrag {
 public:
  struct Way {
    double x_px = 0, y_px = 0;
  };

  /// To be called with every event. @return the displacement (px) by this event while a button is
  /// held
  std::optional<Way> follow(const WindowEvent& event) {
    using Kind = WindowEvent::Kind;
    if (event.kind == Kind::kPress && !button_) button_ = event.button;
    if (event.kind == Kind::kRelease && event.button == button_) button_.reset();
    const Way way{event.x_px - x_before_, event.y_px - y_before_};
    x_before_ = event.x_px;
    y_before_ = event.y_px;
    if (event.kind != Kind::kMove || !button_) return std::nullopt;
    return way;
  }

 private:
  std::optional<int> button_;  // the one that is held
  double x_before_ = 0, y_before_ = 0;
};

}  // namespace palpable
