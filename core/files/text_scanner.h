// Tokens and lines of the text mesh formats (OBJ, OFF, ASCII PLY and STL, and every PLY header).
//
// Tokens are separated by blanks; '#' at the start of a token begins a comment that lasts to the end of the line; a
// backslash at the end of a line continues it. Lines end with LF, CR LF or CR.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/files/byte_reader.h"

namespace lodestone {

// A decimal number as in mesh files: an optional sign (also plus), nan and inf in any case, and the "1.#QNAN" and
// "-1.#INF" of older Microsoft runtimes. Too large for a double gives infinity, too small gives zero.
[[nodiscard]] std::optional<double> parse_number(std::string_view token);
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view token);

[[nodiscard]] std::string lower_case(std::string_view text);  // ASCII letters alone
// ".ply": in lower case, with the dot.
[[nodiscard]] std::string extension_of(const std::filesystem::path& path);

// Text of unknown origin made fit for a one-line message: quoted, unprintable bytes as \xNN, at most 40 characters.
[[nodiscard]] std::string quote(std::string_view text);

class TextScanner {
 public:
  static constexpr std::size_t max_token = 4096;  // bytes; longer ones are refused, since the file is not text

  explicit TextScanner(ByteReader& input, std::uint64_t first_line = 1) : input_(&input), line_(first_line) {}

  // The next token on the current line, empty when the line has no more. Valid until the next call.
  [[nodiscard]] std::string_view token();
  // The next token on this or a later line, empty at the end of the input.
  [[nodiscard]] std::string_view token_across_lines();
  // False if the current line ends here, as most do after their last token. Fast.
  [[nodiscard]] bool line_continues() {
    const std::string_view text = input_->window(1);
    return !text.empty() && text[0] != '\n' && text[0] != '\r';
  }
  // True if this text follows on the current line, after blanks; consumes only the blanks.
  [[nodiscard]] bool continues_with(std::string_view text);
  // The rest of the current line, without blanks around it: a name that may have blanks. At most max_token bytes.
  [[nodiscard]] std::string rest_of_line();
  // Leaves the rest of the current line; false when the input ends with it.
  bool next_line();

  // The value of a token; `what` (for instance "an x coordinate") is what the message says was expected. Throw
  // InputError.
  [[nodiscard]] double number(std::string_view token, const char* what) const;
  [[nodiscard]] std::int64_t integer(std::string_view token, const char* what) const;

  [[nodiscard]] const std::string& name() const { return input_->name(); }
  [[nodiscard]] std::uint64_t line() const { return line_; }  // counted from 1
  [[nodiscard]] std::string place() const { return "line " + std::to_string(line_); }
  [[noreturn]] void fail(const std::string& what, const std::string& remedy = {}) const;

 private:
  bool skip_line_end();

  ByteReader* input_;
  std::uint64_t line_;
};

}  // namespace lodestone
