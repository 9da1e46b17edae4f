// Compiled for each set of capacities: the constants of cairn/c_api/sizes.h against the trackers.

#include "core/src/c_api/handheld_object.hpp"
#include "core/src/c_api/vehicle_object.hpp"
#include "core/src/c_api/window_object.hpp"
