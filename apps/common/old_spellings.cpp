#include "apps/common/command_line.h"

#include <array>

namespace palpable::app {
namespace {

constexpr std::array kOldSpellings{
    OldSpelling{"bake", "--at", "--set NAME=VALUE"},
    OldSpelling{"bake", "--method", "--intrusive"},
    OldSpelling{"reduce", "--at", "--set NAME=VALUE"},
    OldSpelling{"reduce", "--error", "--tolerance"},
    OldSpelling{"reduce", "-e", "--tolerance"},
    OldSpelling{"reduce", "--modes", "--max-modes"},
    OldSpelling{"reduce", "-n", "--max-modes"},
    OldSpelling{"compare", "--at", "--set NAME=VALUE"},
    OldSpelling{"compare", "--error", "--tolerance"},
    OldSpelling{"compare", "-e", "--tolerance"},
    OldSpelling{"compare", "--modes", "--max-modes"},
    OldSpelling{"compare", "-n", "--max-modes"},
    OldSpelling{"solve", "--pose", "--poses"},
    OldSpelling{"truth", "--baked", "--body"},
    OldSpelling{"import-modes", "--site", "--site-parameter"},
    OldSpelling{"import-modes", "--level", "--level-parameter"},
    OldSpelling{"calibrate", "--output", "--out"},
    OldSpelling{"calibrate", "--views", "--boards"},
};

}  // namespace

std::span<const OldSpelling> old_spellings() { return kOldSpellings; }

}  // namespace palpable::app
