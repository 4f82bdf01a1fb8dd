#include "palpable/live/render/outlines.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/render/occlusion_bias.h"
#include "palpable/live/render/outline_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpable {
namespace {

constexpr float kNothing = 1e-3f;  // sum of weights below which a side has no votes

// Lattice pixels of a window in one row, rounded up to whole vector registers.
constexpr int kWindowColumns = OutlineWindow::kColumns;
static_assert(kWindowColumns >= 2 * RealOutlines::kWindow / RealOutlines::kLatticeStep + 1);

constexpr float kFactor = 1 + RealOutlines::kJump;

// Biases and links are natural logarithms of ratios of likelihoods. In the cut they are integers,
// in units of 1 / kUnits.
constexpr float kUnits = 256;
constexpr float kColorFloor = 0.03f;  // added to P_k; fits far below it have no effect
// Colours are compared by hue more than by brightness, which changes with shade.
constexpr float kLuma = 0.5f;     // weight of a grey level
constexpr float kHue = 400;       // weight of a difference of channels, as a ratio to brightness
constexpr float kDark = 32;       // grey levels added to brightness: hues of dark pixels are noise
constexpr float kMissed = 0.08f;  // share of moving pixels near a border that the mask misses
constexpr float kFalse = 0.5f;    // share of resting ones in the mask, which closes gaps and widens
// Share of moving votes behind the body above which something that moves there is known.
constexpr float kFarMoves = 0.03f;
// Terms of a bias, in natural logarithms:
constexpr float kMeasured = 0.5f;      // towards the side of a measured depth in doubt
constexpr float kSure = 0.2f;          // towards the side of a depth that is kDoubted
constexpr float kHalfSeenSays = 1.0f;  // towards the background's side, in half-seen strips
constexpr float kCloseSays = 2.0f;     // towards before the body, where marked too close
constexpr float kLink = 1.5f;          // link between neighbours of the same colour
constexpr float kLeastLink = 0.9f;  // of very different colours; four outweigh one pixel's colour
constexpr float kLinkReach = 30;    // difference of colours above which a link is kLeastLink
constexpr int kBodyReach = 6;       // px beside the body up to which pixels are classified as well

float total(const OutlineLanes& lanes) {
  float sum = 0;
  for (const float value : lanes) sum += value;
  return sum;
}

}  // namespace

void RealOutlines::find(const OutlineView& view) {
  const PixelBox &box = view.box, &inner = view.inner;
  PALPABLE_EXPECT(box.x >= 0 && box.y >= 0 && 2 * box.right() <= view.picture.width() &&
                      2 * box.bottom() <= view.picture.height(),
                  "the picture is twice as large as the depth image");
  PALPABLE_EXPECT(box.x <= inner.x && inner.x <= inner.right() && inner.right() <= box.right() &&
                      box.y <= inner.y && inner.y <= inner.bottom() &&
                      inner.bottom() <= box.bottom(),
                  "the inner box lies within the other");
  w_ = box.width;
  h_ = box.height;
  const std::size_t count = at(0, h_);
  PALPABLE_EXPECT(view.depth.size() >= count && view.guessed.size() >= count,
                  "depth and guesses fill a box");
  PALPABLE_EXPECT(view.body.size() >= 4 * static_cast<std::size_t>(inner.width) *
                                          static_cast<std::size_t>(inner.height),
                  "the body's depth fills the inner box at the picture's resolution");
  for (const MaskImage* mask : {view.moving, view.too_close}) {
    PALPABLE_EXPECT(mask == nullptr || mask->empty() ||
                        (mask->width() >= box.right() && mask->height() >= box.bottom()),
                    "masks have the size of the depth image");
  }
  assign_with_room(z_, count, 0.0f);
  assign_with_room(verdicts_, count, Verdict{});
  assign_with_room(growing_, count, 0);
  z_.assign(view.depth.begin(), view.depth.begin() + static_cast<std::ptrdiff_t>(count));
  const PixelBox own{inner.x - box.x, inner.y - box.y, inner.width, inner.height};
  const PixelBox voting = PixelBox::between(
      std::max(own.x - kBodyReach, 0), std::max(own.y - kBodyReach, 0),
      std::min(own.right() + kBodyReach, w_), std::min(own.bottom() + kBodyReach, h_));
  average_colors(view);
  read_masks(view);
  find_body(view, own, voting);
  find_doubts(view);
  build_lattice();
  if (!own.empty()) decide(view, voting);
  write_fine(view, own);
}

RealOutlines::Color RealOutlines::color_of(float red, float green, float blue) {
  const float luma = 0.3f * red + 0.6f * green + 0.1f * blue;
  const float scale = kHue / (luma + kDark);
  return {kLuma * luma, scale * (red - blue), scale * (red + blue - 2 * green)};
}

void RealOutlines::average_colors(const OutlineView& view) {
  assign_with_room(color_, at(0, h_), Color{});
  for (int y = 0; y < h_; ++y) {
    const Rgb* upper = view.picture.row(2 * (view.box.y + y)) + 2 * view.box.x;
    const Rgb* lower = view.picture.row(2 * (view.box.y + y) + 1) + 2 * view.box.x;
    Color* to = color_.data() + at(0, y);
    for (int x = 0; x < w_; ++x) {
      const Rgb &a = upper[2 * x], &b = upper[2 * x + 1], &c = lower[2 * x], &d = lower[2 * x + 1];
      to[x] = color_of(0.25f * static_cast<float>(a.r + b.r + c.r + d.r),
                       0.25f * static_cast<float>(a.g + b.g + c.g + d.g),
                       0.25f * static_cast<float>(a.b + b.b + c.b + d.b));
    }
  }
}

void RealOutlines::read_masks(const OutlineView& view) {
  const auto read = [&](const MaskImage* mask, std::vector<std::uint8_t>& to) {
    assign_with_room(to, at(0, h_), std::uint8_t{0});
    if (mask == nullptr || mask->empty()) return false;
    for (int y = 0; y < h_; ++y) {
      const std::uint8_t* from = mask->row(view.box.y + y) + view.box.x;
      for (int x = 0; x < w_; ++x) to[at(x, y)] = from[x] != 0 ? 1 : 0;
    }
    return true;
  };
  knows_moving_ = read(view.moving, moving_);
  read(view.too_close, close_);
  for (std::size_t i = 0; i < close_.size(); ++i) {
    if (knows_moving_) close_[i] &= moving_[i];  // a resting pixel marked too close is a mismatch
    if (close_[i] != 0) z_[i] = kTooClose;
  }
}

void RealOutlines::find_body(const OutlineView& view, const PixelBox& own, const PixelBox& voting) {
  const int w = voting.width, h = voting.height;
  assign_with_room(limit_, index(voting, 0, h), 0.0f);
  const auto stride = 2 * static_cast<std::size_t>(own.width);
  for (int y = 0; y < own.height; ++y) {
    const float* upper = view.body.data() + 2 * static_cast<std::size_t>(y) * stride;
    const float* lower = upper + stride;
    float* const to = limit_.data() + index(voting, own.x - voting.x, own.y - voting.y + y);
    for (int x = 0; x < own.width; ++x) {
      const float z = std::max(std::max(upper[2 * x], upper[2 * x + 1]),
                               std::max(lower[2 * x], lower[2 * x + 1]));
      to[x] = z > 0.0f ? std::max(z - 1.5f * glsl::occlusion_bias(z), 1e-3f) : 0.0f;
    }
  }
  // The body is extended by a few pixels, so that both sides of a hand's outline take part where it
  // runs along the body's. First along rows, then along columns.
  const auto spread = [&](int count, int length, std::size_t step, const auto& first) {
    for (int k = 0; k < count; ++k) {
      float* const line = limit_.data() + first(k);
      const auto pass = [&](int from, int to, int by) {
        float last = 0;
        int age = kBodyReach;
        for (int i = from; i != to; i += by) {
          float& here = line[static_cast<std::size_t>(i) * step];
          if (here > 0.0f) {
            last = here;
            age = 0;
          } else if (age < kBodyReach) {
            ++age;
            scratch_[static_cast<std::size_t>(i)] = last;
          }
        }
      };
      assign_with_room(scratch_, static_cast<std::size_t>(length), 0.0f);
      pass(0, length, 1);
      pass(length - 1, -1, -1);
      for (int i = 0; i < length; ++i) {
        float& here = line[static_cast<std::size_t>(i) * step];
        if (!(here > 0.0f)) here = scratch_[static_cast<std::size_t>(i)];
      }
    }
  };
  spread(h, w, 1, [&](int y) { return index(voting, 0, y); });
  spread(w, h, static_cast<std::size_t>(w), [](int x) { return static_cast<std::size_t>(x); });
}

void RealOutlines::find_doubts(const OutlineView& view) {
  const std::span<const signed char> guessed = view.guessed;
  assign_with_room(doubt_, at(0, h_), std::uint8_t{0});
  // Compares each pixel with the one at (dx, dy) from it. Branch-free, so that it is vectorised.
  const auto compare = [&](int dx, int dy, const auto& doubtful) {
    const int first = std::max(-dx, 0);
    const int last = w_ - std::max(dx, 0);
    for (int y = std::max(-dy, 0); y < h_ - std::max(dy, 0); ++y) {
      const float* z = z_.data() + at(0, y);
      const float* other_z = z_.data() + at(first + dx, y + dy) - first;
      const signed char* other_guessed = guessed.data() + at(first + dx, y + dy) - first;
      std::uint8_t* doubt = doubt_.data() + at(0, y);
      for (int x = first; x < last; ++x) {
        doubt[x] = static_cast<std::uint8_t>(
            doubt[x] |
            doubtful(z[x], other_z[x], other_guessed[x] != 0 && other_guessed[x] != kHalfSeen));
      }
    }
  };
  const auto farther = [](float z, float other, bool guess) {
    return static_cast<int>(other > kFactor * z) | static_cast<int>(guess);
  };
  const auto nearer = [](float z, float other, bool) {
    return static_cast<int>(z > kFactor * other);
  };
  for (int i = 1; i <= kDoubtLeft; ++i) compare(-i, 0, farther);
  for (int i = 1; i <= kDoubtRight; ++i) compare(i, 0, farther);
  for (int i = 1; i <= kDoubtAcross; ++i) {
    compare(0, -i, farther);
    compare(0, i, farther);
  }
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx != 0 || dy != 0) compare(dx, dy, nearer);
    }
  }
  for (std::size_t i = 0; i < doubt_.size(); ++i) {
    doubt_[i] |= static_cast<std::uint8_t>(guessed[i] != 0 || !(z_[i] > 0.0f));
  }
}

void RealOutlines::build_lattice() {
  Lattice& l = lattice_;
  l.width = (w_ + kLatticeStep - 1) / kLatticeStep + kWindowColumns;
  l.height = (h_ + kLatticeStep - 1) / kLatticeStep;
  const auto count = static_cast<std::size_t>(l.width) * static_cast<std::size_t>(l.height);
  for (std::vector<float>* plane : {&l.sure, &l.light, &l.warm, &l.pink, &l.inverse, &l.moving}) {
    assign_with_room(*plane, count, 0.0f);
  }
  for (int v = 0; v < l.height; ++v) {
    const auto row = static_cast<std::size_t>(v) * static_cast<std::size_t>(l.width);
    for (int u = 0; u * kLatticeStep < w_; ++u) {
      const std::size_t from = at(u * kLatticeStep, v * kLatticeStep);
      if (doubt_[from] != 0 && close_[from] == 0) continue;
      const std::size_t to = row + static_cast<std::size_t>(u);
      l.sure[to] = 1.0f;
      l.light[to] = color_[from].light;
      l.warm[to] = color_[from].warm;
      l.pink[to] = color_[from].pink;
      l.inverse[to] = 1.0f / z_[from];
      l.moving[to] = moving_[from];
    }
  }
}

RealOutlines::Verdict RealOutlines::of_window(int x, int y, float limit, signed char guess) const {
  const Lattice& l = lattice_;
  const int u0 = std::max((x - kWindow + kLatticeStep - 1) / kLatticeStep, 0);
  const int v0 = std::max((y - kWindow + kLatticeStep - 1) / kLatticeStep, 0);
  const int v1 = std::min((y + kWindow) / kLatticeStep, l.height - 1);
  const std::size_t first = static_cast<std::size_t>(v0) * static_cast<std::size_t>(l.width) +
                            static_cast<std::size_t>(u0);
  const std::size_t i = at(x, y);
  const Color c = color_[i];
  const OutlineWindow window{.sure = l.sure.data() + first,
                             .light = l.light.data() + first,
                             .warm = l.warm.data() + first,
                             .pink = l.pink.data() + first,
                             .inverse = l.inverse.data() + first,
                             .moving = l.moving.data() + first,
                             .stride = static_cast<std::size_t>(l.width),
                             .rows = v1 - v0 + 1,
                             .dx = static_cast<float>(u0 * kLatticeStep - x),
                             .dy = static_cast<float>(v0 * kLatticeStep - y),
                             .step = kLatticeStep,
                             .own_light = c.light,
                             .own_warm = c.warm,
                             .own_pink = c.pink};
  const OutlineSums sums = outline_kernels().front().sums(window, 1.0f / limit);
  const float near_weight = total(sums.near_weight);
  const float far_weight = total(sums.all_weight) - near_weight;
  const float near_inverse = total(sums.near_inverse), near_moving = total(sums.near_moving);
  const bool any_near = near_weight > kNothing, any_far = far_weight > kNothing;
  Verdict verdict;
  if (any_near) verdict.near_depth = near_weight / near_inverse;
  if (any_far) verdict.far_depth = far_weight / (total(sums.all_inverse) - near_inverse);
  if (any_near && any_far) {
    const float near_fit = total(sums.near_fit);
    const float far_fit = std::max(total(sums.all_fit) - near_fit, 0.0f);
    verdict.bias =
        std::log((near_fit / near_weight + kColorFloor) / (far_fit / far_weight + kColorFloor));
  }
  if (knows_moving_) {
    const float near_moves = any_near ? near_moving / near_weight : 1.0f;
    const float far_moves =
        any_far ? std::max(total(sums.all_moving) - near_moving, 0.0f) / far_weight : 0.0f;
    const auto likelihood = [&](float moves) {
      const float marked = kFalse + (1.0f - kFalse - kMissed) * moves;
      return moving_[i] != 0 ? marked : 1.0f - marked;
    };
    if (any_near || far_moves <= kFarMoves) {
      verdict.bias += std::log(likelihood(near_moves) / likelihood(far_moves));
    } else {
      verdict.bias -= kMeasured;  // a hole in what moves behind the body
    }
  }
  if (close_[i] != 0) verdict.bias += kCloseSays;
  const bool near = z_[i] > 0.0f && z_[i] < limit;
  const float says = doubt_[i] == kDoubted ? kSure : guess == kHalfSeen ? kHalfSeenSays : kMeasured;
  if (guess == 0 || guess == kHalfSeen || !knows_moving_) verdict.bias += near ? says : -says;
  return verdict;
}

// Finds the pixels that the cut classifies, and their biases.
void RealOutlines::find_voters(const OutlineView& view, const PixelBox& voting) {
  const int w = voting.width, h = voting.height;
  const auto find_bias = [&](int x, int y) {
    const std::size_t k = index(voting, x, y);
    verdicts_[k] = of_window(voting.x + x, voting.y + y, limit_[k],
                             view.guessed[at(voting.x + x, voting.y + y)]);
  };
  growing_.clear();
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      if (role(voting, x, y) != Role::kVoter) continue;
      find_bias(x, y);
      growing_.push_back(y * w + x);
    }
  }
  // A sure neighbour on the other side than a pixel's bias takes part as well; if its own bias
  // contradicts its depth, so do its neighbours.
  for (std::size_t next = 0; next < growing_.size(); ++next) {
    const int x = growing_[next] % w, y = growing_[next] / w;
    const bool before = verdicts_[static_cast<std::size_t>(growing_[next])].bias > 0;
    const auto visit = [&](int u, int v) {
      if (u < 0 || v < 0 || u >= w || v >= h) return;
      if (role(voting, u, v) != (before ? Role::kBehind : Role::kBefore)) return;
      doubt_[at(voting.x + u, voting.y + v)] = kDoubted;
      find_bias(u, v);
      const int k = v * w + u;
      if ((verdicts_[static_cast<std::size_t>(k)].bias > 0) == before) growing_.push_back(k);
    };
    visit(x - 1, y);
    visit(x + 1, y);
    visit(x, y - 1);
    visit(x, y + 1);
  }
}

// Gives the cut the pixels' biases and the links between neighbours.
void RealOutlines::link_pixels(const PixelBox& voting) {
  const auto units = [](float nats) { return static_cast<int>(std::lround(kUnits * nats)); };
  const auto link = [&](std::size_t i, std::size_t j) {
    const Color &a = color_[i], &b = color_[j];
    const float light = a.light - b.light, warm = a.warm - b.warm, pink = a.pink - b.pink;
    const float away = light * light + warm * warm + pink * pink;
    const float share = std::max(1.0f - away / (kLinkReach * kLinkReach), 0.0f);
    return units(kLeastLink + (kLink - kLeastLink) * share * share);
  };
  for (int y = 0; y < voting.height; ++y) {
    for (int x = 0; x < voting.width; ++x) {
      const Role here = role(voting, x, y);
      if (here == Role::kNone) continue;
      const std::size_t i = at(voting.x + x, voting.y + y);
      if (here == Role::kVoter) { cut_.add_bias(x, y, units(verdicts_[index(voting, x, y)].bias)); }
      const auto join = [&](int u, int v, std::size_t j, const auto& link_both) {
        const Role there = role(voting, u, v);
        if (there == Role::kNone) return;
        const bool both = here == Role::kVoter && there == Role::kVoter;
        if (both) {
          link_both(link(i, j));
        } else if (here == Role::kVoter) {
          cut_.add_bias(x, y, there == Role::kBefore ? link(i, j) : -link(i, j));
        } else if (there == Role::kVoter) {
          cut_.add_bias(u, v, here == Role::kBefore ? link(i, j) : -link(i, j));
        }
      };
      if (x + 1 < voting.width) {
        join(x + 1, y, i + 1, [&](int cost) { cut_.link_right(x, y, cost); });
      }
      if (y + 1 < voting.height) {
        join(x, y + 1, i + static_cast<std::size_t>(w_),
             [&](int cost) { cut_.link_down(x, y, cost); });
      }
    }
  }
}

void RealOutlines::decide(const OutlineView& view, const PixelBox& voting) {
  cut_.begin(voting.width, voting.height);
  find_voters(view, voting);
  link_pixels(voting);
  cut_.solve();
  for (int y = 0; y < voting.height; ++y) {
    for (int x = 0; x < voting.width; ++x) {
      if (role(voting, x, y) != Role::kVoter) continue;
      const std::size_t k = index(voting, x, y);
      float& z = z_[at(voting.x + x, voting.y + y)];
      const bool before = cut_.side(x, y);
      if (before == (z > 0.0f && z < limit_[k])) continue;
      const Verdict& verdict = verdicts_[k];
      z = before ? (verdict.near_depth > 0.0f ? verdict.near_depth : kTooClose) : verdict.far_depth;
    }
  }
}

void RealOutlines::write_fine(const OutlineView& view, const PixelBox& inner) {
  constexpr int kReach = 2;  // px of the depth image: the window of a side's mean colour
  const std::size_t stride = 2 * static_cast<std::size_t>(inner.width);
  assign_with_room(fine_, stride * 2 * static_cast<std::size_t>(inner.height), 0.0f);
  for (int y = inner.y; y < inner.bottom(); ++y) {
    for (int x = inner.x; x < inner.right(); ++x) {
      const float z = z_[at(x, y)];
      float* upper =
          fine_.data() + static_cast<std::size_t>(2 * (y - inner.y)) * stride + 2 * (x - inner.x);
      float* lower = upper + stride;
      upper[0] = upper[1] = lower[0] = lower[1] = z;
      if (x < kReach || y < kReach || x + kReach >= w_ || y + kReach >= h_ || !(z > 0.0f)) continue;
      float low = z, high = z;
      for (const std::size_t i : {at(x - 1, y), at(x + 1, y), at(x, y - 1), at(x, y + 1)}) {
        if (!(z_[i] > 0.0f)) continue;
        low = std::min(low, z_[i]);
        high = std::max(high, z_[i]);
      }
      if (!(high > kFactor * low)) continue;
      const float split = 0.5f / low + 0.5f / high;  // 1/m; `low` and `high` lie on either side
      std::array<Color, 2> mean{};
      std::array<float, 2> count{};
      for (int v = y - kReach; v <= y + kReach; ++v) {
        for (int u = x - kReach; u <= x + kReach; ++u) {
          const float other = z_[at(u, v)];
          if (!(other > 0.0f)) continue;
          const std::size_t side = split * other < 1.0f ? 0 : 1;
          const Color& c = color_[at(u, v)];
          mean[side].light += c.light;
          mean[side].warm += c.warm;
          mean[side].pink += c.pink;
          count[side] += 1;
        }
      }
      const auto away = [&](const Color& c, std::size_t side) {
        const float light = c.light - mean[side].light / count[side];
        const float warm = c.warm - mean[side].warm / count[side];
        const float pink = c.pink - mean[side].pink / count[side];
        return light * light + warm * warm + pink * pink;
      };
      for (int k = 0; k < 4; ++k) {
        const Rgb& p = view.picture(2 * (view.box.x + x) + k % 2, 2 * (view.box.y + y) + k / 2);
        const Color c = color_of(p.r, p.g, p.b);
        float* row = k < 2 ? upper : lower;
        row[k % 2] = away(c, 0) <= away(c, 1) ? low : high;
      }
    }
  }
}

}  // namespace palpable
