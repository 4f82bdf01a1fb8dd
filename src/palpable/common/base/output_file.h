/// @file
/// Writes files, and checks that files can be written later.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// How a file that may be there already is opened.
enum class Opening {
  kEmptied,  ///< it is emptied
  kNew,      ///< it is refused; a new one that gets no piece is removed again
  /// It is emptied when the first piece comes, so that work that fails before replaces nothing; it
  /// is refused while another process has it open as kNew or kAlone.
  kAlone,
};

/// A file that grows piece by piece, and whose write errors, such as a full disk, are reported at
/// once. A stream of the standard library reports them only when its buffer is full or when it is
/// closed, and never if its destructor closes it. Each piece is written as a whole or not at all:
/// on a full disk the file ends with the piece before, so that it can be read.
class GrowingFile {
 public:
  /// Opens the file and empties it. @throws Error "FILE: cannot be written: REASON", as all members
  explicit GrowingFile(const std::filesystem::path& path) : GrowingFile(path, path) {}
  /// @param called  the file's name in messages: that to which it will be renamed later
  GrowingFile(const std::filesystem::path& path, std::filesystem::path called);
  /// @throws Error also "FILE: is there already" and "FILE: another run is writing it ..."
  GrowingFile(const std::filesystem::path& path, Opening opening);
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;
  ~GrowingFile();

  /// After this call the operating system has the piece, so that it survives even if the program is
  /// killed.
  void append(std::string_view piece);
  void close();

 private:
  std::filesystem::path called_;
  Opening opening_ = Opening::kEmptied;
  int descriptor_ = -1;  // -1: closed
  bool has_piece_ = false;
  std::int64_t size_ = 0;
};

/// ".part-HOST-PID", with which the names of this process's unfinished files end: a file has such a
/// name until it is complete. Several processes on several machines may write the same file, each
/// under its own name.
[[nodiscard]] std::string own_part_suffix();

/// Whether the process that writes a file of this name still runs on this machine.
[[nodiscard]] bool is_part_of_running_process(std::string_view name);

/// Writes all bytes to a file descriptor; continues after a signal or a full pipe has cut a write
/// short. False if the other end is closed or at any other error, which is then in errno.
[[nodiscard]] bool write_all(int descriptor, std::span<const std::byte> bytes);

/// Checks that write_whole_file() could replace a file, before work of minutes or hours that would
/// be lost otherwise. Changes nothing.
/// @throws Error "FILE: cannot be written: REASON"
void expect_writable(const std::filesystem::path& file);

/// Whether `path` is `folder` or lies somewhere in it. Links are followed; neither needs to exist.
[[nodiscard]] bool lies_in(const std::filesystem::path& path, const std::filesystem::path& folder);

/// The file that writing to `file` has to replace so that a link stays a link: the target of the
/// symbolic links, whether it exists or not, or `file` itself if it is not a link.
[[nodiscard]] std::filesystem::path behind_links(const std::filesystem::path& file);

/// To be called before the work: refuses an output file that would destroy something else or could
/// not be written in the end. Empty inputs are skipped.
/// @param inputs  files and folders that the work reads
/// @throws Error when `output` is one of the inputs (by whatever path or link) or a file of an
///         input folder, is a folder, a device, a pipe or a socket, when its folder does not exist,
///         or as expect_writable()
void guard_output_file(const std::filesystem::path& output,
                       const std::vector<std::filesystem::path>& inputs);

/// The same for a folder, which need not exist; the one above it must.
/// @throws Error when `output` is an input, holds one, is a folder in one, or is a file
void guard_output_folder(const std::filesystem::path& output,
                         const std::vector<std::filesystem::path>& inputs);

/// Refuses a folder for results that is an input folder or lies in one: the next run would read
/// them as input. A new file beside the inputs' folders, or beside input files, is none of that.
/// @param inputs  files and folders; or "folder/*.png", files by name, which are in that folder but
///                not in those within it. Empty ones are skipped
/// @throws Error "FOLDER: is read by this run ..." or "FOLDER: lies in INPUT, which is ..."
void refuse_among_inputs(const std::filesystem::path& folder,
                         const std::vector<std::filesystem::path>& inputs);

/// FILE.part-1234: the name under which this process (number 1234) writes FILE until it is
/// complete. Another process that writes the same FILE uses another name.
[[nodiscard]] std::filesystem::path part_of(const std::filesystem::path& file);

/// Creates a folder and those above it, as far as they are missing.
/// @throws Error "FOLDER: cannot be made", with the reason
void make_folder(const std::filesystem::path& folder);

/// Replaces the content of a file by these pieces, one after the other. They are written to
/// part_of(file) first, which is then renamed to `file` and gets the former file's permissions:
/// readers find either the former or the complete new file, and after a failure the former one. A
/// link stays a link. A pipe or a device is written to directly.
/// @throws Error "FILE: cannot be written: REASON"
void write_whole_file(const std::filesystem::path& file,
                      std::initializer_list<std::string_view> pieces);
inline void write_whole_file(const std::filesystem::path& file, std::string_view bytes) {
  write_whole_file(file, {bytes});
}

}  // namespace palpable
