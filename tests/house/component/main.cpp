// The version, and a mesh that needs core alone.
#include <cstring>

#include "lodestone/core/base/version.h"
#include "lodestone/core/mesh/generate.h"

#if !LODESTONE_VERSION_AT_LEAST(0, 2, 0) || LODESTONE_VERSION_AT_LEAST(1000, 0, 0)
#error "the version macros do not compare"
#endif

int main() {
  const auto mesh = lodestone::generate_mesh({.shape = lodestone::Shape::sphere, .triangles = 1000});
  return std::strcmp(LODESTONE_VERSION, FOUND_VERSION) == 0 && !mesh.triangles.empty() ? 0 : 1;
}
