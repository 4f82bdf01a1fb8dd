// Turns a stereo pair to depth: opens a folder of images and their calibration, prints the median
// distance of what its first frame shows.
//
//     read_depth out/demo/clip/frames 0.6       # checks it, too: within 4 % of 0.6 m

#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/sources/folder_source.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <vector>

int main(int argc, char** argv) try {
  using namespace palpable;
  if (argc < 2 || argc > 3) throw Error("usage: read_depth FOLDER [EXPECTED_M]");
  const std::unique_ptr<FrameSource> source = value_or_throw(open_folder(argv[1]));
  DepthCamera camera = value_or_throw(DepthCamera::make(source->format()));
  Frame frame;
  if (source->next(frame) != FrameStatus::kFrame) throw Error(source->last_trouble());

  SeenFrame seen;
  camera.see(frame, seen);
  std::vector<double> known;  // Z in m; NaN is where it is not known
  for (const float Z : seen.depth) {
    if (!std::isnan(Z)) known.push_back(static_cast<double>(Z));
  }
  if (known.empty()) throw Error("no depth is known");
  const double median = percentile(known, 0.5);
  std::printf("%.3f m\n", median);

  if (argc < 3) return 0;
  const double expected = std::atof(argv[2]);
  return std::abs(median - expected) <= 0.04 * expected ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "read_depth: %s\n", error.what());
  return 1;
}
