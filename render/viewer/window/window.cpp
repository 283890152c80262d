#include "render/viewer/window/window.h"

#include <GLFW/glfw3.h>
#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "core/base/error.h"
#include "core/files/atomic_file.h"

namespace lodestone::viewer {
namespace {

// The last error of GLFW, which reports errors by callback alone.
std::string& last_error() {
  static std::string text;
  return text;
}

std::function<void()>& display_lost() {
  static std::function<void()> callback;
  return callback;
}

// Xlib ends the process when this returns, with a message of its own; end it with ours. Not in a signal handler: the
// thread that talked to the display is in the middle of nothing of ours.
int on_io_error(void*) {
  if (const auto callback = std::exchange(display_lost(), {})) callback();
  remove_temporaries();
  std::_Exit(5);  // as where there is no display: experiments/command_line/exit_status.h
}

// For a GLFW connected to an X server. Without Xlib (Wayland) a lost display is a window that closes.
void watch_display() {
  using Handler = int (*)(void*);
  void* const xlib = dlopen("libX11.so.6", RTLD_LAZY | RTLD_NOLOAD);
  if (!xlib) return;
  if (void* const set = dlsym(xlib, "XSetIOErrorHandler")) reinterpret_cast<Handler (*)(Handler)>(set)(on_io_error);
}

GLFWwindow* make_window(const std::string& title, ImageSize size, int major, int minor) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, major);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, minor);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
#ifndef NDEBUG
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
#endif
  return glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
}

class WindowContext final : public GlContext {
 public:
  explicit WindowContext(GLFWwindow* window) : window_(window) {}
  void make_current() override { glfwMakeContextCurrent(window_); }
  void release() override { glfwMakeContextCurrent(nullptr); }
  [[nodiscard]] bool is_current() const override { return glfwGetCurrentContext() == window_; }
  [[nodiscard]] std::string_view origin() const override { return "GLFW window"; }

 private:
  GLFWwindow* window_;
};

char key_of(int key) {
  if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) return static_cast<char>('A' + key - GLFW_KEY_A);
  switch (key) {
    case GLFW_KEY_SPACE:
      return ' ';
    case GLFW_KEY_TAB:
      return '\t';
    case GLFW_KEY_ESCAPE:
      return '\x1b';
    case GLFW_KEY_HOME:
      return '\n';
    case GLFW_KEY_EQUAL:
    case GLFW_KEY_KP_ADD:
      return '+';
    case GLFW_KEY_MINUS:
    case GLFW_KEY_KP_SUBTRACT:
      return '-';
    case GLFW_KEY_F12:
      return 'C';
    default:
      return 0;
  }
}

}  // namespace

// GLFW's callbacks, as events.
struct Window::Callbacks {
  static Window& self(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }
  static Event& add(GLFWwindow* window, Event::Kind kind) {
    Event& event = self(window).events_.emplace_back();
    event.kind = kind;
    event.time = now();
    event.at = self(window).pointer_;
    return event;
  }
  static Point to_pixels(GLFWwindow* window, double x, double y) {
    int width = 0, height = 0, pixel_width = 0, pixel_height = 0;
    glfwGetWindowSize(window, &width, &height);
    glfwGetFramebufferSize(window, &pixel_width, &pixel_height);
    return {x * pixel_width / std::max(width, 1), y * pixel_height / std::max(height, 1)};
  }
  static void on_button(GLFWwindow* window, int button, int action, int mods) {
    if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
    Event& event = add(window, action == GLFW_PRESS ? Event::Kind::press : Event::Kind::release);
    event.button = button == GLFW_MOUSE_BUTTON_LEFT    ? Button::left
                   : button == GLFW_MOUSE_BUTTON_RIGHT ? Button::right
                                                       : Button::middle;
    event.shift = mods & GLFW_MOD_SHIFT;
  }
  static void on_move(GLFWwindow* window, double x, double y) {
    self(window).pointer_ = to_pixels(window, x, y);
    add(window, Event::Kind::move);
  }
  static void on_scroll(GLFWwindow* window, double, double y) { add(window, Event::Kind::scroll).amount = y; }
  static void on_key(GLFWwindow* window, int key, int, int action, int mods) {
    Event& event = add(window, action == GLFW_PRESS    ? Event::Kind::key_down
                               : action == GLFW_REPEAT ? Event::Kind::key_repeat
                                                       : Event::Kind::key_up);
    event.key = key_of(key);
    event.shift = mods & GLFW_MOD_SHIFT;
  }
  static void on_drop(GLFWwindow* window, int count, const char** paths) {
    add(window, Event::Kind::drop).files.assign(paths, paths + count);
  }
  static void on_focus(GLFWwindow* window, int focused) {
    add(window, focused ? Event::Kind::other : Event::Kind::focus_lost);
  }
  static void on_resize(GLFWwindow* window, int, int) { add(window, Event::Kind::other); }
  static void on_enter(GLFWwindow* window, int) { add(window, Event::Kind::other); }
  static void on_refresh(GLFWwindow* window) { add(window, Event::Kind::other); }

  static void install(GLFWwindow* window) {
    glfwSetMouseButtonCallback(window, on_button);
    glfwSetCursorPosCallback(window, on_move);
    glfwSetScrollCallback(window, on_scroll);
    glfwSetKeyCallback(window, on_key);
    glfwSetDropCallback(window, on_drop);
    glfwSetWindowFocusCallback(window, on_focus);
    glfwSetCursorEnterCallback(window, on_enter);
    glfwSetFramebufferSizeCallback(window, on_resize);
    glfwSetWindowRefreshCallback(window, on_refresh);
  }
};

Window::Window(const std::string& title, ImageSize size) {
  last_error().clear();
  glfwSetErrorCallback([](int, const char* text) { last_error() = text; });
  if (!glfwInit())
    throw UnsupportedError(describe("", "the window", "there is no display: " + last_error(),
                                    "set DISPLAY, or draw pictures without one: lodestone render"));
  watch_display();
  window_ = make_window(title, size, 4, 5);
  if (!window_) {
    missing_gl45_ = last_error();
    window_ = make_window(title, size, 3, 2);
  }
  if (!window_) {
    const std::string error = last_error();
    glfwTerminate();
    throw UnsupportedError(describe("", "the window", "OpenGL 3.2 is missing: " + error,
                                    "install libgl1-mesa-dri, or draw pictures without a window: lodestone render"));
  }
  glfwSetWindowUserPointer(window_, this);
  Callbacks::install(window_);
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
}

Window::~Window() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

std::unique_ptr<GlContext> Window::context() const { return std::make_unique<WindowContext>(window_); }

ImageSize Window::size() const {
  ImageSize size{0, 0};
  if (!glfwGetWindowAttrib(window_, GLFW_ICONIFIED)) glfwGetFramebufferSize(window_, &size.width, &size.height);
  return size;
}

bool Window::closing() const { return glfwWindowShouldClose(window_); }
void Window::close() { glfwSetWindowShouldClose(window_, GLFW_TRUE); }
void Window::hide() { glfwHideWindow(window_); }

float Window::content_scale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  // If a unit of the window is several pixels, they are scaled already.
  int units = 0, pixels = 0;
  glfwGetWindowSize(window_, &units, nullptr);
  glfwGetFramebufferSize(window_, &pixels, nullptr);
  if (units > 0 && pixels > units) x *= static_cast<float>(units) / static_cast<float>(pixels);
  return std::clamp(x, 1.0f, 4.0f);
}

void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }
void Window::poll() { glfwPollEvents(); }

void Window::wait(double seconds) {
  if (seconds > 0)
    glfwWaitEventsTimeout(seconds);
  else
    glfwPollEvents();
}

std::vector<Event> Window::take_events() { return std::exchange(events_, {}); }
void Window::swap() { glfwSwapBuffers(window_); }
void Window::wake() { glfwPostEmptyEvent(); }
double Window::now() { return glfwGetTime(); }

void on_display_lost(std::function<void()> callback) { display_lost() = std::move(callback); }

}  // namespace lodestone::viewer
