#include "gdal_support.h"

#include <cstdlib>
#include <mutex>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "data_folders.h"
#include "io/deferred/gdal_functions.h"

namespace tetropolis::gdal {

namespace {

/// Without its database PROJ knows no reference system, and the error that ends in would blame a
/// file. Environments of other installations (conda, QGIS) point to databases it cannot use.
void require_proj_database() {
  const QuietErrors errors;
  const Srs probe(OSRNewSpatialReference(nullptr));
  if (OSRImportFromEPSG(probe.get(), 4326) == OGRERR_NONE) return;
  std::string folders;
  for (const char* name : {"PROJ_DATA", "PROJ_LIB"})
    if (const char* folder = std::getenv(name))
      folders += fmt::format("{}{} ({})", folders.empty() ? "" : " and ", name, folder);
  throw Error(
      ErrorKind::kUsage,
      one_line(fmt::format(
          "proj.db: PROJ cannot use its database of reference systems{}; {}", errors.reason(),
          folders.empty() ? std::string("install proj-data, or set PROJ_DATA to its folder")
                          : "unset " + folders)));
}

/// By the texts of GDAL 3.6. What is not known here is about anything.
About about(std::string_view text) {
  const auto has = [&](std::string_view part) { return text.find(part) != text.npos; };
  if (has("crs not found")) return About::kSystem;
  if (has("FeatureCollection")) return About::kAnything;
  if (text.starts_with("Invalid '") && has("coordinate")) return About::kGeometry;
  if (text.starts_with("Invalid ") && has(" object. Missing '")) return About::kGeometry;
  if (has("Got NULL geometry as Member")) return About::kGeometry;
  for (const std::string_view begin :
       {"Did not get at least", "Did not get 2+ values", "Corrupt <", "Invalid exterior ring",
        "Invalid interior ring", "Invalid surfaceMember", "Invalid polygonMember",
        "Invalid LinearRing", "Invalid Polygon", "Invalid patch", "Invalid curve"})
    if (text.starts_with(begin)) return About::kGeometry;
  return About::kAnything;
}

}  // namespace

void initialise() {
  static std::once_flag once;
  std::call_once(once, [] {
    use_own_data();
    GDALAllRegister();
    require_proj_database();
  });
}

std::string utf8(const char* text) {
  if (CPLIsUTF8(text, -1) != 0) return text;
  char* recoded = CPLRecode(text, CPL_ENC_ISO8859_1, CPL_ENC_UTF8);
  std::string result = recoded;
  CPLFree(recoded);
  return result;
}

QuietErrors::QuietErrors() { CPLPushErrorHandlerEx(&QuietErrors::collect, this); }

QuietErrors::~QuietErrors() {
  CPLPopErrorHandler();
  CPLErrorReset();
}

void CPL_STDCALL QuietErrors::collect(CPLErr kind, CPLErrorNum, const char* message) noexcept {
  auto* self = static_cast<QuietErrors*>(CPLGetErrorHandlerUserData());
  if (self == nullptr || message == nullptr) return;
  const bool is_failure = kind == CE_Failure || kind == CE_Fatal;
  const bool is_first = is_failure && self->failures_++ == 0;
  try {
    if (std::string_view(message).ends_with("Skipping to next feature."))
      self->passed_over_.push_back(one_line(message));
    if (!is_failure) return;
    std::string line = one_line(message);
    while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
    if (is_first) self->first_ = line;
    Some& some = self->by_about_[static_cast<std::size_t>(about(line))];
    if (some.count++ == 0) some.first = line;
    self->last_ = std::move(line);
  } catch (...) {  // No memory for the text. GDAL, which calls this, is C.
  }
}

std::string QuietErrors::reason() const { return last_.empty() ? "" : ": " + last_; }

void QuietErrors::reset() {
  failures_ = 0;
  first_.clear();
  last_.clear();
  by_about_ = {};
  passed_over_.clear();
}

ConfigOption::ConfigOption(const char* key, const char* value) : key_(key) {
  if (const char* before = CPLGetThreadLocalConfigOption(key, nullptr)) before_ = before;
  CPLSetThreadLocalConfigOption(key, value);
}

ConfigOption::~ConfigOption() {
  CPLSetThreadLocalConfigOption(key_, before_ ? before_->c_str() : nullptr);
}

MemoryFolder::MemoryFolder()
    : path_(fmt::format("/vsimem/tetropolis-{}", static_cast<const void*>(this))) {}

MemoryFolder::~MemoryFolder() { VSIRmdirRecursive(path_.c_str()); }

std::vector<std::string> MemoryFolder::names() const {
  char** const list = VSIReadDir(path_.c_str());
  std::vector<std::string> names;
  for (char** name = list; name != nullptr && *name != nullptr; ++name) names.emplace_back(*name);
  CSLDestroy(list);
  return names;
}

std::string_view MemoryFolder::bytes(const std::string& name) const {
  vsi_l_offset size = 0;
  const GByte* data = VSIGetMemFileBuffer(path(name).c_str(), &size, FALSE);
  if (data == nullptr) return {};
  return {reinterpret_cast<const char*>(data), static_cast<std::size_t>(size)};
}

}  // namespace tetropolis::gdal
