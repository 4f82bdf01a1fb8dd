#include "palpable/live/stereo/stereo_matcher.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/stereo/standing_threads.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <utility>
#include <vector>

namespace palpable {
namespace {

constexpr int kGuardShrink = 4;
constexpr SpeckleLimits kGuardSpeckles{8, 0};
constexpr int kSpeckleStep = kDisparitySteps;  // largest step within a patch: 1 px
constexpr int kGapStep = 2 * kDisparitySteps;

// Memory that is aligned for vectors of any width.
class AlignedBytes {
 public:
  void at_least(std::size_t bytes) {
    if (bytes <= size_) return;
    memory_.reset(static_cast<std::uint8_t*>(::operator new (bytes, std::align_val_t{kAlignment})));
    size_ = bytes;
  }
  [[nodiscard]] std::uint8_t* begin() const { return memory_.get(); }

 private:
  static constexpr std::size_t kAlignment = 64;
  struct Free {
    void operator()(std::uint8_t* p) const { ::operator delete (p, std::align_val_t{kAlignment}); }
  };
  std::unique_ptr<std::uint8_t, Free> memory_;
  std::size_t size_ = 0;
};

// Means of 4 x 4 pixels, rounded.
void shrink(const GrayImage& image, GrayImage& small) {
  constexpr int n = kGuardShrink;
  small.resize(image.width() / n, image.height() / n);
  for (int y = 0; y < small.height(); ++y) {
    std::uint8_t* to = small.row(y);
    const std::uint8_t* rows[n];
    for (int i = 0; i < n; ++i) rows[i] = image.row(n * y + i);
    for (int x = 0; x < small.width(); ++x) {
      int sum = n * n / 2;
      for (const std::uint8_t* row : rows) {
        for (int i = 0; i < n; ++i) sum += row[n * x + i];
      }
      to[x] = static_cast<std::uint8_t>(sum / (n * n));
    }
  }
}

// The images of one pass over a range of disparities.
struct Pass {
  CensusCodes left;
  CensusCodes right;
  Winners winners;
  Disparities raw;
  GrayImage confidence;

  void resize(int width, int height) {
    for (CensusCodes* codes : {&left, &right}) {
      for (GrayImage& plane : *codes) plane.resize(width, height);
    }
    winners.resize(width, height);
    raw.resize(width, height);
    confidence.resize(width, height);
  }
};

int rounded_up(int disparities) { return (disparities + 15) / 16 * 16; }

}  // namespace

struct StereoMatcher::Parts {
  StereoMatcherSettings settings;
  const StereoKernels* kernels;
  StandingThreads crew;
  Pass pass;
  Pass guard;
  GrayImage guard_left;
  GrayImage guard_right;
  Disparities coarse;
  Disparities unsmoothed;
  std::vector<AlignedBytes> workspaces;  // one per strip: two threads never share one
  std::vector<std::vector<std::uint32_t>> owners;
  SpeckleFilter speckles;
  SpeckleFilter guard_speckles;

  explicit Parts(const StereoMatcherSettings& s)
      : settings(s),
        kernels(s.kernels != nullptr ? s.kernels : &stereo_kernels().front()),
        crew(s.threads),
        workspaces(kStrips),
        owners(kStrips) {
    settings.disparities = rounded_up(settings.disparities);
    settings.guard_disparities = rounded_up(settings.guard_disparities);
  }

  void make_room(std::size_t bytes) {
    for (AlignedBytes& workspace : workspaces) workspace.at_least(bytes);
  }
  void find_winners(Pass& p, const GrayImage& left, const GrayImage& right, int first,
                    int disparities);
  void check(Pass& p, int first, int disparities, int left_right_px, Disparities& out,
             GrayImage& confidence);
  void mark_too_close(const GrayImage& left, const GrayImage& right, MatchedPair& out);
};

void StereoMatcher::Parts::find_winners(Pass& p, const GrayImage& left, const GrayImage& right,
                                        int first, int disparities) {
  p.resize(left.width(), left.height());
  make_room(kernel_workspace_bytes(left.width(), disparities));
  crew.run(2, [&](int eye) {
    kernels->census(eye == 0 ? left : right, eye == 0 ? p.left : p.right, workspaces[eye].begin());
  });
  const MatchJob job{&p.left, &p.right, &left, first, disparities, settings.penalties, &p.winners};
  // The widest vectors hold four strips; with more threads fewer strips are computed at once, so
  // that every thread has work.
  const int strips = crew.size() <= 2 ? 4 : crew.size() <= 4 ? 2 : 1;
  crew.run(kStrips / strips,
           [&](int i) { kernels->match(job, i * strips, strips, workspaces[i].begin()); });
}

void StereoMatcher::Parts::check(Pass& p, int first, int disparities, int left_right_px,
                                 Disparities& out, GrayImage& confidence) {
  const int height = p.raw.height();
  crew.run(kStrips, [&](int strip) {
    const StripRows rows = rows_of_strip(strip, height);
    check_winners(p.winners, first, disparities, left_right_px, rows.begin, rows.end, p.raw,
                  confidence, owners[strip]);
  });
  crew.run(kStrips, [&](int strip) {
    const StripRows rows = rows_of_strip(strip, height);
    kernels->median(p.raw, rows.begin, rows.end, out);
  });
}

// Marks pixels as too close where the guard finds something nearer than the range. A ring of one
// pixel of the guard around them becomes unknown.
void StereoMatcher::Parts::mark_too_close(const GrayImage& left, const GrayImage& right,
                                          MatchedPair& out) {
  crew.run(2,
           [&](int eye) { shrink(eye == 0 ? left : right, eye == 0 ? guard_left : guard_right); });
  // Rounded down, so that the guard also searches the smallest disparities of the range; otherwise
  // such pixels could be matched wrongly as too close.
  const int first = settings.first / kGuardShrink - (settings.first % kGuardShrink < 0 ? 1 : 0) - 1;
  find_winners(guard, guard_left, guard_right, first, settings.guard_disparities);
  coarse.resize(guard_left.width(), guard_left.height());
  check(guard, first, settings.guard_disparities, 1, coarse, guard.confidence);
  guard_speckles(kGuardSpeckles, kSpeckleStep, guard.confidence, coarse);

  const int end = settings.first + settings.disparities;
  const int limit = (end - 3) * kDisparitySteps / kGuardShrink;
  const int W = coarse.width();
  const int H = coarse.height();
  const auto too_close = [&](int x, int y) {
    return x >= 0 && x < W && y >= 0 && y < H && is_measured(coarse(x, y)) && coarse(x, y) >= limit;
  };
  for (int y = 0; y < H; ++y) {
    for (int x = 0; x < W; ++x) {
      const bool here = too_close(x, y);
      bool beside = false;
      for (int i = -1; i <= 1 && !here; ++i) {
        for (int j = -1; j <= 1; ++j) beside = beside || too_close(x + j, y + i);
      }
      if (!here && !beside) continue;
      for (int v = kGuardShrink * y; v < kGuardShrink * (y + 1); ++v) {
        for (int u = kGuardShrink * x; u < kGuardShrink * (x + 1); ++u) {
          std::int16_t& d = out.disparity(u, v);
          // Disparities near the end of the range are consistent with the guard, and are kept.
          if (is_measured(d) && d >= (end - settings.disparities / 4) * kDisparitySteps) continue;
          d = here ? kTooCloseDisparity : kUnknownDisparity;
          out.confidence(u, v) = 0;
        }
      }
    }
  }
}

StereoMatcherSettings near_matching() {
  StereoMatcherSettings settings;
  settings.disparities = 192;
  settings.guard_disparities = 112;
  settings.penalties = {3, 40, 6};
  settings.longest_gap_px = 16;
  settings.speckles.doubtful_size = 1000;
  return settings;
}

StereoMatcherSettings full_matching() {
  StereoMatcherSettings settings;
  settings.disparities = 128;
  settings.penalties = {5, 40, 40};
  settings.longest_gap_px = 24;
  settings.fill_edges = true;
  return settings;
}

StereoMatcher::StereoMatcher(const StereoMatcherSettings& settings) {
  PALPABLE_EXPECT(settings.penalties.are_sound(), "penalties are 0 <= P1 <= P2 <= 61");
  PALPABLE_EXPECT(
      settings.disparities >= 1 && settings.guard_disparities >= 0 &&
          rounded_up(settings.disparities) + std::abs(settings.first) <= kMostDisparities - 1 &&
          settings.guard_disparities < kMostDisparities,
      "disparities fit 1/64 px in 16 bits");
  parts_ = std::make_unique<Parts>(settings);
}
StereoMatcher::StereoMatcher(StereoMatcher&&) noexcept = default;
StereoMatcher& StereoMatcher::operator=(StereoMatcher&&) noexcept = default;
StereoMatcher::~StereoMatcher() = default;

void StereoMatcher::match(const GrayImage& left, const GrayImage& right, MatchedPair& out) {
  PALPABLE_EXPECT(left.width() == right.width() && left.height() == right.height(),
                  "both eyes see images of one size");
  PALPABLE_EXPECT(left.width() >= 16 && left.height() >= 16, "a picture of 16 x 16 at least");
  Parts& p = *parts_;
  const StereoMatcherSettings& s = p.settings;
  out.disparity.resize(left.width(), left.height());
  out.confidence.resize(left.width(), left.height());
  p.find_winners(p.pass, left, right, s.first, s.disparities);
  p.check(p.pass, s.first, s.disparities, s.left_right_px, out.disparity, out.confidence);
  p.speckles(s.speckles, kSpeckleStep, out.confidence, out.disparity);
  if (s.guard_disparities > 0 && left.width() >= 64 && left.height() >= 64) {
    p.mark_too_close(left, right, out);
  }
  p.crew.run(kStrips, [&](int strip) {
    const StripRows rows = rows_of_strip(strip, left.height());
    fill_gaps(s.longest_gap_px, kGapStep, s.fill_edges, rows.begin, rows.end, out.disparity,
              out.confidence);
    for (int y = rows.begin; y < rows.end; ++y) {
      for (int x = 0; x < left.width(); ++x) {
        if (!is_measured(out.disparity(x, y))) out.confidence(x, y) = 0;
      }
    }
  });
}

void StereoMatcher::refine(const GrayImage& left_full, const GrayImage& right_full,
                           MatchedPair& pair) {
  const int width = pair.disparity.width();
  const int height = pair.disparity.height();
  PALPABLE_EXPECT(left_full.width() / 2 == width && left_full.height() / 2 == height &&
                      right_full.width() == left_full.width() &&
                      right_full.height() == left_full.height(),
                  "the full images are twice as large");
  Parts& p = *parts_;
  p.unsmoothed.resize(width, height);
  p.make_room(kernel_workspace_bytes(width, p.settings.disparities));
  p.crew.run(kStrips, [&](int strip) {
    const StripRows rows = rows_of_strip(strip, height);
    take_lag_back(pair.disparity, rows.begin, rows.end, p.unsmoothed);
  });
  std::swap(p.unsmoothed, pair.disparity);
  p.crew.run(kStrips, [&](int strip) {
    const StripRows rows = rows_of_strip(strip, height);
    p.kernels->refine(left_full, right_full, rows.begin, rows.end, pair.disparity,
                      p.workspaces[strip].begin());
  });
  std::swap(p.unsmoothed, pair.disparity);
  p.crew.run(kStrips, [&](int strip) {
    const StripRows rows = rows_of_strip(strip, height);
    p.kernels->smooth(p.unsmoothed, rows.begin, rows.end, pair.disparity);
  });
}

const StereoMatcherSettings& StereoMatcher::settings() const { return parts_->settings; }
const char* StereoMatcher::simd() const { return parts_->kernels->name; }

}  // namespace palpable
