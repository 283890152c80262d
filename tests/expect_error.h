// An error that must be thrown: of one kind, in one line, with what has to be in its message.
#pragma once

#include <gtest/gtest.h>

#include <exception>
#include <initializer_list>
#include <string_view>

namespace lodestone {

// Expects that `call` throws E with all of `parts` in its message; `input` is shown where it does not throw.
template <class E, class Call>
void expect_error_of(const Call& call, std::initializer_list<std::string_view> parts, std::string_view input = {}) {
  try {
    (void)call();
    ADD_FAILURE() << "no error for: " << input.substr(0, 200);
  } catch (const E& error) {
    for (const std::string_view part : parts)
      EXPECT_NE(std::string_view(error.what()).find(part), std::string_view::npos) << error.what() << '\n'
                                                                                   << input.substr(0, 200);
    EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos) << "one line, please";
  } catch (const std::exception& error) {
    ADD_FAILURE() << "an error of another kind: " << error.what();
  }
}

}  // namespace lodestone
