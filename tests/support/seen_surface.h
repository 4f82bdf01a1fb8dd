/// @file
/// A surface of what presses, made of balls or of a depth image, for the tests of contact, which
/// itself knows no camera.
#pragma once

#include "palpable/live/seen_object/object_surface.h"
