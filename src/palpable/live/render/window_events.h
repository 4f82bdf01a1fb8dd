/// @file
/// Events of mouse and keyboard in a window, as plain data. Does not depend on a window: the
/// reports of the operating system are passed in, so that a test can be the operating system.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// One event of mouse or keyboard. Positions are those of the pointer at the event, in px of the
/// picture last shown ((0, 0) is the centre of its first pixel), independently of the window's
/// size; they may lie beside the picture.
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

/// The rectangle of a picture that is shown as large as the window allows, with its proportions
/// kept, in the middle. Nothing when the window has no area, as while it is minimised.
/// @param picture_width, picture_height  > 0
[[nodiscard]] std::optional<PicturePlace> place_picture(int picture_width, int picture_height,
                                                        int window_width, int window_height);

/// Gathers events between two frames. The report of a button has no position; its event gets the
/// position of the pointer that was reported last. (The pointer's position at the time of reading
/// would turn a press and a drag within one frame into a press at the end of the drag.)
class WindowEventLog {
 public:
  /// Sets the window's size, in the px of moved(). After a size without area, positions are
  /// computed with the last size that had one.
  void resized(int width, int height);
  /// Sets the size of the picture that is shown from now on.
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
  double x_ = 0, y_ = 0;  // the pointer's position, px of the window
  std::vector<WindowEvent> gathered_, handed_out_;
};

}  // namespace palpable
