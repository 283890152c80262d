// An OpenGL context as the renderer sees it: something that can be made current on the calling thread.
//
// The headless context comes from EGL without any window system; a window is another implementation of the same three
// functions, and the renderer does not notice.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace lodestone {

class GlContext {
 public:
  virtual ~GlContext() = default;
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  // Binds the context to the calling thread. Throws ResourceError when another thread holds it.
  virtual void make_current() = 0;
  virtual void release() = 0;
  [[nodiscard]] virtual bool is_current() const = 0;
  // The context's origin, for messages and manifests: "EGL surfaceless", ...
  [[nodiscard]] virtual std::string_view origin() const = 0;

 protected:
  GlContext() = default;
};

// Makes a context current for a scope. A context that was current before remains so, and the owner of a window need not
// bind it again; otherwise the thread is left without one, and another thread may use it next.
class CurrentContext {
 public:
  explicit CurrentContext(GlContext& context) : context_(context), was_current_(context.is_current()) {
    if (!was_current_) context_.make_current();
  }
  ~CurrentContext() {
    if (!was_current_) context_.release();
  }
  CurrentContext(const CurrentContext&) = delete;
  CurrentContext& operator=(const CurrentContext&) = delete;

 private:
  GlContext& context_;
  bool was_current_;
};

// An OpenGL 4.5 core context without a window. Tried in this order: the graphics cards that EGL lists, Mesa's
// surfaceless platform, the software devices that EGL lists, the default display. Throws UnsupportedError with what
// each of them lacked and what to install.
[[nodiscard]] std::unique_ptr<GlContext> make_headless_context();

}  // namespace lodestone
