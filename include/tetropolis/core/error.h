// Errors that end an operation. Expected failures of one building are values, not errors (see
// city_model.h); bugs are assertions.
#pragma once

#include <stdexcept>
#include <string>

namespace tetropolis {

/// Why an operation gave up. The values are the exit codes of the command line.
enum class ErrorKind : int {
  kGuarantee = 1,  ///< A check failed or a guarantee cannot be met.
  kUsage = 2,      ///< Wrong options or configuration.
  kInput = 3,      ///< Unusable input, or a file that cannot be written.
};

/// The text without line ends and other control characters, which become spaces.
inline std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
  return text;
}

/// One line, whatever it quotes, that names the file (and feature, point or byte), says what is
/// wrong and what to do.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message)
      : std::runtime_error(one_line(message)), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

/// Thrown out of a long operation when its caller asked it to stop.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("interrupted") {}
};

}  // namespace tetropolis
