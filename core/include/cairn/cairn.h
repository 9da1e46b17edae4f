#pragma once

/** @file
 * Cairn in C: camera tracking on a vehicle (cairn_vehicle_...) or of a hand-held camera
 * (cairn_window_...; cairn_handheld_... where memory is short or a map is to be saved), and
 * virtual objects (cairn_objects_...).
 *
 * Every object lies in memory that the caller provides; nothing is allocated. A call that can be
 * refused returns a cairn_status; on anything but CAIRN_OK the object is unchanged, unless the call
 * says otherwise. NULL where a pointer is needed gives CAIRN_INVALID_ARGUMENT. An object belongs to
 * one thread; two objects are independent. Frames of reference, units and conventions:
 * docs/explanation/architecture.md.
 *
 * An image has one set of capacities, chosen by the library that is linked (CMake: cairn::c,
 * cairn::c_tiny, cairn::c_large, which also define the macro that sizes.h looks at).
 */

#include "cairn/c_api/handheld.h"
#include "cairn/c_api/objects.h"
#include "cairn/c_api/sizes.h"
#include "cairn/c_api/types.h"
#include "cairn/c_api/vehicle.h"
#include "cairn/c_api/window.h"
#include "cairn/version.h"
