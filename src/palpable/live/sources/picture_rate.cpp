#include "palpable/live/sources/picture_rate.h"

#include <algorithm>

namespace palpable {

void PictureRate::add(double time, int number) {
  if (!first_time_) first_time_ = time;
  if (time - *first_time_ < kSettle) return;
  if (last_ && count_ < kIntervals && number > last_->number && time > last_->time) {
    intervals_.at(count_++) = (time - last_->time) / (number - last_->number);
  }
  last_ = Picture{time, number};
}

std::optional<double> PictureRate::rate() const {
  if (count_ < kIntervals) return std::nullopt;
  std::array<double, kIntervals> sorted = intervals_;
  const auto middle = sorted.begin() + kIntervals / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  return 1 / *middle;
}

bool is_far_below(double measured, double wanted) {
  constexpr double kFarBelow = 0.75;
  return measured < kFarBelow * wanted;
}

}  // namespace palpable
