/// @file
/// How --help looks. Apart from command_line.h, as both are read by few.
#pragma once

#include <memory>

namespace CLI {
class FormatterBase;
}  // namespace CLI

namespace palpable::app {

/// For a CLI::App, and its subcommands of later. No line is wider than 100 columns; what limits an
/// option stands behind its text, in brackets.
[[nodiscard]] std::shared_ptr<CLI::FormatterBase> help_format();

}  // namespace palpable::app
