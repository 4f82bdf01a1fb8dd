/// @file
/// Writes files, and checks that files can be written later.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string_view>
#include <vector>

namespace palpable {

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
