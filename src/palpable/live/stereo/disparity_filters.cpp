#include "palpable/live/stereo/disparity_filters.h"

#include "palpable/live/stereo/disparity_loops.h"

#include <algorithm>
#include <cstdlib>

namespace palpable {
namespace {

constexpr int kLargestSum = 3 * 24;  // sum of the costs of three paths if all bits differ

// A claim packs S and d of a left pixel that matches a right pixel into one number, so that the
// better claim is the smaller number; if S is equal, the one with the larger d (the nearer object).
constexpr std::uint32_t kUnclaimed = 0xffffffffU;
std::uint32_t claim(int cost, int d) {
  return static_cast<std::uint32_t>(cost) << 16U | (0xffffU - static_cast<std::uint32_t>(d));
}
int disparity_of(std::uint32_t claim) { return static_cast<int>(0xffffU - (claim & 0xffffU)); }

std::int16_t with_fraction(int d, int before, int cost, int after) {
  const int steep = std::max(before, after) - cost;
  // Rounds steps * (before - after) / (2 steep) to the nearest integer; made positive before
  // dividing.
  const int fraction =
      steep <= 0
          ? 0
          : (kDisparitySteps * (before - after) + kDisparitySteps * steep + steep) / (2 * steep) -
                kDisparitySteps / 2;
  return static_cast<std::int16_t>(d * kDisparitySteps + fraction);
}

}  // namespace

void check_winners(const Winners& winners, int first, int disparities, int left_right_px,
                   int y_begin, int y_end, Disparities& out, GrayImage& confidence,
                   std::vector<std::uint32_t>& owners) {
  const int width = out.width();
  if (owners.size() < static_cast<std::size_t>(width)) { owners.resize(width); }
  for (int y = y_begin; y < y_end; ++y) {
    const std::uint16_t* best = winners.best.row(y);
    const std::uint8_t* cost = winners.cost.row(y);
    const std::uint8_t* before = winners.before.row(y);
    const std::uint8_t* after = winners.after.row(y);
    std::int16_t* to = out.row(y);
    std::uint8_t* sure = confidence.row(y);
    std::fill_n(owners.begin(), width, kUnclaimed);
    for (int x = 0; x < width; ++x) {
      const int partner = x - first - best[x];
      if (partner < 0 || partner >= width) continue;
      std::uint32_t& owner = owners[partner];
      owner = std::min(owner, claim(cost[x], best[x]));
    }
    for (int x = 0; x < width; ++x) {
      const int d = best[x];
      const int partner = x - first - d;
      to[x] = kUnknownDisparity;
      sure[x] = 0;
      if (d == 0 || d + 1 >= disparities || partner < 0 || partner >= width) continue;
      const int owner = disparity_of(owners[partner]);
      if (std::abs(owner - d) > left_right_px) continue;
      to[x] = with_fraction(first + d, before[x], cost[x], after[x]);
      const int agreement = kLargestSum - std::min<int>(cost[x], kLargestSum);
      sure[x] = static_cast<std::uint8_t>(kLeastConfidence +
                                          agreement * (255 - kLeastConfidence) / kLargestSum);
    }
  }
}

void median_3x3(const Disparities& in, int y_begin, int y_end, Disparities& out) {
  median_3x3_loops(in, y_begin, y_end, out);
}

void take_lag_back(const Disparities& in, int y_begin, int y_end, Disparities& out) {
  constexpr int kReach = 2;  // rows
  for (int y = y_begin; y < y_end; ++y) {
    const std::int16_t* here = in.row(y);
    std::int16_t* to = out.row(y);
    if (y < kReach || y + kReach >= in.height()) {
      std::copy_n(here, in.width(), to);
      continue;
    }
    const std::int16_t *above = in.row(y - kReach), *below = in.row(y + kReach);
    for (int x = 0; x < in.width(); ++x) {
      const int d = here[x], a = above[x], b = below[x];
      // The marks for unknown and too close differ from all measured values by more than a step.
      const bool one =
          std::abs(a - d) <= kLagStep && std::abs(b - d) <= kLagStep && is_measured(here[x]);
      const int moved = (kLagRows_64 * (b - a) + 128) >> 8;
      to[x] = static_cast<std::int16_t>(one ? d + moved : d);
    }
  }
}

void smooth_surfaces(const Disparities& in, int y_begin, int y_end, Disparities& out) {
  smooth_surfaces_loops(in, y_begin, y_end, out);
}

int SpeckleFilter::root(int run) {
  const auto at = [this](int i) -> Run& { return runs_[i]; };
  while (at(run).parent != run) {
    at(run).parent = at(at(run).parent).parent;
    run = at(run).parent;
  }
  return run;
}

void SpeckleFilter::operator()(const SpeckleLimits& limits, int step, const GrayImage& confidence,
                               Disparities& d) {
  const int width = d.width();
  const int height = d.height();
  // In the worst case there are as many runs as pixels.
  if (runs_.capacity() < d.size()) runs_.reserve(d.size());
  runs_.clear();
  const auto near = [step](std::int16_t a, std::int16_t b) { return std::abs(a - b) <= step; };
  std::size_t above_begin = 0;
  for (int y = 0; y < height; ++y) {
    const std::int16_t* here = d.row(y);
    const std::size_t row_begin = runs_.size();
    std::size_t above = above_begin;
    for (int x = 0; x < width;) {
      if (!is_measured(here[x])) {
        ++x;
        continue;
      }
      int end = x + 1;
      while (end < width && is_measured(here[end]) && near(here[end], here[end - 1])) ++end;
      const auto me = static_cast<int>(runs_.size());
      std::int64_t sure = 0;
      if (limits.doubtful_size > 0) {
        const std::uint8_t* of_row = confidence.row(y);
        for (int i = x; i < end; ++i) sure += of_row[i];
      }
      runs_.push_back({x, end, y, me, end - x, sure});
      // Visits the runs of the row above that share a column; the last may also touch the next run.
      while (above < row_begin && runs_[above].end <= x) ++above;
      const std::int16_t* up = y > 0 ? d.row(y - 1) : nullptr;
      for (std::size_t i = above; i < row_begin && runs_[i].begin < end; ++i) {
        const int last = std::min(end, runs_[i].end);
        int column = std::max(x, runs_[i].begin);
        while (column < last && !near(here[column], up[column])) ++column;
        if (column == last) continue;
        const int mine = root(me);
        const int other = root(static_cast<int>(i));
        if (mine == other) continue;
        Run& from = runs_[mine];
        Run& to = runs_[other];
        from.parent = other;
        to.size += from.size;
        to.confidence += from.confidence;
      }
      x = end;
    }
    above_begin = row_begin;
  }
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    const Run run = runs_[i];
    const Run& patch = runs_[root(static_cast<int>(i))];
    const bool doubtful = patch.size < limits.doubtful_size &&
                          patch.confidence < std::int64_t{limits.doubtful_confidence} * patch.size;
    if (patch.size >= limits.size && !doubtful) continue;
    std::fill(d.row(run.y) + run.begin, d.row(run.y) + run.end, kUnknownDisparity);
  }
}

void fill_gaps(int longest, int step, bool also_edges, int y_begin, int y_end, Disparities& d,
               GrayImage& confidence) {
  const int width = d.width();
  for (int y = y_begin; y < y_end; ++y) {
    std::int16_t* row = d.row(y);
    std::uint8_t* sure = confidence.row(y);
    for (int x = 0; x < width;) {
      if (row[x] != kUnknownDisparity) {
        ++x;
        continue;
      }
      const int begin = x;
      while (x < width && row[x] == kUnknownDisparity) ++x;
      if (begin == 0 || x == width || x - begin > longest) continue;
      const int left = row[begin - 1];
      const int right = row[x];
      if (left == kTooCloseDisparity || right == kTooCloseDisparity) continue;
      const bool together = std::abs(left - right) <= step;
      if (!together && !also_edges) continue;
      const int count = x - begin + 1;
      for (int i = begin; i < x; ++i) {
        row[i] = static_cast<std::int16_t>(
            together ? left + (right - left) * (i - begin + 1) / count : std::min(left, right));
        sure[i] = kFilledConfidence;
      }
    }
  }
}

}  // namespace palpable
