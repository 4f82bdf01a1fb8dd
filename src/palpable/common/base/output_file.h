/// @file
/// Writes files, and checks that files can be written later.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string_view>
#include <vector>

namespace palpable {

/// Tries whether write_whole_file() could replace a file, before work of minutes or hours that
/// would be lost if it could not. Nothing is changed.
/// @throws Error "FILE: cannot be written: REASON"
void expect_writable(const std::filesystem::path& file);

/// Whether `path` is `folder` or lies somewhere in it; links are followed, nothing need exist.
[[nodiscard]] bool lies_in(const std::filesystem::path& path, const std::filesystem::path& folder);

/// The file that writing to `file` has to replace: what stands behind symbolic links, whether it
/// exists or not, so that a link stays a link. `file` itself where it is none.
[[nodiscard]] std::filesystem::path behind_links(const std::filesystem::path& file);

/// For a check before the work: refuses an output file that would destroy something else or cannot
/// be written in the end. Empty inputs are passed over.
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

/// FILE.part-1234: where this process lets FILE grow until it is whole. Another one that writes the
/// same FILE has its own.
[[nodiscard]] std::filesystem::path part_of(const std::filesystem::path& file);

/// Makes a folder and those above it where they are missing.
/// @throws Error "FOLDER: cannot be made", with the reason
void make_folder(const std::filesystem::path& folder);

/// Replaces a file by these pieces, one behind the other. They go to part_of(file) first, which
/// then takes the place and the permissions of what was there: who looks finds the former file or
/// the whole new one, and where it fails, the former one. A link stays a link. What is no ordinary
/// file (a pipe, a device) is written as it is.
/// @throws Error "FILE: cannot be written: REASON"
void write_whole_file(const std::filesystem::path& file,
                      std::initializer_list<std::string_view> pieces);
inline void write_whole_file(const std::filesystem::path& file, std::string_view bytes) {
  write_whole_file(file, {bytes});
}

}  // namespace palpable
