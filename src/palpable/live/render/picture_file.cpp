#include "palpable/live/render/picture_file.h"

#include "palpable/common/base/output_file.h"
#include "palpable/common/base/whole_file.h"

#include <fmt/core.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <png.h>
#include <string>
#include <vector>

namespace palpable {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

constexpr std::size_t kPixelBytes = 3;
constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 27;

/// The message of libpng's error handler. libpng reports an error by longjmp, so no object with a
/// destructor may be created between setjmp and the last call.
struct Complaint {
  std::string message;
};

void on_error(png_structp png, png_const_charp message) {
  static_cast<Complaint*>(png_get_error_ptr(png))->message = message;
  png_longjmp(png, 1);
}
void on_warning(png_structp /*png*/, png_const_charp /*message*/) {}

void append_bytes(png_structp png, png_bytep bytes, png_size_t count) {
  static_cast<std::string*>(png_get_io_ptr(png))
      ->append(reinterpret_cast<const char*>(bytes), count);
}
void flush_nothing(png_structp /*png*/) {}

/// Encodes rows of pixels as a PNG file in memory. @return false after an error of libpng
bool encode_rows(std::string& file, png_uint_32 width, png_uint_32 height, int color,
                 const std::vector<png_bytep>& rows, Complaint& complaint) {
  png_structp png =
      png_create_write_struct(PNG_LIBPNG_VER_STRING, &complaint, on_error, on_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  if (info == nullptr) {
    complaint.message = "out of memory";
    png_destroy_write_struct(&png, nullptr);
    return false;
  }
  if (setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &file, append_bytes, flush_nothing);
  // Compared with the default, level 3 takes a third of the time and makes files a tenth larger.
  png_set_compression_level(png, 3);
  png_set_IHDR(png, info, width, height, 8, color, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  png_write_image(png, const_cast<png_bytepp>(rows.data()));
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return true;
}

template <class T>
void write_image(const std::filesystem::path& path, const Image<T>& image, int color) {
  PALPABLE_EXPECT(!image.empty(), "a picture has pixels");
  std::vector<png_bytep> rows;
  for (int y = 0; y < image.height(); ++y) {
    // libpng only reads the rows, but its row pointers are not const.
    rows.push_back(reinterpret_cast<png_bytep>(const_cast<T*>(image.row(y))));
  }
  Complaint complaint;
  std::string bytes;
  if (!encode_rows(bytes, static_cast<png_uint_32>(image.width()),
                   static_cast<png_uint_32>(image.height()), color, rows, complaint)) {
    throw Error(fmt::format("{}: cannot be encoded: {}", path.string(), complaint.message));
  }
  write_whole_file(path, bytes);
}

/// A PNG as 8-bit RGB.
struct Raw {
  png_uint_32 width = 0;
  png_uint_32 height = 0;
  std::vector<png_byte> bytes;  // rows packed
};

bool read_rows(std::FILE* file, Raw& raw, std::vector<png_bytep>& rows, Complaint& complaint) {
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &complaint, on_error, on_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  if (info == nullptr) {
    complaint.message = "out of memory";
    png_destroy_read_struct(&png, nullptr, nullptr);
    return false;
  }
  if (setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_read_struct(&png, &info, nullptr);
    return false;
  }
  png_init_io(png, file);
  png_read_info(png, info);
  raw.width = png_get_image_width(png, info);
  raw.height = png_get_image_height(png, info);
  const png_byte color = png_get_color_type(png, info);
  if (std::uint64_t{raw.width} * raw.height > kMostPixels) {
    png_error(png, "more than 134 million pixels");
  }
  png_set_expand(png);
  png_set_scale_16(png);
  png_set_strip_alpha(png);
  if ((color & PNG_COLOR_MASK_COLOR) == 0) png_set_gray_to_rgb(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  if (png_get_rowbytes(png, info) != kPixelBytes * raw.width) png_error(png, "odd pixel format");
  raw.bytes.resize(kPixelBytes * raw.width * raw.height);
  rows.resize(raw.height);
  for (std::size_t y = 0; y < rows.size(); ++y) {
    rows[y] = raw.bytes.data() + y * kPixelBytes * raw.width;
  }
  png_read_image(png, rows.data());
  png_read_end(png, nullptr);
  png_destroy_read_struct(&png, &info, nullptr);
  return true;
}

Result<Raw> read_image(const std::filesystem::path& path) {
  if (const std::string why = why_no_file(path); !why.empty()) {
    return Problem{fmt::format("cannot read {}: {}", path.string(), why)};
  }
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) return Problem{fmt::format("cannot read {}: {}", path.string(), std::strerror(errno))};
  Raw raw;
  std::vector<png_bytep> rows;
  Complaint complaint;
  if (!read_rows(file.get(), raw, rows, complaint)) {
    return Problem{fmt::format("{} is not a readable PNG: {}", path.string(), complaint.message)};
  }
  return raw;
}

}  // namespace

void write_png(const std::filesystem::path& path, const ColorImage& picture) {
  static_assert(sizeof(Rgb) == 3);
  write_image(path, picture, PNG_COLOR_TYPE_RGB);
}

void write_png(const std::filesystem::path& path, const GrayImage& picture) {
  write_image(path, picture, PNG_COLOR_TYPE_GRAY);
}

Result<ColorImage> read_png(const std::filesystem::path& path) {
  const Result<Raw> raw = read_image(path);
  if (!raw.ok()) return raw.problem();
  ColorImage picture(static_cast<int>(raw.value().width), static_cast<int>(raw.value().height));
  std::memcpy(picture.data(), raw.value().bytes.data(), raw.value().bytes.size());
  return picture;
}

}  // namespace palpable
