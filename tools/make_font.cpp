// make_font FONT.ttf OUT.cpp: renders the letters of a TrueType font at the sizes used in pictures
// and writes them as a C++ table (src/palpable/live/render/text.h). Runs during the build, so that
// the program needs neither a font file nor a font library.

#define STB_TRUETYPE_IMPLEMENTATION
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stb/stb_truetype.h>
#include <string>
#include <vector>

namespace {

constexpr int kSizes[] = {10, 11, 12, 13, 14, 16, 18, 21, 24, 28, 34, 42};

// ASCII, then signs of technical captions: degree, square, cubed, micro, middle dot, multiply.
std::vector<int> letters() {
  std::vector<int> all;
  for (int c = 32; c < 127; ++c) all.push_back(c);
  for (const int c : {0xb0, 0xb1, 0xb2, 0xb3, 0xb5, 0xb7, 0xd7}) all.push_back(c);
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  std::ifstream in(argv[1], std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), {});
  stbtt_fontinfo font;
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  if (bytes.empty() || stbtt_InitFont(&font, data, stbtt_GetFontOffsetForIndex(data, 0)) == 0) {
    std::fprintf(stderr, "make_font: %s is not a TrueType font\n", argv[1]);
    return 1;
  }
  std::string glyphs, sizes, ink;
  int first = 0;
  long offset = 0;
  for (const int size : kSizes) {
    const float scale = stbtt_ScaleForMappingEmToPixels(&font, static_cast<float>(size));
    int ascent = 0, descent = 0, gap = 0;
    stbtt_GetFontVMetrics(&font, &ascent, &descent, &gap);
    for (const int c : letters()) {
      int advance = 0, bearing = 0, x0 = 0, y0 = 0, x1 = 0, y1 = 0;
      stbtt_GetCodepointHMetrics(&font, c, &advance, &bearing);
      stbtt_GetCodepointBitmapBox(&font, c, scale, scale, &x0, &y0, &x1, &y1);
      const int w = x1 - x0, h = y1 - y0;
      std::vector<unsigned char> bitmap(static_cast<std::size_t>(w * h));
      if (!bitmap.empty()) {
        stbtt_MakeCodepointBitmap(&font, bitmap.data(), w, h, w, scale, scale, c);
      }
      char line[160];
      std::snprintf(line, sizeof line, "{%d, %d, %d, %d, %d, %.3ff, %ld},\n", c, x0, y0, w, h,
                    static_cast<double>(scale) * advance, offset);
      glyphs += line;
      for (const unsigned char value : bitmap) ink += std::to_string(value) + ",";
      ink += "\n";
      offset += w * h;
    }
    char line[120];
    std::snprintf(line, sizeof line, "{%d, %.3ff, %.3ff, %d, %d},\n", size,
                  static_cast<double>(scale) * ascent, static_cast<double>(scale) * -descent, first,
                  static_cast<int>(letters().size()));
    sizes += line;
    first += static_cast<int>(letters().size());
  }
  std::ofstream out(argv[2]);
  out << "// Written by tools/make_font.cpp.\n#include \"palpable/live/render/font_table.h\"\n"
      << "namespace palpable::detail {\nnamespace {\n"
      << "constexpr Glyph kGlyphs[] = {\n"
      << glyphs << "};\n"
      << "constexpr FontSize kSizes[] = {\n"
      << sizes << "};\n"
      << "constexpr unsigned char kInk[] = {\n"
      << ink << "};\n}  // namespace\n"
      << "FontTable font_table() { return {kGlyphs, kSizes, kInk}; }\n"
      << "}  // namespace palpable::detail\n";
  return out.good() ? 0 : 1;
}
