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
///     accuracy: of touches, how far displacement, force and stress are off against full finite
///               elements, if that was measured; of the reduced model, its errors
///     speed:    0.035 ms to evaluate displacement and stress of the whole skin; 12.3 MB file
///
/// @param evaluation_ms  measured time of one evaluation, ms
/// @param bytes          size of the file
[[nodiscard]] std::string body_summary(const BodyAndTouch& content, double evaluation_ms,
                                       std::uintmax_t bytes);

}  // namespace palpable
