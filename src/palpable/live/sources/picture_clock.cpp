#include "palpable/live/sources/picture_clock.h"

#include <fmt/core.h>

#include <cmath>

namespace palpable {

void PictureClock::start(double now) {
  *this = {};
  start_ = now;
}

void PictureClock::add(const PictureStamp& picture) {
  trouble_.clear();
  time_ = picture.arrival;
  if (picture.stamp <= 0) return;
  if (!knows_offset_) {
    knows_offset_ = true;
    offset_ = picture.is_system_clock ? 0 : picture.arrival - picture.stamp;
  }
  const double time = picture.stamp + offset_;
  if (time < start_ - kSlack || time > picture.arrival + kSlack) {
    add_odd(picture, start_ - time);
    return;
  }
  odd_row_ = odd_together_ = 0;
  if (picture.stamp > last_stamp_) time_ = time;
  last_stamp_ = picture.stamp;
}

void PictureClock::add_odd(const PictureStamp& picture, double seconds_before_start) {
  const double offset = picture.arrival - picture.stamp;
  const bool together =
      odd_together_ > 0 && picture.stamp > odd_stamp_ && std::abs(offset - odd_offset_) <= kSlack;
  odd_together_ = together ? odd_together_ + 1 : 1;
  odd_stamp_ = picture.stamp;
  odd_offset_ = offset;
  ++odd_row_;
  if (odd_together_ >= kSameClock) {
    offset_ = offset;
    last_stamp_ = picture.stamp;
    odd_row_ = odd_together_ = 0;
    return;
  }
  if (odd_row_ >= kSameClock) return;
  trouble_ = seconds_before_start > 0
                 ? fmt::format("its time stamp is {:.3f} s before the start of the stream",
                               seconds_before_start)
                 : fmt::format("its time stamp is {:.3f} s after its arrival",
                               picture.stamp + offset_ - picture.arrival);
}

}  // namespace palpable
