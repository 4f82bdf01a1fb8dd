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
    OldSpelling{"scan", "--depth", "--stereo-size half|full|auto or --depth-source DEVICE|IMAGES"},
    OldSpelling{"live", "--depth", "--stereo-size half|full|auto or --depth-source DEVICE|IMAGES"},
    OldSpelling{"live", "--scene", "the file alone, as in palpable live desk.toml"},
    OldSpelling{"live", "--at", "--at-pixel X,Y"},
    OldSpelling{"live", "--distance", "--paper-distance"},
    OldSpelling{"live", "--views", "--view"},
    OldSpelling{"live", "--no-masks", "--write=-masks"},
    OldSpelling{"live", "--no-depth", "--write=-depth"},
    OldSpelling{"live", "--meshes", "--write +meshes"},
    OldSpelling{"live", "--pictures", "--write +stills"},
    OldSpelling{"replay", "--views", "--view"},
    OldSpelling{"replay", "--no-masks", "--write=-masks"},
    OldSpelling{"replay", "--no-depth", "--write=-depth"},
    OldSpelling{"replay", "--meshes", "--write +meshes"},
    OldSpelling{"replay", "--pictures", "--write +stills"},
};

}  // namespace

std::span<const OldSpelling> old_spellings() { return kOldSpellings; }

}  // namespace palpable::app
