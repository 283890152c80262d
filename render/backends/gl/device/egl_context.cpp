// Contexts without a window, from EGL.
#include <dlfcn.h>
#include <epoxy/egl.h>

#include <array>
#include <functional>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "render/backends/gl/device/context.h"
#include "render/backends/gl/device/device.h"

namespace lodestone {
namespace {

#ifdef NDEBUG
constexpr EGLint debug_context = EGL_FALSE;
#else
constexpr EGLint debug_context = EGL_TRUE;
#endif

// An initialised display. EGL hands out the same one for the same platform and ends it for everybody at once: the
// contexts of a process count themselves, and the last one ends it.
class EglDisplay {
 public:
  explicit EglDisplay(EGLDisplay handle) : handle_(handle) {
    const std::lock_guard lock(users().mutex);
    int& count = users().of[handle];
    if (count == 0 && !eglInitialize(handle, nullptr, nullptr)) throw UnsupportedError("no driver can open it");
    ++count;
  }
  ~EglDisplay() {
    const std::lock_guard lock(users().mutex);
    if (--users().of[handle_] == 0) eglTerminate(handle_);
  }
  EglDisplay(const EglDisplay&) = delete;
  EglDisplay& operator=(const EglDisplay&) = delete;

  [[nodiscard]] EGLDisplay handle() const { return handle_; }
  [[nodiscard]] bool has(const char* extension) const { return epoxy_has_egl_extension(handle_, extension); }

 private:
  struct Users {
    std::mutex mutex;
    std::map<EGLDisplay, int> of;
  };
  static Users& users() {
    static Users all;
    return all;
  }
  EGLDisplay handle_;
};

EGLConfig choose_config(const EglDisplay& display) {
  if (display.has("EGL_KHR_no_config_context")) return EGL_NO_CONFIG_KHR;
  const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(display.handle(), wanted.data(), &config, 1, &count) || count == 0)
    throw UnsupportedError("no configuration for OpenGL");
  return config;
}

class EglContext final : public GlContext {
 public:
  EglContext(EGLDisplay display, std::string origin) : display_(display), origin_(std::move(origin)) {
    if (!display_.has("EGL_KHR_surfaceless_context")) throw UnsupportedError("EGL_KHR_surfaceless_context is missing");
    eglBindAPI(EGL_OPENGL_API);
    const std::array<EGLint, 9> wanted{EGL_CONTEXT_MAJOR_VERSION,
                                       4,
                                       EGL_CONTEXT_MINOR_VERSION,
                                       5,
                                       EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                       EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                       EGL_CONTEXT_OPENGL_DEBUG,
                                       debug_context,
                                       EGL_NONE};
    context_ = eglCreateContext(display_.handle(), choose_config(display_), EGL_NO_CONTEXT, wanted.data());
    if (context_ == EGL_NO_CONTEXT) throw UnsupportedError("OpenGL 4.5 core is missing");
  }
  ~EglContext() override {
    if (is_current()) release();
    eglDestroyContext(display_.handle(), context_);
  }

  void make_current() override {
    eglBindAPI(EGL_OPENGL_API);  // of the calling thread
    if (!eglMakeCurrent(display_.handle(), EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
      throw ResourceError(
          describe("", "OpenGL", "the context cannot be made current", "use a renderer on one thread at a time"));
  }
  void release() override { eglMakeCurrent(display_.handle(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }
  [[nodiscard]] bool is_current() const override { return eglGetCurrentContext() == context_; }
  [[nodiscard]] std::string_view origin() const override { return origin_; }

 private:
  EglDisplay display_;
  std::string origin_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

struct Candidate {
  std::string name;
  std::function<EGLDisplay()> display;
};

bool client_has(const char* extension) { return epoxy_has_egl_extension(EGL_NO_DISPLAY, extension); }

// The devices that EGL lists, graphics cards or software ones.
std::vector<Candidate> device_candidates(bool software) {
  const bool listed = client_has("EGL_EXT_device_enumeration") || client_has("EGL_EXT_device_base");
  if (!listed || !client_has("EGL_EXT_platform_device")) return {};
  std::array<EGLDeviceEXT, 16> devices{};
  EGLint count = 0;
  if (!eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count)) return {};
  std::vector<Candidate> candidates;
  for (EGLint i = 0; i < count; ++i) {
    const EGLDeviceEXT device = devices[static_cast<std::size_t>(i)];
    const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
    const bool is_software =
        extensions && std::string_view(extensions).find("EGL_MESA_device_software") != std::string_view::npos;
    if (is_software == software)
      candidates.push_back({"EGL device " + std::to_string(i),
                            [device] { return eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr); }});
  }
  return candidates;
}

std::vector<Candidate> all_candidates() {
  std::vector<Candidate> candidates = device_candidates(false);
  if (client_has("EGL_MESA_platform_surfaceless"))
    candidates.push_back(
        {"EGL surfaceless",
         [] { return eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr); }});
  for (Candidate& candidate : device_candidates(true)) candidates.push_back(std::move(candidate));
  candidates.push_back({"EGL default display", [] { return eglGetDisplay(EGL_DEFAULT_DISPLAY); }});
  return candidates;
}

std::unique_ptr<GlContext> open(const Candidate& candidate) {
  const EGLDisplay display = candidate.display();
  if (display == EGL_NO_DISPLAY) throw UnsupportedError("no such display");
  auto context = std::make_unique<EglContext>(display, candidate.name);
  const CurrentContext current(*context);
  (void)query_device();  // throws when it is too little
  return context;
}

// epoxy opens the libraries when they are first called and ends the process where they are missing: look first.
void check_libraries() {
  const auto found = [](const char* library) { return dlopen(library, RTLD_LAZY | RTLD_LOCAL) != nullptr; };
  const char* missing = !found("libEGL.so.1")                              ? "libEGL.so.1"
                        : !found("libOpenGL.so.0") && !found("libGL.so.1") ? "libGL.so.1"
                                                                           : nullptr;
  if (missing)
    throw UnsupportedError(describe("", "OpenGL without a window", std::string(missing) + " is missing",
                                    "install libegl1, libgl1 and libgl1-mesa-dri, or use --backend soft"));
}

}  // namespace

std::unique_ptr<GlContext> make_headless_context() {
  check_libraries();
  std::string reasons;
  for (const Candidate& candidate : all_candidates()) {
    try {
      return open(candidate);
    } catch (const Error& error) {
      reasons += (reasons.empty() ? "" : ", ") + candidate.name + ": " + error.what();
    }
  }
  throw UnsupportedError(
      describe("", "OpenGL without a window", reasons, "install libegl1 and libgl1-mesa-dri, or use --backend soft"));
}

}  // namespace lodestone
