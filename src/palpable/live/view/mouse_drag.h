/// @file
/// What a mouse drags in a picture.
#pragma once

#include "palpable/live/render/window_events.h"

#include <optional>

namespace palpable {

/// Any button drags; of several the first one, until it is released.
class MouseDrag {
 public:
  struct Way {
    double x_px = 0, y_px = 0;
  };

  /// To be told of every event. @return how far a held button has moved with this one
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
  std::optional<int> button_;  // that is held
  double x_before_ = 0, y_before_ = 0;
};

}  // namespace palpable
