// The matcher's census and aggregation for all available vector instructions, with Google Highway:
// this file is compiled once for each instruction set, and the best one is chosen at run time.
// refine_kernels.cpp contains the other loops.
//
// A vector holds `kBlocks` blocks of 16 bytes. Each block belongs to a different strip of rows, so
// that no data move between blocks and all vector widths perform the same arithmetic. In a block,
// lane l of register j belongs to the disparity
//
//     d = l R + j     with R = D / 16
//
// so that the neighbours d - 1 and d + 1 are whole registers. Only the neighbours of the first and
// the last register must be shifted by one lane.
//
// Shapes of the row buffers, for one row at a time:
//   costs, above, sum (W x R x N) bytes, N = 16 kBlocks

// Enables AVX-512 with popcount of bytes. Must precede the first header of Highway.
#define HWY_WANT_AVX3_DL
#include "palpable/live/stereo/stereo_kernels.h"

#include "palpable/common/base/simd_targets.h"
#include "palpable/live/stereo/refine_kernels.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "palpable/live/stereo/stereo_kernels.cpp"
// Highway requires this include before the next:
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#ifndef PALPABLE_STEREO_KERNELS_ONCE
#define PALPABLE_STEREO_KERNELS_ONCE
namespace palpable {
namespace {

#if HWY_ARCH_X86
static_assert(HWY_ATTAINABLE_AVX3_DL != 0,
              "HWY_WANT_AVX3_DL comes before the first header of Highway");
#endif

constexpr std::size_t kBlock = 16;  // bytes
constexpr std::size_t kWidestVector = 64;
// L of a disparity outside the range: larger than every P2 + cost, and with P1 it still fits a
// byte.
constexpr std::uint8_t kNoNeighbour = 127;

constexpr std::array<std::uint8_t, 64> byte_of_block() {
  std::array<std::uint8_t, 64> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i / kBlock);
  return bytes;
}

// Bytes of one of the five rows of census(), including the bytes that a vector may read beyond the
// row's end.
std::size_t census_stride(int width) { return width + 4 + 320; }

// The offsets of the parts of a gang's workspace, bytes.
struct Workspace {
  std::size_t costs = 0, above = 0, above_least = 0, sum = 0, left = 0, right = 0, raw = 0,
              across = 0, padded = 0, p2_along = 0, p2_down = 0, bytes = 0;

  Workspace(int width, int disparities, std::size_t N) {
    const std::size_t W = width;
    const std::size_t D = disparities;
    const std::size_t R = D / kBlock;
    const auto reserve = [this](std::size_t size) {
      const std::size_t begin = bytes;
      bytes += (size + kWidestVector - 1) / kWidestVector * kWidestVector;
      return begin;
    };
    costs = reserve(W * R * N);
    above = reserve(W * R * N);
    sum = reserve(W * R * N);
    above_least = reserve(W * N);
    left = reserve(3 * (W + 2 * kBlock) * (N / kBlock) + kBlock);
    right = reserve(3 * (W + R + kBlock) * N);
    raw = reserve(3 * R * N);
    across = reserve(R * N);
    padded = reserve(W + D + 4 * kBlock);
    p2_along = reserve((W + kBlock) * (N / kBlock));
    p2_down = reserve((W + kBlock) * (N / kBlock));
  }
};

}  // namespace
}  // namespace palpable
#endif

HWY_BEFORE_NAMESPACE();
namespace palpable::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR
// For a processor without any of the vector instructions.
void census(const GrayImage& image, CensusCodes& codes, std::uint8_t* workspace) {
  scalar_stereo_kernels().census(image, codes, workspace);
}
void match(const MatchJob& job, int first_strip, int count, std::uint8_t* workspace) {
  scalar_stereo_kernels().match(job, first_strip, count, workspace);
}
#else

// --- census ------------------------------------------------------------------------------------

// Computes one row of codes; rows[i] is row y - 2 + i, padded by 2 px on the left and by more on
// the right.
HWY_ATTR void census_row(const std::uint8_t* const rows[5], int width, CensusCodes& codes, int y) {
  const hn::ScalableTag<std::uint8_t> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto step = hn::Set(d, static_cast<std::uint8_t>(kCensusStep));
  // Each byte has eight neighbours, in the order of the scalar version.
  for (int x = 0; x < width; x += lanes) {
    const auto centre = hn::SaturatedSub(hn::LoadU(d, rows[2] + x + 2), step);
    int bit = 0;
    std::size_t plane = 0;
    auto code = hn::Zero(d);
    alignas(kWidestVector) std::uint8_t tail[256];
    for (int dy = 0; dy < 5; ++dy) {
      for (int dx = 0; dx < 5; ++dx) {
        if (dx == 2 && dy == 2) continue;
        const auto neighbour = hn::LoadU(d, rows[dy] + x + dx);
        const auto darker = hn::Lt(neighbour, centre);
        const auto one = hn::Set(d, static_cast<std::uint8_t>(1U << bit));
        code = hn::Or(code, hn::And(hn::VecFromMask(d, darker), one));
        if (++bit < 8) continue;
        if (x + lanes <= width) {
          hn::StoreU(code, d, codes[plane].row(y) + x);
        } else {
          hn::Store(code, d, tail);
          std::memcpy(codes[plane].row(y) + x, tail, width - x);
        }
        code = hn::Zero(d);
        bit = 0;
        ++plane;
      }
    }
  }
}

HWY_ATTR void census(const GrayImage& image, CensusCodes& codes, std::uint8_t* ring) {
  const int width = image.width();
  const int height = image.height();
  // A ring buffer of five padded rows.
  const std::size_t stride = census_stride(width);
  const auto load = [&](int y) {
    std::uint8_t* to = ring + ((y + 5) % 5) * stride;
    const std::uint8_t* from = image.row(std::clamp(y, 0, height - 1));
    to[0] = to[1] = from[0];
    std::memcpy(to + 2, from, width);
    std::memset(to + 2 + width, from[width - 1], stride - width - 2);
  };
  for (int y = -2; y < 2; ++y) load(y);
  for (int y = 0; y < height; ++y) {
    load(y + 2);
    const std::uint8_t* rows[5];
    for (int i = 0; i < 5; ++i) { rows[i] = ring + ((y - 2 + i + 5) % 5) * stride; }
    census_row(rows, width, codes, y);
  }
}

// --- aggregation -------------------------------------------------------------------------------

template <class Tag>
using Bytes = hn::Vec<Tag>;

// The smallest lane of each block, in all of its lanes.
template <class Tag, class V = Bytes<Tag>>
HWY_INLINE V least_of_block(Tag d, V v) {
  v = hn::Min(v, hn::CombineShiftRightBytes<8>(d, v, v));
  v = hn::Min(v, hn::CombineShiftRightBytes<4>(d, v, v));
  v = hn::Min(v, hn::CombineShiftRightBytes<2>(d, v, v));
  return hn::Min(v, hn::CombineShiftRightBytes<1>(d, v, v));
}

// The state of a path at the pixel before, which a step needs.
template <class Tag, class V = Bytes<Tag>>
struct Walk {
  V previous;  // L at d - 1
  V here;      // L at d
  V last;      // L at d + 1 for the last register
  V least;     // the smallest L
  V limit;     // least + P2

  HWY_INLINE Walk(Tag d, const std::uint8_t* path, int R, V the_least, V p2) {
    const auto none = hn::Set(d, kNoNeighbour);
    const std::size_t N = hn::Lanes(d);
    here = hn::Load(d, path);
    previous = hn::CombineShiftRightBytes<15>(d, hn::Load(d, path + (R - 1) * N), none);
    last = hn::CombineShiftRightBytes<1>(d, none, here);
    least = the_least;
    limit = hn::Add(the_least, p2);
  }
  // L of one register. `next` is the next register's L of the pixel before.
  HWY_INLINE V step(V cost, V next, V p1) {
    const V sides = hn::Add(hn::Min(previous, next), p1);
    const V best = hn::Min(hn::Min(here, limit), sides);
    previous = here;
    here = next;
    return hn::Add(hn::Sub(best, least), cost);
  }
};

// Transposes a matrix of 16 x 16 bytes.
template <class D16, class V16>
HWY_INLINE void transpose_16(D16 d16, V16 (&v)[16]) {
  V16 w[16];
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < 8; ++i) {
      w[2 * i] = hn::InterleaveLower(d16, v[i], v[i + 8]);
      w[2 * i + 1] = hn::InterleaveUpper(d16, v[i], v[i + 8]);
    }
    for (std::size_t i = 0; i < 8; ++i) {
      v[2 * i] = hn::InterleaveLower(d16, w[i], w[i + 8]);
      v[2 * i + 1] = hn::InterleaveUpper(d16, w[i], w[i + 8]);
    }
  }
}

template <class Tag>
class Gang {
  using V = Bytes<Tag>;
  static constexpr std::size_t N = hn::MaxLanes(Tag());
  static constexpr int kBlocks = static_cast<int>(N / kBlock);

 public:
  HWY_INLINE Gang(const MatchJob& job, int first_strip, std::uint8_t* memory)
      : job_(job),
        first_strip_(first_strip),
        W_((*job.left)[0].width()),
        H_((*job.left)[0].height()),
        R_(job.disparities / static_cast<int>(kBlock)) {
    const Workspace at(W_, job.disparities, N);
    costs_ = memory + at.costs;
    above_ = memory + at.above;
    above_least_ = memory + at.above_least;
    sum_ = memory + at.sum;
    left_ = memory + at.left;
    right_ = memory + at.right;
    raw_ = memory + at.raw;
    across_ = memory + at.across;
    padded_ = memory + at.padded;
    p2_along_ = memory + at.p2_along;
    p2_down_ = memory + at.p2_down;
  }

  HWY_INLINE void run() {
    std::memset(above_, 0, stride() * W_);
    std::memset(above_least_, 0, N * W_);
    int rows = 0;
    for (int b = 0; b < kBlocks; ++b) {
      const StripRows strip = strip_of(b);
      rows = std::max(rows, strip.end - strip.begin);
    }
    for (int t = -kWarmUpRows; t < rows; ++t) {
      start_strips(t);
      load_row(t);
      if (t < 0) {
        forwards<false>();
      } else {
        forwards<true>();
        backwards(t);
      }
    }
  }

 private:
  [[nodiscard]] HWY_INLINE StripRows strip_of(int block) const {
    return rows_of_strip(first_strip_ + block, H_);
  }
  [[nodiscard]] HWY_INLINE std::size_t stride() const { return R_ * N; }
  [[nodiscard]] HWY_INLINE int row_of(int block, int t) const {
    return std::clamp(strip_of(block).begin + t, 0, H_ - 1);
  }

  // A strip whose warm-up would begin above the picture begins at the picture's first row.
  HWY_INLINE void start_strips(int t) {
    for (int b = 0; b < kBlocks; ++b) {
      if (strip_of(b).begin + t != 0) continue;
      for (int x = 0; x < W_; ++x) {
        const std::size_t at = x;
        std::memset(above_least_ + at * N + b * kBlock, 0, kBlock);
        for (int j = 0; j < R_; ++j) {
          std::memset(above_ + at * stride() + j * N + b * kBlock, 0, kBlock);
        }
      }
    }
  }

  // Loads the codes of the rows: left_[plane][x] has one byte for each block; lane l of
  // right_[plane][q] is the code of the right pixel q - (R - 1) - first - l R.
  HWY_INLINE void load_row(int t) {
    for (std::size_t plane = 0; plane < 3; ++plane) {
      for (int b = 0; b < kBlocks; ++b) {
        const std::size_t block = b * kBlock;
        spread_right((*job_.right)[plane].row(row_of(b, t)),
                     right_ + plane * right_plane() + block);
      }
      zip_left(t, plane);
    }
    for (int b = 0; b < kBlocks; ++b) load_p2(row_of(b, t), b);
  }
  // Computes P2 of the steps to the row's pixels: one byte for each block.
  HWY_INLINE void load_p2(int y, int b) {
    const GrayImage& image = *job_.image;
    const std::uint8_t* here = image.row(y);
    const std::uint8_t* above = image.row(std::max(y - 1, 0));
    int before = here[0];
    for (int x = 0; x < W_; ++x) {
      p2_along_[x * kBlocks + b] = job_.penalties.p2_across(here[x] - before);
      p2_down_[x * kBlocks + b] = job_.penalties.p2_across(here[x] - above[x]);
      before = here[x];
    }
  }
  // Copies byte b of `bytes` to all lanes of block b.
  [[nodiscard]] HWY_INLINE V spread(const std::uint8_t* bytes) const {
    const Tag d;
    alignas(kWidestVector) static constexpr std::array<std::uint8_t, 64> kByteOfBlock =
        byte_of_block();
    return hn::TableLookupBytes(hn::LoadDup128(d, bytes), hn::Load(d, kByteOfBlock.data()));
  }
  [[nodiscard]] HWY_INLINE std::size_t left_plane() const { return (W_ + 2 * kBlock) * kBlocks; }
  HWY_INLINE void zip_left(int t, std::size_t plane) {
    const hn::FixedTag<std::uint8_t, 16> d16;
    std::uint8_t* to = left_ + plane * left_plane();
    const std::uint8_t* rows[4] = {};
    for (int b = 0; b < kBlocks; ++b) rows[b] = (*job_.left)[plane].row(row_of(b, t));
    int x = 0;
    if (kBlocks > 1) {
      for (; x + static_cast<int>(kBlock) <= W_; x += static_cast<int>(kBlock)) {
        const auto row = [&](int b) HWY_ATTR { return hn::LoadU(d16, rows[b % kBlocks] + x); };
        std::uint8_t* at = to + static_cast<std::size_t>(x) * kBlocks;
        const auto even = row(0);
        const auto odd = row(1);
        if (kBlocks == 2) {
          hn::StoreU(hn::InterleaveLower(d16, even, odd), d16, at);
          hn::StoreU(hn::InterleaveUpper(d16, even, odd), d16, at + kBlock);
          continue;
        }
        const auto two = row(2);
        const auto three = row(3);
        const auto e0 = hn::InterleaveLower(d16, even, two),
                   e1 = hn::InterleaveUpper(d16, even, two);
        const auto o0 = hn::InterleaveLower(d16, odd, three),
                   o1 = hn::InterleaveUpper(d16, odd, three);
        hn::StoreU(hn::InterleaveLower(d16, e0, o0), d16, at);
        hn::StoreU(hn::InterleaveUpper(d16, e0, o0), d16, at + kBlock);
        hn::StoreU(hn::InterleaveLower(d16, e1, o1), d16, at + 2 * kBlock);
        hn::StoreU(hn::InterleaveUpper(d16, e1, o1), d16, at + 3 * kBlock);
      }
    }
    for (; x < W_; ++x) {
      for (int b = 0; b < kBlocks; ++b) to[x * kBlocks + b] = rows[b][x];
    }
  }
  [[nodiscard]] HWY_INLINE std::size_t right_plane() const { return (W_ + R_ + kBlock) * N; }
  HWY_INLINE void spread_right(const std::uint8_t* codes, std::uint8_t* to) {
    const hn::FixedTag<std::uint8_t, 16> d16;
    // padded_[i] is the code of pixel i - (D - 1) - first, or that of the nearest border pixel.
    const int D = job_.disparities;
    const int length = W_ + D + 2 * static_cast<int>(kBlock);
    const int from = -(D - 1) - job_.first;
    const int begin = std::clamp(-from, 0, length);
    const int end = std::clamp(W_ - from, 0, length);
    std::memset(padded_, codes[0], begin);
    if (end > begin) { std::memcpy(padded_ + begin, codes + begin + from, end - begin); }
    std::memset(padded_ + end, codes[W_ - 1], length - end);
    const int count = W_ + R_ - 1;
    for (int q = 0; q < count; q += static_cast<int>(kBlock)) {
      // The index q - (R-1) - l R + D - 1 in padded_, where D = 16 R.
      hn::Vec<decltype(d16)> v[16];
      for (int l = 0; l < 16; ++l) { v[l] = hn::LoadU(d16, padded_ + q + (15 - l) * R_); }
      transpose_16(d16, v);
      for (std::size_t i = 0; i < 16; ++i) { hn::StoreU(v[i], d16, to + (q + i) * N); }
    }
  }

  // Writes the Hamming distances at x into slot x % 3 of raw_.
  HWY_INLINE void raw_costs(int x) {
    const Tag d;
    const std::size_t at = x;
    const std::uint8_t* left = left_ + at * kBlocks;
    const V l0 = spread(left);
    const V l1 = spread(left + left_plane());
    const V l2 = spread(left + 2 * left_plane());
    const std::uint8_t* right = right_ + (at + R_ - 1) * N;
    std::uint8_t* to = raw_ + (x % 3) * stride();
    const std::size_t plane = right_plane();
    for (int j = 0; j < R_; ++j) {
      const V c0 = hn::PopulationCount(hn::Xor(l0, hn::Load(d, right)));
      const V c1 = hn::PopulationCount(hn::Xor(l1, hn::Load(d, right + plane)));
      const V c2 = hn::PopulationCount(hn::Xor(l2, hn::Load(d, right + 2 * plane)));
      hn::Store(hn::Add(hn::Add(c0, c1), c2), d, to);
      to += N;
      right -= N;
    }
  }

  // From left to right: computes costs, the path from above and, if the row is needed, the path
  // from the left and the sum of both.
  template <bool kWanted>
  HWY_INLINE void forwards() {
    const Tag d;
    const V p1 = hn::Set(d, static_cast<std::uint8_t>(job_.penalties.p1));
    const int R = R_;
    V across_least = hn::Zero(d);
    if (kWanted) std::memset(across_, 0, stride());
    raw_costs(0);
    for (int x = 0; x < W_; ++x) {
      if (x + 1 < W_) raw_costs(x + 1);
      const auto slot = [&](int column) {
        return raw_ + (std::clamp(column, 0, W_ - 1) % 3) * stride();
      };
      const std::uint8_t* raw_before = slot(x - 1);
      const std::uint8_t* raw_here = slot(x);
      const std::uint8_t* raw_after = slot(x + 1);
      std::uint8_t* above = above_ + x * stride();
      std::uint8_t* costs = costs_ + x * stride();
      std::uint8_t* sum = sum_ + x * stride();
      std::uint8_t* least_at = above_least_ + x * N;
      Walk<Tag> down(d, above, R, hn::Load(d, least_at), spread(p2_down_ + x * kBlocks));
      Walk<Tag> along(d, kWanted ? across_ : above, R, across_least,
                      spread(p2_along_ + x * kBlocks));
      V least_down = hn::Set(d, std::uint8_t{255});
      V least_along = least_down;
      for (int j = 0; j < R; ++j) {
        const std::size_t at = j * N;
        const V sides = hn::AverageRound(hn::Load(d, raw_before + at), hn::Load(d, raw_after + at));
        const V cost = hn::AverageRound(sides, hn::Load(d, raw_here + at));
        const bool is_last = j + 1 == R;
        const V L = down.step(cost, is_last ? down.last : hn::Load(d, above + at + N), p1);
        least_down = hn::Min(least_down, L);
        hn::Store(L, d, above + at);
        if (kWanted) {
          const V A = along.step(cost, is_last ? along.last : hn::Load(d, across_ + at + N), p1);
          least_along = hn::Min(least_along, A);
          hn::Store(A, d, across_ + at);
          hn::Store(cost, d, costs + at);
          hn::Store(hn::Add(L, A), d, sum + at);
        }
      }
      hn::Store(least_of_block(d, least_down), d, least_at);
      if (kWanted) across_least = least_of_block(d, least_along);
    }
  }

  // From right to left: computes the path from the right, the complete sum, and its winner.
  HWY_INLINE void backwards(int t) {
    const Tag d;
    const V p1 = hn::Set(d, static_cast<std::uint8_t>(job_.penalties.p1));
    const int R = R_;
    V across_least = hn::Zero(d);
    std::memset(across_, 0, stride());
    for (int x = W_ - 1; x >= 0; --x) {
      const std::uint8_t* costs = costs_ + x * stride();
      std::uint8_t* sum = sum_ + x * stride();
      Walk<Tag> along(d, across_, R, across_least,
                      spread(p2_along_ + std::min(x + 1, W_ - 1) * kBlocks));
      V least_along = hn::Set(d, std::uint8_t{255});
      V best = least_along;
      V which = hn::Zero(d);
      V number = hn::Zero(d);
      const V one = hn::Set(d, std::uint8_t{1});
      for (int j = 0; j < R; ++j) {
        const std::size_t at = j * N;
        const bool is_last = j + 1 == R;
        const V A = along.step(hn::Load(d, costs + at),
                               is_last ? along.last : hn::Load(d, across_ + at + N), p1);
        least_along = hn::Min(least_along, A);
        hn::Store(A, d, across_ + at);
        const V S = hn::Add(hn::Load(d, sum + at), A);
        hn::Store(S, d, sum + at);
        which = hn::IfThenElse(hn::Lt(S, best), number, which);
        best = hn::Min(best, S);
        number = hn::Add(number, one);
      }
      across_least = least_of_block(d, least_along);
      store_winners(t, x, best, which, sum);
    }
  }

  HWY_INLINE void store_winners(int t, int x, V best, V which, const std::uint8_t* sum) {
    const Tag d;
    const V least = least_of_block(d, best);
    // If several lanes have the smallest sum, the lowest lane has the smallest d.
    alignas(kWidestVector) std::uint8_t winners[8 * ((N + 63) / 64) + 8];
    alignas(kWidestVector) std::uint8_t registers[N];
    alignas(kWidestVector) std::uint8_t costs[N];
    hn::StoreMaskBits(d, hn::Eq(best, least), winners);
    hn::Store(which, d, registers);
    hn::Store(least, d, costs);
    for (int b = 0; b < kBlocks; ++b) {
      const StripRows strip = strip_of(b);
      if (strip.begin + t >= strip.end) continue;
      std::uint16_t bits = 0;
      std::memcpy(&bits, winners + 2 * b, 2);
      const int lane = __builtin_ctz(bits);
      const std::size_t block = b * kBlock;
      const int j = registers[block + lane];
      const int best_d = lane * R_ + j;
      const auto S = [&](int l, int k) { return sum[k * N + block + l]; };
      Winners& out = *job_.winners;
      const int y = strip.begin + t;
      out.best(x, y) = static_cast<std::uint16_t>(best_d);
      out.cost(x, y) = costs[block];
      out.before(x, y) = j > 0      ? S(lane, j - 1)
                         : lane > 0 ? S(lane - 1, R_ - 1)
                                    : std::uint8_t{255};
      out.after(x, y) = j + 1 < R_  ? S(lane, j + 1)
                        : lane < 15 ? S(lane + 1, 0)
                                    : std::uint8_t{255};
    }
  }

  MatchJob job_;
  int first_strip_;
  int W_;
  int H_;
  int R_;
  std::uint8_t* costs_;
  std::uint8_t* above_;
  std::uint8_t* above_least_;
  std::uint8_t* sum_;
  std::uint8_t* left_;
  std::uint8_t* right_;
  std::uint8_t* raw_;
  std::uint8_t* across_;
  std::uint8_t* padded_;
  std::uint8_t* p2_along_;
  std::uint8_t* p2_down_;
};

template <std::size_t kBytes>
HWY_INLINE void run_gang(const MatchJob& job, int strip, std::uint8_t* workspace) {
  Gang<hn::CappedTag<std::uint8_t, kBytes>>(job, strip, workspace).run();
}

HWY_ATTR void match(const MatchJob& job, int first_strip, int count, std::uint8_t* workspace) {
  constexpr std::size_t kLanes = hn::MaxLanes(hn::ScalableTag<std::uint8_t>());
  int strip = first_strip;
  const int end = first_strip + count;
  while (strip < end) {
    if (kLanes >= 64 && end - strip >= 4) {
      run_gang<64>(job, strip, workspace);
      strip += 4;
    } else if (kLanes >= 32 && end - strip >= 2) {
      run_gang<32>(job, strip, workspace);
      strip += 2;
    } else {
      run_gang<16>(job, strip, workspace);
      strip += 1;
    }
  }
}

#endif  // HWY_SCALAR

}  // namespace palpable::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace palpable {
namespace {
HWY_EXPORT(census);
HWY_EXPORT(match);

std::vector<StereoKernels> find_kernels() {
  std::vector<StereoKernels> kernels;
  for_each_simd_target(hwy::SupportedAndGeneratedTargets(), [&](const char* name) {
    const RefineKernels chosen = chosen_refine_kernels();
    kernels.push_back({name, &HWY_DYNAMIC_DISPATCH(census), &HWY_DYNAMIC_DISPATCH(match),
                       chosen.refine, chosen.median, chosen.smooth});
  });
  kernels.push_back(scalar_stereo_kernels());
  return kernels;
}

// Initialised before main(), so that no frame allocates and no two threads initialise it at once.
const std::vector<StereoKernels> kKernels = find_kernels();

}  // namespace

std::size_t kernel_workspace_bytes(int width, int disparities) {
  return std::max({Workspace(width, disparities, kWidestVector).bytes, 5 * census_stride(width),
                   refine_workspace_bytes(2 * width + 1)});
}

std::span<const StereoKernels> stereo_kernels() { return kKernels; }

}  // namespace palpable

#endif
