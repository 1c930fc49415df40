#include "foreign_code.h"

#include <cstddef>

#include "tetropolis/core/foreign_input.h"

namespace tetropolis {

namespace {

constexpr std::size_t kHandlerStack = 65536;

thread_local const char* current_input = nullptr;

}  // namespace

ForeignCode::ForeignCode(const char* input)
    : stack_(new char[kHandlerStack]), input_before_(current_input) {
  stack_t stack{};
  stack.ss_sp = stack_.get();
  stack.ss_size = kHandlerStack;
  if (::sigaltstack(&stack, &stack_before_) != 0) stack_.reset();
  current_input = input;
}

ForeignCode::~ForeignCode() {
  current_input = input_before_;
  if (stack_) ::sigaltstack(&stack_before_, nullptr);
}

const char* foreign_input() { return current_input; }

}  // namespace tetropolis
