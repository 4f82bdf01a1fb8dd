#include "palpable/live/render/window_events.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpable {

std::optional<PicturePlace> place_picture(int picture_width, int picture_height, int window_width,
                                          int window_height) {
  PALPABLE_EXPECT(picture_width > 0 && picture_height > 0, "a picture has pixels");
  if (window_width <= 0 || window_height <= 0) return std::nullopt;
  const double scale = std::min(static_cast<double>(window_width) / picture_width,
                                static_cast<double>(window_height) / picture_height);
  PicturePlace at;
  at.width = std::max(static_cast<int>(std::lround(picture_width * scale)), 1);
  at.height = std::max(static_cast<int>(std::lround(picture_height * scale)), 1);
  at.x = (window_width - at.width) / 2;
  at.y = (window_height - at.height) / 2;
  return at;
}

void WindowEventLog::resized(int width, int height) {
  window_width_ = width;
  window_height_ = height;
  place();
}

void WindowEventLog::shows(int picture_width, int picture_height) {
  picture_width_ = picture_width;
  picture_height_ = picture_height;
  place();
}

void WindowEventLog::place() {
  const auto at = place_picture(picture_width_, picture_height_, window_width_, window_height_);
  if (at) place_ = *at;
}

void WindowEventLog::moved(double x, double y) {
  x_ = x;
  y_ = y;
  add({.kind = WindowEvent::Kind::kMove});
}

void WindowEventLog::button(int button, bool down) {
  WindowEvent event;
  event.kind = down ? WindowEvent::Kind::kPress : WindowEvent::Kind::kRelease;
  event.button = button;
  add(event);
}

void WindowEventLog::wheel(double notches) {
  WindowEvent event;
  event.kind = WindowEvent::Kind::kWheel;
  event.wheel = notches;
  add(event);
}

void WindowEventLog::key(int key) {
  WindowEvent event;
  event.kind = WindowEvent::Kind::kKey;
  event.key = key;
  add(event);
}

void WindowEventLog::add(WindowEvent event) {
  event.x_px = (x_ - place_.x) * picture_width_ / place_.width - 0.5;
  event.y_px = (y_ - place_.y) * picture_height_ / place_.height - 0.5;
  event.window_x = x_;
  event.window_y = y_;
  gathered_.push_back(event);
}

std::span<const WindowEvent> WindowEventLog::take() {
  std::swap(gathered_, handed_out_);
  gathered_.clear();
  return handed_out_;
}

}  // namespace palpable
