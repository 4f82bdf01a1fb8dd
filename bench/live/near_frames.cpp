#include "bench/live/near_frames.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/desk/clip_files/image_files.h"

#include <algorithm>

namespace palpable::app {
namespace {

constexpr int kFrames = 600;

bool shows_near_hand(const DeskTruth& truth) {
  std::vector<double> depths;
  for (int y = 0; y < truth.depth.height(); ++y)
    for (int x = 0; x < truth.depth.width(); ++x)
      if ((truth.labels(x, y) & kMovesLabel) != 0)
        depths.push_back(static_cast<double>(truth.depth(x, y)));
  if (static_cast<double>(depths.size()) < 0.05 * static_cast<double>(truth.depth.size()))
    return false;
  const double median = percentile(depths, 0.5);
  return median >= 0.12 && median <= 0.5;
}

// Whether 1 % of the image or more is nearer than any searched range.
bool has_too_close(const DeskTruth& truth) {
  const auto pixels = std::count_if(truth.depth.begin(), truth.depth.end(),
                                    [](float Z) { return Z > 0 && Z < kTooCloseDepth; });
  return static_cast<double>(pixels) >= 0.01 * static_cast<double>(truth.depth.size());
}

std::vector<int> evenly(const std::vector<int>& numbers, std::size_t most) {
  const std::size_t count = std::min(numbers.size(), most);
  std::vector<int> spread;
  for (std::size_t i = 0; i < count; ++i) spread.push_back(numbers[i * numbers.size() / count]);
  return spread;
}

}  // namespace

NearFrames::NearFrames(const std::filesystem::path& body, std::uint64_t seed,
                       const Progress& progress)
    : NearFrames(value_or_throw(read_pressable_body(body)), seed, progress) {}

NearFrames::NearFrames(const ReducedBody& body, std::uint64_t seed, const Progress& progress)
    : body_name_(body.name),
      sequence_(plan_sequence("press", desk_body(body), kFrames, seed)),
      film_(film_of(sequence_)) {
  DeskTruth truth;
  for (int frame = kFramesWithoutHand; frame < kFrames; frame += kStep) {
    draw_truth(frame, 4, truth);
    if (shows_near_hand(truth)) near_.push_back(frame);
    if (has_too_close(truth)) too_close_.push_back(frame);
    report(progress, {"looking for near frames", frame + 1.0, static_cast<double>(kFrames), ""});
  }
  if (near_.empty()) throw Error("the sequence has no near frame: the body hides the hand");
}

std::vector<int> NearFrames::spread(std::size_t most) const { return evenly(near_, most); }

std::vector<int> NearFrames::spread_too_close(std::size_t most) const {
  return evenly(too_close_, most);
}

void NearFrames::draw_truth(int number, int shrink, DeskTruth& truth) {
  film_.renderer.draw_truth(moment_of(sequence_, number), stereo().camera.scaled_down(shrink),
                            stereo().baseline, truth);
}

void NearFrames::draw(int number, int shrink, RawPair& pair, DeskTruth& truth) {
  film_.renderer.draw(moment_of(sequence_, number), pair);
  draw_truth(number, shrink, truth);
  pair.left = through_jpeg(pair.left);
  pair.right = through_jpeg(pair.right);
}

}  // namespace palpable::app
