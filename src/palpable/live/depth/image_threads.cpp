#include "palpable/live/depth/image_threads.h"

#include "palpable/common/base/contract.h"

#include <opencv2/core/utility.hpp>

namespace palpable {

void use_image_threads(int threads) {
  PALPABLE_EXPECT(threads >= 1, "there is at least one thread");
  cv::setNumThreads(threads);
}

}  // namespace palpable
