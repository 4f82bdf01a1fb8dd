/// @file
/// Decides from the adjustments of keyframes whether the rig measures all disparities with a
/// constant error, as when one eye has turned since the calibration. 1 px is an eighth of the depth
/// at 8 px of disparity, and 1 % at 100 px.
#pragma once

#include <optional>

namespace palpable {

class DisparityWatch {
 public:
  /// Adds the estimate of one adjustment (BundleResult). An error is believed when two adjustments
  /// in turn differ from the one in use to the same side, each by 0.4 px and 4 sigma, or 0.2 px and
  /// 2.5 sigma once the calibration is known to be wrong. So a rig whose calibration is right to
  /// the 0.1 px that can be expected is never changed. Errors of more than 4 px are not believed.
  /// @param estimate     px
  /// @param information  1/px^2, inverse variance; 0: the adjustment did not determine it
  /// @param in_use       px, the error that measured disparities were assumed to have
  /// @return px, the error to be assumed from now on; nothing: as before
  std::optional<double> add(double estimate, double information, double in_use);

 private:
  int last_side_ = 0;  // of the last estimate: -1, 1; 0: it did not differ
};

}  // namespace palpable
