#include "palpable/desk/score/touch_scores.h"

#include "palpable/common/base/contract.h"
#include "palpable/desk/score/statistics.h"

#include <algorithm>
#include <cstddef>

namespace palpable {
namespace {

std::optional<int> first_of(std::span<const std::uint8_t> touching) {
  const auto at = std::find_if(touching.begin(), touching.end(), [](auto t) { return t != 0; });
  if (at == touching.end()) return std::nullopt;
  return static_cast<int>(at - touching.begin());
}

}  // namespace

TouchScore score_touches(std::span<const std::uint8_t> truth, std::span<const std::uint8_t> found) {
  PALPABLE_EXPECT(truth.size() == found.size(), "one entry per frame in both");
  TouchScore score;
  score.frames = static_cast<int>(truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    score.truly_touching += truth[i] != 0;
    score.found_touching += found[i] != 0;
    score.both += truth[i] != 0 && found[i] != 0;
  }
  const auto first_true = first_of(truth);
  const auto first_found = first_of(found);
  if (first_true && first_found) score.first_touch_delay_frames = *first_found - *first_true;
  score.precision = share_of(score.both, score.found_touching);
  score.recall = share_of(score.both, score.truly_touching);
  return score;
}

std::optional<double> score_sites(std::span<const int> truth, std::span<const int> found) {
  PALPABLE_EXPECT(truth.size() == found.size(), "one entry per frame in both");
  int named = 0;
  int same = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth[i] < 0 || found[i] < 0) continue;
    ++named;
    same += truth[i] == found[i];
  }
  return share_of(same, named);
}

std::optional<double> touch_recall(std::span<const TrueReach> truth,
                                   std::span<const std::uint8_t> felt) {
  PALPABLE_EXPECT(truth.size() == felt.size(), "one entry per frame in both");
  int to_be_felt = 0;
  int found = 0;
  for (std::size_t f = 0; f < truth.size(); ++f) {
    if (truth[f].depth <= kFeltFrom || truth[f].seen_share < kSeenFrom) continue;
    ++to_be_felt;
    found += felt[f] != 0;
  }
  return share_of(found, to_be_felt);
}

std::optional<double> touch_false(std::span<const std::optional<double>> gaps,
                                  std::span<const std::uint8_t> felt) {
  PALPABLE_EXPECT(gaps.size() == felt.size(), "one entry per frame in both");
  int all = 0;
  int wrong = 0;
  for (std::size_t f = 0; f < gaps.size(); ++f) {
    if (felt[f] == 0) continue;
    if (!gaps[f]) return std::nullopt;
    ++all;
    wrong += *gaps[f] > kNothingNear;
  }
  return share_of(wrong, all);
}

}  // namespace palpable
