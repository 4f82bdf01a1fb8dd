/// @file
/// The layout of --help. Separate from command_line.h because few files need it.
#pragma once

#include <memory>

namespace CLI {
class FormatterBase;
}  // namespace CLI

namespace palpable::app {

/// A formatter for a CLI::App and its later subcommands. No line is wider than 100 columns; the
/// limits of an option follow its text in brackets.
[[nodiscard]] std::shared_ptr<CLI::FormatterBase> help_format();

}  // namespace palpable::app
