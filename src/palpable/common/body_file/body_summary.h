/// @file
/// What a person wants to know first of a body file.
#pragma once

#include "palpable/common/body_file/touch_file.h"

#include <cstdint>
#include <string>

namespace palpable {

/// Three lines, each with its end:
///
///     body:     bunny, to be pressed anywhere, several touches at a time; 150.0 x 115.9 x 148.7
///               mm; neo-hookean, Young's modulus 60 kPa, Poisson's ratio 0.4          (one line)
///     accuracy: touches: displacement off by 3 % (9 %), force off by 4 % (6 %), stress off by 5 %
///               (7 %) in the median (worst) of 3 against full finite elements; ...    (one line)
///     speed:    0.035 ms to evaluate displacement and stress of the whole skin; 12.3 MB file
///
/// The first line ends with what is missing where the body's bake has not ended.
/// Where no touches were compared, the second line has the errors of the reduced model alone.
///
/// @param evaluation_ms  measured time of one evaluation, ms
/// @param bytes          size of the file
[[nodiscard]] std::string body_summary(const BodyAndTouch& content, double evaluation_ms,
                                       std::uintmax_t bytes);

}  // namespace palpable
