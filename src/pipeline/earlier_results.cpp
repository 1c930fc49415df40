#include "earlier_results.h"

#include <fstream>
#include <system_error>

#include <nlohmann/json.hpp>

#include "result_files.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;

/// Picks from a report what makes it one of ours, and the names of its results.
class ReportNames : public Json::json_sax_t {
 public:
  bool is_report() const { return has_version_ && has_command_ && has_steps_; }
  std::vector<std::string> names;

  bool key(string_t& name) override {
    if (depth_ != 1) return true;
    in_files_ = name == "files";
    has_version_ = has_version_ || name == "version";
    has_command_ = has_command_ || name == "command";
    has_steps_ = has_steps_ || name == "steps";
    return true;
  }
  bool string(string_t& text) override {
    if (in_files_ && depth_ == 2)
      if (std::optional<std::string> name = name_below(text)) names.push_back(std::move(*name));
    return true;
  }
  bool start_object(std::size_t) override { return enter(); }
  bool end_object() override { return leave(); }
  bool start_array(std::size_t) override { return enter(); }
  bool end_array() override { return leave(); }
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool parse_error(std::size_t, const std::string&, const Json::exception&) override {
    return false;
  }

 private:
  bool enter() {
    ++depth_;
    return true;
  }
  bool leave() {
    --depth_;
    return true;
  }

  int depth_ = 0;
  bool in_files_ = false, has_version_ = false, has_command_ = false, has_steps_ = false;
};

}  // namespace

std::optional<std::string> name_below(const std::string& listed) {
  const fs::path path = fs::path(listed).lexically_normal();
  if (path.empty() || !path.is_relative() || *path.begin() == "..") return std::nullopt;
  return path.string();
}

std::vector<std::string> earlier_results(const fs::path& folder) {
  std::error_code error;
  // A pipe would be waited for.
  if (!fs::is_regular_file(folder / results::kReport, error)) return {};
  std::ifstream file(folder / results::kReport);
  ReportNames report;
  if (!Json::sax_parse(file, &report) || !report.is_report()) return {};
  report.names.emplace_back(results::kReport);
  return std::move(report.names);
}

}  // namespace tetropolis
