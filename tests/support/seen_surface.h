/// @file
/// A surface of obstacles made of balls or of a depth image, for tests of contact, which itself
/// does not depend on a camera.
#pragma once

#include "palpable/live/seen_object/object_surface.h"
