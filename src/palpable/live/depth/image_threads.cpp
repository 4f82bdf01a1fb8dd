#include "palpable/live/depth/image_threads.h"

#include "palpable/common/base/contract.h"

#include <opencv2/core/utility.hpp>

namespace palpable {

void use_image_threads(int threads) {
  PALPABLE_EXPECT(threads >= 1, "somebody has to do the work");
  cv::setNumThreads(threads);
}

}  // namespace palpable
