/// @file
/// Tools shared by the readers of surface files (other code includes mesh_file.h): text by lines
/// and words, bytes by numbers, and the triangles read so far.
#pragma once

#include "palpable/common/base/bit_cast.h"

#include <Eigen/Core>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable::surface_files {

static_assert(std::endian::native == std::endian::little, "binary meshes are read as they lie");

/// Thrown by the readers of this folder only; parse_surface() turns it into a Problem.
struct Bad {
  std::string where;  // "line 12" or "byte 340"; empty: `what` says it
  std::string what;
};

/// The text as plain_text(); `kept` holds it if it differs from `bytes`. @throws Bad for no text
std::string_view plain(std::string_view bytes, std::string& kept);

/// A surface while it is being read.
struct Soup {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  std::vector<double> values;  // of the vertices, if a property was requested

  void add_fan(const std::vector<int>& polygon) {
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      triangles.emplace_back(polygon[0], polygon[k - 1], polygon[k]);
    }
  }
};

/// The words of a line, one after another; empty after the last.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}

  std::string_view next() {
    const std::size_t begin = rest_.find_first_not_of(" \t\r\v\f");
    if (begin == std::string_view::npos) return rest_ = {};
    rest_.remove_prefix(begin);
    const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t\r\v\f"));
    rest_.remove_prefix(word.size());
    return word;
  }

 private:
  std::string_view rest_;
};

/// The lines of a text, counted.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    ++number_;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    return true;
  }

  /// The next line with content: comments (from `comment` on) and blank lines are skipped.
  bool next_content(std::string_view& line, char comment) {
    while (next(line)) {
      line = line.substr(0, line.find(comment));
      if (!Words(line).next().empty()) return true;
    }
    return false;
  }

  [[noreturn]] void bad(const std::string& what) const {
    throw Bad{fmt::format("line {}", number_), what};
  }

  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// @throws Bad naming the line when the word is no finite number, count or index
double coordinate(Lines& lines, std::string_view word);
Eigen::Vector3d point(Lines& lines, Words& words);
/// @param shortest  bytes that each of the things takes at least in the rest of the file
std::size_t count_of(Lines& lines, std::string_view word, const char* what, std::size_t shortest);
int index_in(Lines& lines, std::string_view word, std::size_t count);

/// Reads numbers from the bytes of a file. @throws Bad naming the byte if the file is cut short
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  T get(bool swap = false) {
    need(sizeof(T));
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    if (swap) std::reverse(raw.begin(), raw.end());
    at_ += sizeof(T);
    return bit_cast<T>(raw);
  }

  void skip(std::size_t count) {
    need(count);
    at_ += count;
  }

  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] std::size_t at() const { return at_; }
  [[noreturn]] void bad(const std::string& what) const {
    throw Bad{fmt::format("byte {}", at_), what};
  }

 private:
  void need(std::size_t count) const {
    if (left() < count) bad("the file is cut short");
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
};

/// @throws Bad if a coordinate is not a finite number
Eigen::Vector3d finite_point(Bytes& bytes, double x, double y, double z);

/// Why a file is not read, by its first bytes and its size; empty: nothing is wrong so far.
std::string why_no_stl(std::string_view first, std::size_t size);
std::string why_no_ply(std::string_view first, std::size_t size);
std::string why_no_3ds(std::string_view first, std::size_t size);

/// Parse the whole content of a file. @throws Bad with the position of an error
Soup parse_off(std::string_view bytes);
Soup parse_obj(std::string_view bytes);
Soup parse_stl(std::string_view data);  ///< text or binary
/// Text or binary, either endianness. @param property  of the vertices; goes to Soup::values
Soup parse_ply(std::string_view bytes, std::string_view property = {});
Soup parse_3ds(std::string_view data);

}  // namespace palpable::surface_files
