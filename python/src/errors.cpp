#include <exception>
#include <filesystem>
#include <string>

#include "tetropolis/core/error.h"

#include "bindings.h"
#include "settings.h"

namespace tetropolis::python {

namespace {

namespace nb = nanobind;

void raise(ErrorKind kind, const std::string& message) {
  const char* name = kind == ErrorKind::kUsage   ? "UsageError"
                     : kind == ErrorKind::kInput ? "InputError"
                                                 : "GuaranteeError";
  const nb::object type = nb::module_::import_("tetropolis._errors").attr(name);
  PyErr_SetString(type.ptr(), with_keywords(message).c_str());
}

void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    raise(error.kind(), error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    raise(ErrorKind::kInput, error.path1().string() + ": " + error.code().message());
  }
}

}  // namespace

void bind_errors(nb::module_&) { nb::register_exception_translator(translate); }

}  // namespace tetropolis::python
