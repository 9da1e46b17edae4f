#pragma once

#include "cairn/ar/augmenter.hpp"
#include "cairn/c_api/objects.h"

struct cairn_objects {
  cairn::Augmenter augmenter;
};
