// The version of Lodestone, here and nowhere else: CMake reads it from this file. A minor version before 1.0 may change
// what is included and called; a patch does not.
#pragma once

#define LODESTONE_VERSION_MAJOR 0
#define LODESTONE_VERSION_MINOR 2
#define LODESTONE_VERSION_PATCH 0

#define LODESTONE_TEXT_OF(number) #number
#define LODESTONE_VERSION_TEXT(major, minor, patch) \
  LODESTONE_TEXT_OF(major) "." LODESTONE_TEXT_OF(minor) "." LODESTONE_TEXT_OF(patch)
// "0.2.0"
#define LODESTONE_VERSION \
  LODESTONE_VERSION_TEXT(LODESTONE_VERSION_MAJOR, LODESTONE_VERSION_MINOR, LODESTONE_VERSION_PATCH)

// For the preprocessor: true of this version and of later ones.
#define LODESTONE_VERSION_AT_LEAST(major, minor, patch)                                            \
  (LODESTONE_VERSION_MAJOR * 1000000 + LODESTONE_VERSION_MINOR * 1000 + LODESTONE_VERSION_PATCH >= \
   (major)*1000000 + (minor)*1000 + (patch))
