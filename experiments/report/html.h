// Text of a page: what is put into it is escaped unless it says that it is HTML already.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <type_traits>

namespace lodestone {

// Safe as text and within a quoted attribute.
[[nodiscard]] std::string escape_html(std::string_view text);

class Html {
 public:
  struct Raw {
    std::string html;
  };

  // Texts among the arguments are escaped.
  template <class... Arguments>
  void add(std::string_view format, const Arguments&... arguments) {
    add_escaped(format, argument(arguments)...);
  }
  void raw(std::string_view html) { text_ += html; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  template <class... Arguments>
  void add_escaped(std::string_view format, const Arguments&... arguments) {
    fmt::vformat_to(std::back_inserter(text_), fmt::string_view(format.data(), format.size()),
                    fmt::make_format_args(arguments...));
  }
  static std::string argument(std::string_view text) { return escape_html(text); }
  static const std::string& argument(const Raw& raw) { return raw.html; }
  template <class Number>
  requires std::is_arithmetic_v<Number>
  static Number argument(Number number) { return number; }

  std::string text_;
};

}  // namespace lodestone
