#pragma once

#include <stdint.h>

#include "../bare_metal/image.h"

#define REGISTER32(address) (*(volatile uint32_t*)(address))
