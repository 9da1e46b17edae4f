#pragma once

/* The version, in C and C++. This is the one place where it stands: CMake reads it, and the package
   files are compared with it by tests. */

#define CAIRN_VERSION_MAJOR 0
#define CAIRN_VERSION_MINOR 2
#define CAIRN_VERSION_PATCH 0

#define CAIRN_DETAIL_TEXT_OF(x) #x
#define CAIRN_DETAIL_DOTTED(a, b, c) \
  CAIRN_DETAIL_TEXT_OF(a) "." CAIRN_DETAIL_TEXT_OF(b) "." CAIRN_DETAIL_TEXT_OF(c)

/** "MAJOR.MINOR.PATCH". */
#define CAIRN_VERSION_STRING \
  CAIRN_DETAIL_DOTTED(CAIRN_VERSION_MAJOR, CAIRN_VERSION_MINOR, CAIRN_VERSION_PATCH)

/** For comparison by the preprocessor: 0.2.1 is 201. */
#define CAIRN_VERSION \
  (CAIRN_VERSION_MAJOR * 10000 + CAIRN_VERSION_MINOR * 100 + CAIRN_VERSION_PATCH)
