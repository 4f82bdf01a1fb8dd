#include "palpable/desk/film/texture_images.h"

#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/script/random.h"

#include <algorithm>
#include <cmath>

namespace palpable {

namespace {

std::uint32_t hash(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  std::uint32_t h = x * 0x8da6b343U ^ y * 0xd8163841U ^ seed * 0xcb1ab31fU;
  h ^= h >> 15;
  h *= 0x2c1b3c6dU;
  h ^= h >> 12;
  h *= 0x297a2d39U;
  return h ^ (h >> 15);
}

double lattice(int x, int y, std::uint32_t seed) {
  return hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), seed) * 0x1.0p-31 - 1.0;
}

int wrap(int i, int period) {
  i %= period;
  return i < 0 ? i + period : i;
}

/// Value noise in [-1, 1] over the unit square with nx x ny cells; periodic.
double noise(double u, double v, int nx, int ny, std::uint32_t seed) {
  const double x = u * nx;
  const double y = v * ny;
  const double fx = std::floor(x);
  const double fy = std::floor(y);
  const int x0 = wrap(static_cast<int>(fx), nx);
  const int y0 = wrap(static_cast<int>(fy), ny);
  const int x1 = wrap(x0 + 1, nx);
  const int y1 = wrap(y0 + 1, ny);
  const double s = x - fx;
  const double t = y - fy;
  const double a = s * s * (3 - 2 * s);
  const double b = t * t * (3 - 2 * t);
  const double top = lattice(x0, y0, seed) * (1 - a) + lattice(x1, y0, seed) * a;
  const double bottom = lattice(x0, y1, seed) * (1 - a) + lattice(x1, y1, seed) * a;
  return top * (1 - b) + bottom * b;
}

/// A sum of `count` noises, each twice as fine as the previous one and `gain` times as strong.
double octaves(double u, double v, int nx, int ny, int count, double gain, std::uint32_t seed) {
  double sum = 0.0;
  double weight = 1.0;
  for (int i = 0; i < count; ++i) {
    sum += weight * noise(u, v, nx << i, ny << i, seed + static_cast<std::uint32_t>(i) * 101U);
    weight *= gain;
  }
  return sum;
}

std::uint32_t stream(std::uint64_t seed, std::string_view name) {
  return static_cast<std::uint32_t>(Random(seed, name).next());
}

std::uint8_t level(double value) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

Rgb scaled(Rgb c, double factor) {
  return {level(c.r * factor), level(c.g * factor), level(c.b * factor)};
}

/// Prints rows of random words in a rectangle. Letters consist of strokes 1 to 2 px wide.
void print_words(ColorImage& image, int x0, int y0, int x1, int y1, int line, Rgb ink,
                 Random& random) {
  for (int y = y0; y + line <= y1; y += line) {
    const int end = random.unit() < 0.15 ? x0 + (x1 - x0) / 2 : x1;  // a paragraph ends
    int x = x0;
    while (x < end) {
      const int letters = 2 + static_cast<int>(random.between(0, 8));
      const int wide = std::max(2, line * 2 / 5);
      for (int k = 0; k < letters && x + wide < end; ++k, x += wide) {
        const std::uint64_t shape = random.next();
        const int tall = line * 3 / 5;
        for (int dy = 0; dy < tall; ++dy)
          for (int dx = 0; dx < wide - 1; ++dx) {
            // A letter is a 3 x 4 pattern of strokes.
            const int cell = (3 * dx / std::max(1, wide - 1)) + 3 * (4 * dy / tall);
            if (((shape >> cell) & 1U) != 0 && x + dx < image.width() && y + dy < image.height())
              image(x + dx, y + dy) = ink;
          }
      }
      x += wide;
    }
  }
}

void fill(ColorImage& image, int x0, int y0, int x1, int y1, Rgb color) {
  for (int y = std::max(0, y0); y < std::min(y1, image.height()); ++y)
    for (int x = std::max(0, x0); x < std::min(x1, image.width()); ++x) image(x, y) = color;
}

/// Multiplies each pixel by 1 + strength * fine noise, such as paper fibres, printing screen or
/// dust.
void roughen(ColorImage& image, double strength, std::uint32_t seed) {
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const double fine = lattice(x, y, seed);
      const double broad = lattice(x / 3, y / 3, seed + 7U);
      image(x, y) = scaled(image(x, y), 1.0 + strength * (0.6 * fine + 0.4 * broad));
    }
}

}  // namespace

ColorImage wood_image(int size, std::uint64_t seed) {
  const std::uint32_t s = stream(seed, "wood");
  ColorImage image(size, size);
  constexpr int kBoards = 7;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double u = static_cast<double>(x) / size;
      const double v = static_cast<double>(y) / size;
      const auto board = static_cast<int>(v * kBoards);
      const double across = v * kBoards - board;
      const double own = lattice(board, 17, s);
      const auto sb = s + static_cast<std::uint32_t>(board) * 977U;
      // Year rings: the board is a lengthwise section of a warped cone of rings.
      const double warp = octaves(u, v, 3, 10, 4, 0.5, sb);
      const double rings = std::sin(kTurn * (9.0 * (across + 0.15 * own) + 0.9 * warp));
      const double fibres = octaves(u, v, 24, 700, 2, 0.6, sb + 5U);
      const double pores = noise(u, v, 110, 1000, sb + 9U);
      const double blotch = octaves(u, v, 4, 8, 3, 0.5, s + 31U);
      double shade = 1.0 + 0.035 * rings + 0.085 * fibres + 0.05 * blotch + 0.09 * own;
      if (pores > 0.45) shade -= 0.35 * (pores - 0.45);
      const double edge = std::min(across, 1.0 - across) * size / kBoards;  // px to the joint
      if (edge < 2.0) shade *= 0.55 + 0.2 * edge;
      const double red = 1.0 + 0.02 * rings;
      image(x, y) = {level(168 * shade * red), level(134 * shade), level(102 * shade / red)};
    }
  return image;
}

ColorImage plaster_image(int size, std::uint64_t seed) {
  const std::uint32_t s = stream(seed, "plaster");
  ColorImage image(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double u = static_cast<double>(x) / size;
      const double v = static_cast<double>(y) / size;
      const double shade = 1.0 + 0.03 * octaves(u, v, 6, 6, 3, 0.5, s) +
                           0.045 * octaves(u, v, 200, 200, 2, 0.7, s + 3U);
      image(x, y) = {level(176 * shade), level(184 * shade), level(186 * shade)};
    }
  return image;
}

ColorImage page_image(int width, int height, std::uint64_t seed) {
  Random random(seed, "page");
  ColorImage image(width, height, Rgb{232, 230, 222});
  const int margin = width / 10;
  fill(image, margin, margin, width * 6 / 10, margin + height / 40, {70, 70, 78});
  print_words(image, margin, margin + height / 16, width - margin, height * 45 / 100, 14,
              {62, 62, 66}, random);
  // A diagram between the paragraphs.
  for (int i = 0; i < 9; ++i) {
    const int x = margin + i * (width - 2 * margin) / 9;
    const auto tall = static_cast<int>(random.between(0.04, 0.16) * height);
    fill(image, x, height * 64 / 100 - tall, x + width / 16, height * 64 / 100,
         {level(random.between(60, 200)), level(random.between(80, 180)),
          level(random.between(90, 210))});
  }
  print_words(image, margin, height * 68 / 100, width - margin, height - margin, 14, {62, 62, 66},
              random);
  roughen(image, 0.03, stream(seed, "fibres"));
  return image;
}

ColorImage book_image(int size, Rgb color, std::uint64_t seed) {
  Random random(seed, "book");
  ColorImage image(size, size, color);
  const int cover = size * 70 / 100;
  const int spine = size * 85 / 100;
  const Rgb light{235, 225, 200};
  fill(image, 0, 0, cover, size / 14, scaled(color, 0.7));
  // A picture of overlapping tiles on the cover.
  for (int i = 0; i < 70; ++i) {
    const auto x = static_cast<int>(random.between(0.06, 0.56) * size);
    const auto y = static_cast<int>(random.between(0.36, 0.84) * size);
    const auto w = static_cast<int>(random.between(0.02, 0.09) * size);
    const double tone = random.between(0.55, 1.5);
    fill(image, x, y, x + w, y + w,
         {level(color.r * tone), level(color.g * random.between(0.6, 1.6)), level(color.b * tone)});
  }
  print_words(image, size / 12, size / 9, cover - size / 12, size / 9 + size / 8, size / 18, light,
              random);
  print_words(image, size / 12, size * 27 / 100, cover - size / 12, size * 33 / 100, size / 44,
              light, random);
  fill(image, cover, 0, spine, size, scaled(color, 0.85));
  fill(image, cover, size / 10, spine, size / 10 + size / 60, light);
  fill(image, cover, size * 88 / 100, spine, size * 88 / 100 + size / 60, light);
  print_words(image, cover + size / 40, size / 6, spine - size / 60, size * 84 / 100, size / 20,
              light, random);
  for (int y = 0; y < size; ++y)  // the pages' edges: lines along the spine
    for (int x = spine; x < size; ++x) {
      const double shade = 0.86 + 0.10 * lattice(x, 3, 11U) + 0.03 * lattice(x, y / 40, 13U);
      image(x, y) = {level(228 * shade), level(220 * shade), level(200 * shade)};
    }
  roughen(image, 0.05, stream(seed, "print"));
  return image;
}

ColorImage carton_image(int size, Rgb color, std::uint64_t seed) {
  Random random(seed, "carton");
  ColorImage image(size, size, color);
  for (int i = 0; i < 26; ++i) {  // leaves
    const double cx = random.between(0.05, 0.95) * size;
    const double cy = random.between(0.4, 0.95) * size;
    const double a = random.between(0.03, 0.11) * size;
    const double turn = random.between(0, kTurn);
    const double tone = random.between(0.7, 1.5);
    const Rgb leaf{level(90 * tone), level(130 * tone), level(70 * tone)};
    for (int y = static_cast<int>(cy - a); y <= static_cast<int>(cy + a); ++y)
      for (int x = static_cast<int>(cx - a); x <= static_cast<int>(cx + a); ++x) {
        if (x < 0 || y < 0 || x >= size || y >= size) continue;
        const double p = std::cos(turn) * (x - cx) + std::sin(turn) * (y - cy);
        const double q = -std::sin(turn) * (x - cx) + std::cos(turn) * (y - cy);
        if (p * p / (a * a) + q * q / (0.12 * a * a) < 1.0)
          image(x, y) = scaled(leaf, std::abs(q) < 1.5 ? 0.6 : 1.0);
      }
  }
  fill(image, size / 10, size / 12, size * 9 / 10, size * 34 / 100, {240, 236, 220});
  print_words(image, size / 7, size / 9, size * 6 / 7, size * 22 / 100, size / 11, {60, 90, 60},
              random);
  print_words(image, size / 7, size * 24 / 100, size * 6 / 7, size * 33 / 100, size / 32,
              {90, 80, 60}, random);
  roughen(image, 0.05, stream(seed, "board"));
  return image;
}

ColorImage glaze_image(int size, std::uint64_t seed) {
  const std::uint32_t s = stream(seed, "glaze");
  ColorImage image(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double u = static_cast<double>(x) / size;
      const double v = static_cast<double>(y) / size;
      const double speckle = noise(u, v, 160, 120, s);
      const double wobble = 0.012 * octaves(u, v, 9, 2, 2, 0.5, s + 3U);
      const double shade = 1.0 + 0.04 * octaves(u, v, 60, 40, 2, 0.6, s + 9U);
      Rgb c{214, 206, 190};
      const double w = v + wobble;
      if ((w > 0.18 && w < 0.27) || (w > 0.72 && w < 0.76)) c = {48, 92, 128};
      if (w > 0.33 && w < 0.66) {  // painted dots between the bands
        const double du = u * 12 - std::floor(u * 12) - 0.5;
        const double dv = (w - 0.33) / 0.11 - std::floor((w - 0.33) / 0.11) - 0.5;
        const double r = std::hypot(du, dv);
        if (r < 0.30) c = {176, 78, 52};
        if (r < 0.13) c = {226, 190, 96};
      }
      if (speckle > 0.62) c = scaled(c, 0.62);
      image(x, y) = scaled(c, shade);
    }
  return image;
}

ColorImage skin_image(int size, double contrast, std::uint64_t seed) {
  const std::uint32_t s = stream(seed, "skin");
  ColorImage image(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double u = static_cast<double>(x) / size;
      const double v = static_cast<double>(y) / size;
      const double blotch = octaves(u, v, 5, 5, 3, 0.55, s);
      const double lines = octaves(u, v, 60, 90, 2, 0.7, s + 3U);
      const double pores = noise(u, v, 150, 150, s + 5U);
      const double shade = 1.0 + contrast * (0.035 * blotch + 0.040 * lines + 0.030 * pores);
      const double red = 1.0 + contrast * 0.02 * octaves(u, v, 7, 7, 2, 0.5, s + 7U);
      image(x, y) = {level(208 * shade * red), level(163 * shade), level(140 * shade / red)};
    }
  return image;
}

ColorImage tile_image(int size, std::uint64_t seed) {
  const std::uint32_t s = stream(seed, "tiles");
  ColorImage image(size, size);
  constexpr int kTiles = 4;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double u = static_cast<double>(x) / size;
      const double v = static_cast<double>(y) / size;
      const int i = x * kTiles / size;
      const int j = y * kTiles / size;
      double shade = 0.92 + 0.05 * lattice(i, j, s) + 0.06 * octaves(u, v, 9, 9, 4, 0.6, s + 1U);
      const double speckle = noise(u, v, 260, 260, s + 7U);
      if (speckle > 0.45) shade -= 0.22 * (speckle - 0.3);
      const int edge_x = std::min(x * kTiles % size, size - 1 - x * kTiles % size) / kTiles;
      const int edge_y = std::min(y * kTiles % size, size - 1 - y * kTiles % size) / kTiles;
      if (std::min(edge_x, edge_y) < size / 260) shade *= 0.6;
      image(x, y) = {level(158 * shade), level(150 * shade), level(140 * shade)};
    }
  return image;
}

ColorImage panel_image(int size, std::uint64_t seed) {
  const std::uint32_t s = stream(seed, "panel");
  ColorImage image(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double u = static_cast<double>(x) / size;
      const double v = static_cast<double>(y) / size;
      double shade = 0.95 + 0.05 * octaves(u, v, 5, 40, 3, 0.6, s);
      // Two doors side by side, each with a sunk panel.
      const double w = 2.0 * u - std::floor(2.0 * u);
      const double rim = std::min(std::min(w, 1.0 - w), std::min(v, 1.0 - v));
      if (rim < 0.02) shade *= 0.55;
      if (rim > 0.14 && rim < 0.16) shade *= 0.72;
      if (rim >= 0.16) shade *= 0.93;
      image(x, y) = {level(150 * shade), level(128 * shade), level(98 * shade)};
      if (std::abs(v - 0.5) < 0.06 && std::abs(w - (u < 0.5 ? 0.92 : 0.08)) < 0.012)
        image(x, y) = {60, 60, 64};
    }
  roughen(image, 0.04, stream(seed, "paint"));
  return image;
}

ColorImage pencil_image(int size, std::uint64_t seed) {
  Random random(seed, "pencil");
  ColorImage image(size, size, Rgb{206, 150, 44});
  for (int y = 0; y < size; ++y)  // six faces
    for (int x = 0; x < size; ++x) {
      const double face = 0.90 + 0.12 * lattice(6 * y / size, 1, 5U);
      image(x, y) = scaled(image(x, y), face);
    }
  fill(image, size / 20, 0, size / 9, size, {36, 60, 44});
  fill(image, size / 2, 0, size * 53 / 100, size, {36, 60, 44});
  print_words(image, size / 6, size / 12, size / 2, size / 4, size / 8, {40, 40, 36}, random);
  print_words(image, size * 6 / 10, size * 58 / 100, size, size * 3 / 4, size / 8, {40, 40, 36},
              random);
  roughen(image, 0.03, stream(seed, "lacquer"));
  return image;
}

ColorImage cloth_image(int size, std::uint64_t seed) {
  const std::uint32_t s = stream(seed, "cloth");
  ColorImage image(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double u = static_cast<double>(x) / size;
      const double v = static_cast<double>(y) / size;
      const double warp = lattice(x / 2, 0, s);
      const double weft = lattice(0, y / 2, s + 1U);
      const bool over = ((x / 2 + y / 2) % 3) != 0;
      const double shade = 0.92 + (over ? 0.10 : -0.10) + 0.07 * warp + 0.07 * weft +
                           0.08 * octaves(u, v, 8, 8, 3, 0.5, s + 2U);
      image(x, y) = {level(74 * shade), level(96 * shade), level(136 * shade)};
    }
  return image;
}

}  // namespace palpable
