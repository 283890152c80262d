// `lodestone view` in a build without the viewer.
#include "core/base/error.h"
#include "render/viewer/viewer.h"

namespace lodestone::viewer {

ViewerResult run_viewer(const ViewerConfig&, Scheduler&) {
  throw UnsupportedError(
      "the viewer was left out of this build; install libglfw3-dev and libimgui-dev and configure with "
      "LODESTONE_VIEWER=ON, or draw pictures without a window: lodestone render");
}

}  // namespace lodestone::viewer
