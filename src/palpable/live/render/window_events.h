/// @file
/// What mouse and keyboard did in a window, as plain data. Knows no window: what the operating
/// system reports comes in, so that a test can be the operating system.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// One event of mouse or keyboard. Positions are px of the picture last shown ((0, 0) is the centre
/// of its first pixel), whatever the size of the window; they are where the pointer was when it
/// happened, beside the picture too.
struct WindowEvent {
  enum class Kind { kPress, kRelease, kMove, kWheel, kKey };
  Kind kind = Kind::kMove;
  double x_px = 0;
  double y_px = 0;
  double window_x = 0, window_y = 0;  ///< px of the window, from its upper left corner
  int button = 0;                     ///< kPress, kRelease: 0 left, 1 right, 2 middle
  double wheel = 0;                   ///< kWheel: notches, positive away from the user
  int key = 0;                        ///< kKey: 'A' .. 'Z', '0' .. '9', ' ' or a value below
  static constexpr int kEscape = 256;
};

/// A picture's rectangle in a window, px; x and y are of the corner nearest to the window's (0, 0).
struct PicturePlace {
  int x = 0, y = 0, width = 1, height = 1;
};

/// As large as the window allows, proportions kept, in its middle. Nothing when the window has no
/// area, as while it is minimised.
/// @param picture_width, picture_height  > 0
[[nodiscard]] std::optional<PicturePlace> place_picture(int picture_width, int picture_height,
                                                        int window_width, int window_height);

/// Gathers events between two frames. A button's report has no position: it happened where the
/// pointer was last reported. (Asking where the pointer is now, as the reports are read, would take
/// a press and a drag within one frame for a press at the end of the drag.)
class WindowEventLog {
 public:
  /// The window's size, px of the positions reported to moved(). Of a size without area the places
  /// before it stay.
  void resized(int width, int height);
  /// The picture that is shown from now on.
  void shows(int picture_width, int picture_height);

  void moved(double x, double y);
  void button(int button, bool down);
  void wheel(double notches);
  void key(int key);

  /// The events since the last call, in their order; valid until the next call.
  [[nodiscard]] std::span<const WindowEvent> take();
  [[nodiscard]] bool empty() const { return gathered_.empty(); }

 private:
  void add(WindowEvent event);
  void place();

  int window_width_ = 1, window_height_ = 1;
  int picture_width_ = 1, picture_height_ = 1;
  PicturePlace place_;
  double x_ = 0, y_ = 0;  // of the pointer, px of the window
  std::vector<WindowEvent> gathered_, handed_out_;
};

}  // namespace palpable
