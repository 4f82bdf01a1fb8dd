// palpable bench depth: time and accuracy of the stereo matcher, compared with OpenCV's SGBM.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/installed.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/live/calibrate/rectification.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/render/fill_unknown.h"
#include "palpable/live/render/outlines.h"
#include "palpable/live/stereo/stereo_matcher.h"

#include <fmt/core.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/live/bench.h"
#include "bench/live/middlebury_pairs.h"
#include "bench/live/near_frames.h"
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

constexpr int kNearRange = 384;  // disparities of a 720p pair: down to 0.115 m
constexpr int kFullRange = 128;
constexpr double kTooFar = 1.2;                                          // ratio to the true depth
constexpr std::array kDepths{0.2, 0.3, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0};  // m
constexpr double kDepthBand = 0.15;

struct DepthBenchOptions {
  std::filesystem::path body;
  std::filesystem::path data = "../shared/data";
  std::uint64_t seed = 1;
  int frames = 36;
  int repeats = 7;
  std::string simd;
  bool json = false;
};

const StereoKernels& kernels_named(const std::string& name) {
  std::string names;
  for (const StereoKernels& kernels : stereo_kernels()) {
    if (name.empty() || name == kernels.name) return kernels;
    names += std::string(names.empty() ? "" : ", ") + kernels.name;
  }
  throw Error(fmt::format("--simd {}: this processor has {}", name, names));
}

// The reference matcher with the settings of docs/benchmark.md; its picture is padded on the
// left by the range.
cv::Mat sgbm(const GrayImage& left, const GrayImage& right, int range) {
  const cv::Ptr<cv::StereoSGBM> matcher = cv::StereoSGBM::create(0, range, 5);
  matcher->setMode(cv::StereoSGBM::MODE_SGBM_3WAY);
  matcher->setP1(8 * 25);
  matcher->setP2(32 * 25);
  matcher->setUniquenessRatio(5);
  const auto padded = [range](const GrayImage& image) {
    const cv::Mat view(image.height(), image.width(), CV_8UC1,
                       const_cast<std::uint8_t*>(image.data()));  // NOLINT
    cv::Mat wide;
    cv::copyMakeBorder(view, wide, 0, 0, range, 0, cv::BORDER_REPLICATE);
    return wide;
  };
  cv::Mat disparity;
  matcher->compute(padded(left), padded(right), disparity);
  return disparity.colRange(range, disparity.cols);
}

GrayImage scaled(const GrayImage& image, int width, int height) {
  GrayImage result(width, height);
  const cv::Mat from(image.height(), image.width(), CV_8UC1,
                     const_cast<std::uint8_t*>(image.data()));  // NOLINT
  cv::Mat to(height, width, CV_8UC1, result.data());
  cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
  return result;
}

struct Times {
  double cpu_ms = 0;
  double wall_ms = 0;
};

template <class Work>
Times timed(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  const double cpu = process_cpu_seconds();
  work();
  const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - begin;
  return {1e3 * (process_cpu_seconds() - cpu), wall.count()};
}

// Keeps the smallest of several times, because other load on the machine only adds.
void keep_least(Times& least, const Times& now) {
  least.cpu_ms = least.cpu_ms == 0 ? now.cpu_ms : std::min(least.cpu_ms, now.cpu_ms);
  least.wall_ms = least.wall_ms == 0 ? now.wall_ms : std::min(least.wall_ms, now.wall_ms);
}

// The near mode from rectified luma on: halving, matching, refinement.
class NearMode {
 public:
  NearMode(int width, int threads, const StereoKernels& kernels)
      : matcher_([&] {
          StereoMatcherSettings settings = near_matching();
          settings.disparities = settings.disparities * width / 1280;
          settings.guard_disparities = settings.guard_disparities * width / 1280;
          settings.threads = threads;
          settings.kernels = &kernels;
          return settings;
        }()) {}
  void run(const GrayImage& left, const GrayImage& right) {
    Rectification::halve(left, left_half_);
    Rectification::halve(right, right_half_);
    matcher_.match(left_half_, right_half_, pair_);
    matcher_.refine(left, right, pair_);
  }

 private:
  StereoMatcher matcher_;
  GrayImage left_half_, right_half_;
  MatchedPair pair_;
};

StereoMatcherSettings full_mode(int threads, const StereoKernels& kernels) {
  StereoMatcherSettings settings = full_matching();
  settings.threads = threads;
  settings.kernels = &kernels;
  return settings;
}

void time_matchers(const GrayImage& left, const GrayImage& right, int repeats,
                   const StereoKernels& kernels, ProgressBar& bar, Json& result) {
  const GrayImage left_672 = scaled(left, 672, 376), right_672 = scaled(right, 672, 376);
  const GrayImage left_1080 = scaled(left, 1920, 1080), right_1080 = scaled(right, 1920, 1080);
  NearMode near(1280, 1, kernels), near_2(1280, 2, kernels), near_672(672, 1, kernels),
      near_1080(1920, 1, kernels);
  StereoMatcher full(full_mode(1, kernels)), full_2(full_mode(2, kernels));
  MatchedPair pair;
  Times near_t, near_2_t, t_672, t_1080, full_t, full_2_t, sgbm_near, sgbm_full;
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  for (int i = 0; i < repeats; ++i) {
    // The variants alternate, so that other load on the machine affects all of them.
    keep_least(sgbm_near, timed([&] { sgbm(left, right, kNearRange); }));
    keep_least(sgbm_full, timed([&] { sgbm(left, right, kFullRange); }));
    for (int k = 0; k < 3; ++k) {
      keep_least(near_t, timed([&] { near.run(left, right); }));
      keep_least(near_2_t, timed([&] { near_2.run(left, right); }));
      keep_least(t_672, timed([&] { near_672.run(left_672, right_672); }));
      keep_least(t_1080, timed([&] { near_1080.run(left_1080, right_1080); }));
      keep_least(full_t, timed([&] { full.match(left, right, pair); }));
      keep_least(full_2_t, timed([&] { full_2.match(left, right, pair); }));
    }
    bar.show({"timing", i + 1.0, static_cast<double>(repeats), ""});
  }
  cv::setNumThreads(threads);
  result["speedup_near"] = sgbm_near.cpu_ms / near_t.cpu_ms;
  result["speedup_full"] = sgbm_full.cpu_ms / full_t.cpu_ms;
  result["simd"] = kernels.name;
  result["wall_ms_720p"] = near_2_t.wall_ms;
  result["ms_672"] = t_672.cpu_ms;
  result["ms_720p"] = near_t.cpu_ms;
  result["ms_1080p"] = t_1080.cpu_ms;
  result["ms_full"] = full_t.cpu_ms;
  result["wall_ms_full"] = full_2_t.wall_ms;
  result["sgbm_ms_near"] = sgbm_near.cpu_ms;
  result["sgbm_ms_full"] = sgbm_full.cpu_ms;
}

// Share of the visible pixels with a true disparity whose disparity is wrong by more than
// 2 px or missing.
template <class DisparityAt>
double bad_share(const MiddleburyPair& pair, const DisparityAt& at) {
  std::size_t count = 0, bad = 0;
  for (int y = 0; y < pair.truth.height(); ++y)
    for (int x = 0; x < pair.truth.width(); ++x) {
      if (std::isnan(pair.truth(x, y))) continue;
      ++count;
      const double d = at(x, y);  // NaN: missing
      bad += std::abs(d - static_cast<double>(pair.truth(x, y))) <= 2 ? 0 : 1;
    }
  return count == 0 ? std::nan("") : static_cast<double>(bad) / static_cast<double>(count);
}

void compare_scenes(const std::filesystem::path& data, const StereoKernels& kernels, Json& result) {
  Json ratio, ours, theirs;
  double sum_ours = 0, sum_theirs = 0;
  bool all = true;
  StereoMatcher matcher(full_mode(1, kernels));
  for (const char* name : {"tsukuba", "teddy", "Cloth3"}) {
    const std::optional<MiddleburyPair> pair = read_middlebury_pair(data / "stereo_gt" / name);
    ratio[name] = ours[name] = theirs[name] = nullptr;
    if (!pair) {
      all = false;
      continue;
    }
    MatchedPair found;
    matcher.match(pair->left, pair->right, found);
    const double own = bad_share(*pair, [&](int x, int y) {
      const std::int16_t d = found.disparity(x, y);
      return is_measured(d) ? static_cast<double>(d) / kDisparitySteps : std::nan("");
    });
    const cv::Mat reference = sgbm(pair->left, pair->right, kFullRange);
    const double opencv = bad_share(*pair, [&](int x, int y) {
      const int d = reference.at<std::int16_t>(y, x);
      return d > 0 ? d / 16.0 : std::nan("");
    });
    ours[name] = own;
    theirs[name] = opencv;
    ratio[name] = own / opencv;
    sum_ours += own;
    sum_theirs += opencv;
  }
  ratio["mean"] = all ? Json(sum_ours / sum_theirs) : nullptr;
  result["bad2_ratio"] = ratio;
  result["bad2"] = ours;
  result["bad2_sgbm"] = theirs;
}

// Result of the whole chain, from the raw pair to depth, on the near frames of `press`.
struct NearScore {
  std::size_t hand = 0, known = 0, within = 0, close = 0, called_far = 0, marked_close = 0;
  std::vector<double> errors;
  std::array<std::vector<double>, kDepths.size()> by_depth;

  void add(const SeenFrame& seen, const DeskTruth& truth, bool is_near) {
    constexpr std::uint8_t kWanted = kMovesLabel | kBothSeeLabel;
    for (int y = 0; y < truth.depth.height(); ++y)
      for (int x = 0; x < truth.depth.width(); ++x) {
        const auto z = static_cast<double>(truth.depth(x, y));
        if (!(z > 0)) continue;
        const auto found = static_cast<double>(seen.depth(x, y));  // NaN: unknown
        const double error = std::abs(found - z) / z;
        if (truth.depth(x, y) < kTooCloseDepth) {
          ++close;
          called_far += found > kTooFar * z ? 1 : 0;
          marked_close += seen.too_close(x, y) != 0 ? 1 : 0;
        }
        if (!is_near || (truth.labels(x, y) & kBothSeeLabel) == 0) continue;
        for (std::size_t i = 0; i < kDepths.size(); ++i) {
          if (std::abs(z - kDepths[i]) > kDepthBand * kDepths[i]) continue;
          if (!std::isnan(error) && (x + y) % 5 == 0) by_depth[i].push_back(error);
        }
        if ((truth.labels(x, y) & kWanted) != kWanted) continue;
        ++hand;
        if (std::isnan(error)) continue;
        ++known;
        within += error <= 0.01 ? 1 : 0;
        errors.push_back(error);
      }
  }
};

// Cost of the occluders' outlines in front of a body: closing holes and deciding sides, in a box at
// the centre of the picture as large as the demo's body at 720p with a margin.
class OutlineTimes {
 public:
  void add(const SeenFrame& seen) {
    constexpr int kSide = 144, kHoles = 6;  // px at half resolution
    constexpr float kBodyZ = 0.4f;          // m, a plate between hand and desk
    const int cx = seen.depth.width() / 2, cy = seen.depth.height() / 2;
    const PixelBox inner{cx - kSide / 2, cy - kSide / 2, kSide, kSide};
    const PixelBox box = PixelBox::between(
        std::max(inner.x - kLongestHalfSeen - 1, 0), std::max(inner.y - RealOutlines::kMargin, 0),
        std::min(inner.right() + kLongestHalfSeen + 1, seen.depth.width()),
        std::min(inner.bottom() + RealOutlines::kMargin, seen.depth.height()));
    body_.assign(4 * kSide * kSide, kBodyZ);
    Times least;
    for (int i = 0; i < 5; ++i) {
      keep_least(least, timed([&] {
                   fill_unknown(seen.depth, nullptr, box, kHoles, nearest_, filled_);
                   outlines_.find({.picture = seen.color,
                                   .box = box,
                                   .depth = filled_,
                                   .guessed = nearest_,
                                   .inner = inner,
                                   .body = body_,
                                   .too_close = &seen.too_close});
                 }));
    }
    cpu_ms_.push_back(least.cpu_ms);
  }
  [[nodiscard]] const std::vector<double>& cpu_ms() const { return cpu_ms_; }

 private:
  RealOutlines outlines_;
  std::vector<signed char> nearest_;
  std::vector<float> filled_, body_;
  std::vector<double> cpu_ms_;
};

Json median_or_null(const std::vector<double>& values) {
  if (values.empty()) return nullptr;
  return percentile(values, 0.5);
}

void print_depth_table(const Json& r) {
  fmt::print("{:<44}{:>12}{:>14}\n", "", "this", "OpenCV SGBM");
  const auto line = [](const char* name, const char* format, const Json& a, const Json& b,
                       double scale = 1) {
    const auto text = [&](const Json& v) {
      return v.is_null() ? std::string("-")
                         : fmt::format(fmt::runtime(format), scale * v.get<double>());
    };
    fmt::print("{:<44}{:>12}{:>14}\n", name, text(a), text(b));
  };
  const Json none = nullptr;
  line("near mode, 1280 x 720, CPU ms", "{:.1f}", r["ms_720p"], r["sgbm_ms_near"]);
  line("  wall ms on two threads", "{:.1f}", r["wall_ms_720p"], none);
  line("  672 x 376, 1 thread, CPU ms", "{:.1f}", r["ms_672"], none);
  line("  1920 x 1080, 1 thread, CPU ms", "{:.1f}", r["ms_1080p"], none);
  line("outlines before a body, 288 x 288 px, CPU ms", "{:.1f}", r["outlines_ms_720p"], none);
  line("full mode, 1280 x 720 x 128, CPU ms", "{:.1f}", r["ms_full"], r["sgbm_ms_full"]);
  for (const char* name : {"tsukuba", "teddy", "Cloth3"}) {
    line(fmt::format("bad pixels of {}, %", name).c_str(), "{:.2f}", r["bad2"][name],
         r["bad2_sgbm"][name], 100);
  }
  line("near hand: median error, %", "{:.3f}", r["near_median_error"], none, 100);
  line("near hand: within 1 %, %", "{:.1f}", r["hand_within_1pct"], none, 100);
  line("nearer than the range, called far, %", "{:.3f}", r["too_close_called_far"], none, 100);
  fmt::print("\n{} less CPU time near, {} full ({})\n\n",
             fmt::format("{:.1f} times", r["speedup_near"].get<double>()),
             fmt::format("{:.1f} times", r["speedup_full"].get<double>()),
             r["simd"].get<std::string>());
  fmt::print("{:<10}{:>18}{:>24}\n", "depth, m", "median error, %", "a tenth of a pixel, %");
  for (const auto& row : r["error_by_depth"]) {
    fmt::print("{:<10}{:>18}{:>24.3f}\n", row["depth_m"].get<double>(),
               row["median_error"].is_null()
                   ? std::string("-")
                   : fmt::format("{:.3f}", 100 * row["median_error"].get<double>()),
               100 * row["limit_tenth_px"].get<double>());
  }
}

// The whole chain on frames of `press`, from the raw pair to depth and outlines.
class NearBench {
 public:
  NearBench(NearFrames& near, ProgressBar& bar)
      : near_(near),
        bar_(bar),
        camera_(value_or_throw(DepthCamera::make(format_of(near.rig()), {}))),
        rectification_(near.rig()) {}

  // Scores the frames with these numbers. For near frames it also measures the time of the outlines
  // and keeps the middle pair.
  void run(const std::vector<int>& numbers, const char* what, bool is_near) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      near_.draw(numbers[i], 2, pair_, truth_);
      frame_.left = pair_.left;
      frame_.right = pair_.right;
      camera_.see(frame_, seen_);
      score_.add(seen_, truth_, is_near);
      if (is_near) outlines_.add(seen_);
      if (is_near && i == numbers.size() / 2) {
        rectification_.rectify_luma(Rectification::Eye::kLeft, pair_.left, left_);
        rectification_.rectify_luma(Rectification::Eye::kRight, pair_.right, right_);
      }
      bar_.show({what, static_cast<double>(i + 1), static_cast<double>(numbers.size()), ""});
    }
  }

  void write_score(Json& result) const {
    const auto share = [](std::size_t part, std::size_t whole) {
      return whole == 0 ? Json(nullptr)
                        : Json(static_cast<double>(part) / static_cast<double>(whole));
    };
    result["near_median_error"] = median_or_null(score_.errors);
    result["hand_within_1pct"] = share(score_.within, score_.hand);
    result["hand_density"] = share(score_.known, score_.hand);
    result["too_close_called_far"] = share(score_.called_far, score_.close);
    result["too_close_marked"] = share(score_.marked_close, score_.close);
    result["too_close_pixels"] = score_.close;
    result["outlines_ms_720p"] = median_or_null(outlines_.cpu_ms());
  }

  void write_error_by_depth(Json& result) const {
    const RectifiedStereo& stereo = near_.stereo();
    result["error_by_depth"] = Json::array();
    for (std::size_t i = 0; i < kDepths.size(); ++i) {
      result["error_by_depth"].push_back(
          {{"depth_m", kDepths[i]},
           {"median_error", median_or_null(score_.by_depth[i])},
           // Depth error of a disparity error dd: dZ / Z = Z / (f T) dd, T the baseline; here for
           // dd = 0.1 px.
           {"limit_tenth_px", 0.1 * kDepths[i] / (stereo.camera.fx_px * stereo.baseline)}});
    }
  }

  // The rectified middle pair of the near frames.
  [[nodiscard]] const GrayImage& left() const { return left_; }
  [[nodiscard]] const GrayImage& right() const { return right_; }

 private:
  NearFrames& near_;
  ProgressBar& bar_;
  DepthCamera camera_;
  Rectification rectification_;
  NearScore score_;
  OutlineTimes outlines_;
  RawPair pair_;
  DeskTruth truth_;
  Frame frame_;
  SeenFrame seen_;
  GrayImage left_, right_;
};

void bench_depth(const DepthBenchOptions& options) {
  const StereoKernels& kernels = kernels_named(options.simd);
  ProgressBar bar;
  NearFrames near(options.body.empty() ? default_body() : options.body, options.seed,
                  bar.progress());
  Json result;
  result["bench"] = "depth";
  result["body"] = near.body_name();
  result["seed"] = options.seed;

  NearBench bench(near, bar);
  const std::size_t frames = options.frames;
  const std::vector<int> numbers = near.spread(frames);
  const std::vector<int> close = near.spread_too_close((frames + 2) / 3);
  bench.run(numbers, "near frames", true);
  bench.run(close, "frames too close", false);
  time_matchers(bench.left(), bench.right(), options.repeats, kernels, bar, result);
  bar.finish();
  compare_scenes(options.data, kernels, result);
  bench.write_score(result);
  result["near_frames"] = numbers.size();
  result["too_close_frames"] = close.size();
  bench.write_error_by_depth(result);
  if (options.json) {
    fmt::print("{}\n", result.dump(2));
  } else {
    print_depth_table(result);
  }
}

}  // namespace

void add_bench_depth(Command bench) {
  auto options = std::make_shared<DepthBenchOptions>();
  Command command = bench.add_subcommand(
      "depth", "The stereo matcher beside OpenCV's SGBM: time, scenes with truth, near hands");
  command.add_option("--body", options->body, "Body file")
      .default_is("build/bodies/bunny-dense.palpable, else out/demo/bunny.palpable");
  command.add_option("--seed", options->seed, "Seed of the sequence press")
      .in_range(std::uint64_t{0}, kLargestSeed)
      .show_default();
  command
      .add_option(
          "--data", options->data,
          "Folder whose stereo_gt/ holds tsukuba, teddy and Cloth3; what is missing is null")
      .show_default();
  command.add_option("--frames", options->frames, "At most this many near frames")
      .in_range(1, 600)
      .show_default();
  command.add_option("--repeats", options->repeats, "How often each is timed; the least counts")
      .in_range(1, 1000)
      .show_default();
  command
      .add_option("--simd", options->simd,
                  "Vector instructions to time: AVX3_DL, AVX3 (both AVX-512), AVX2, SSE4, "
                  "scalar ...")
      .default_is("the best of this processor");
  command.add_json(options->json);
  command.footer(
      "Times are CPU ms of one thread, the least of the repeats, all matchers in turn in one run;\n"
      "wall_ms_* are wall times on two threads. Near frames: the hand's pixels that both eyes "
      "see.\n"
      "Example: palpable bench depth --json");
  command.callback([options] { bench_depth(*options); });
}

}  // namespace palpable::app
