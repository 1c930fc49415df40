// The command line: options in, library calls, progress out.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/system_memory.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/core/version.h"
#include "tetropolis/io/file/write_file.h"
#include "tetropolis/run/output_folder.h"
#include "tetropolis/run/run.h"

#include "commands.h"
#include "console.h"
#include "interrupts.h"
#include "options.h"

namespace {

namespace fs = std::filesystem;
using namespace tetropolis;
using namespace tetropolis::app;

/// The lines after a run: what came out, in one screen.
void print_summary(const Report& report, Console& console) {
  if (report.input && report.command != "synth")
    console.line(fmt::format("points     {} read, {} kept", report.input->points_read,
                             report.input->points_kept));
  if (report.command == "synth")
    console.line(fmt::format("city       {} footprints, {} points", report.input->footprints_read,
                             report.input->points_kept));
  if (report.city)
    console.line(fmt::format("buildings  {} cleaned, {} after merging, {} features dropped{}",
                             report.city->raw_buildings, report.city->buildings,
                             report.city->dropped.size(),
                             std::isfinite(report.city->min_clearance)
                                 ? fmt::format("; clearance {:.3f} m", report.city->min_clearance)
                                 : ""));
  if (report.ground_mesh)
    console.line(fmt::format("ground     {} triangles, least angle {:.1f} degrees",
                             report.ground_mesh->triangles, report.ground_mesh->min_angle_deg));
  if (report.volume_mesh) {
    const VolumeMeshFacts& mesh = *report.volume_mesh;
    console.line(fmt::format(
        "volume     {} tets, {} inverted; dihedral angles {:.1f} .. "
        "{:.1f} degrees, median of least {:.1f}",
        mesh.cells, mesh.inverted, mesh.dihedral_min, mesh.dihedral_max, mesh.dihedral_median));
  }
  if (report.surface_mesh)
    console.line(fmt::format("surface    {} triangles, {}, {}", report.surface_mesh->triangles,
                             report.surface_mesh->closed ? "closed" : "open",
                             report.surface_mesh->manifold ? "manifold" : "not manifold"));
  for (const Warning& warning : report.warnings)
    console.line(fmt::format("note       {}: {} ({})", warning.code, with_options(warning.message),
                             warning.count));
  double seconds = 0;
  for (const StepTime& step : report.steps) seconds += step.seconds;
  console.line(fmt::format("done       {:.1f} s, {:.0f} MB at most; results in {}", seconds,
                           static_cast<double>(report.peak_rss_bytes) / 1e6, report.config.out));
}

using Say = std::function<void(const std::string&)>;

constexpr const char* kOutOfMemory = "out of memory; free memory or use a smaller domain";
constexpr const char* kOutOfMemoryMeshing =
    "out of memory; use a smaller domain or a larger --mesh-size";

/// Whether standard output is a pipe that nobody reads any more: `head` has seen enough.
bool reader_is_gone() {
  pollfd output{STDOUT_FILENO, POLLOUT, 0};
  return poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0;
}

/// The exit code of `action`; an error becomes one line.
int guarded(const std::function<int()>& action, const Say& say,
            const char* out_of_memory = kOutOfMemory) {
  const auto tell = [&](const std::string& message, int code) {
    say(fmt::format("tetropolis: {}", one_line(message)));
    return code;
  };
  const auto fail = [&](const std::string& message, int code) {
    // A run whose files are being removed from under it is interrupted, whatever it stumbles over.
    wait_if_ending();
    return tell(message, code);
  };
  try {
    const int code = action();
    static bool told = false;  // calls are nested
    if ((std::fflush(stdout) != 0 || std::ferror(stdout) != 0) && !std::exchange(told, true) &&
        !reader_is_gone())
      return tell("cannot write to standard output: disk full?", 3);
    return code;
  } catch (const Error& error) {
    return fail(with_options(error.what()), static_cast<int>(error.kind()));
  } catch (const Cancelled&) {
    return say_interrupted(say);
  } catch (const std::bad_alloc&) {
    return fail(out_of_memory, 1);
  } catch (const fs::filesystem_error& error) {
    return fail(fmt::format("{}: {}", error.path1().string(), error.code().message()),
                static_cast<int>(ErrorKind::kInput));
  } catch (const std::system_error& error) {  // no more threads, for example
    return fail(fmt::format("the system refused: {}; free memory or lower --threads", error.what()),
                1);
  } catch (const std::exception& error) {
    if (std::string_view(error.what()).find("pthread_create") != std::string_view::npos)  // TBB's
      return fail("the system refused another thread; allow more (ulimit -u) or lower --threads",
                  1);
    return fail(fmt::format("internal error: {}; please report it", error.what()), 1);
  }
}

void say_on_stderr(const std::string& line) { put(stderr, line + "\n"); }

/// Whether `file` has the place and the name of a file that GDAL reads with `input`, as houses.prj
/// is read with houses.shp. Precondition: it is there.
bool is_side_file(const fs::path& file, const fs::path& input) {
  constexpr std::array kExtensions = {".shp", ".shx", ".dbf", ".prj",  ".cpg", ".qpj", ".qix",
                                      ".sbn", ".sbx", ".csv", ".csvt", ".mif", ".mid", ".tfw",
                                      ".wld", ".xml", ".gfs", ".xsd",  ".ovr", ".msk"};
  std::error_code error;
  const fs::path real = fs::canonical(file, error);
  if (error || input.empty() ||
      !fs::equivalent(real.parent_path(), fs::absolute(input).parent_path(), error))
    return false;
  const std::string extension = lower_case(real.extension().string());
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end() &&
         real.filename().string().starts_with(input.stem().string() + ".");
}

/// Text files may be results or inputs as well, or belong to one. `other`: the settings, or what
/// `check` looks at.
void require_log_apart(const Config& config, const std::string& other) {
  const fs::path log = config.log;
  std::error_code error;
  if (log.empty()) return;
  if (is_result(log, config.out))
    throw Error(
        ErrorKind::kUsage,
        fmt::format("--log: {} is a result, which would be lost; choose another name", config.log));
  if (!fs::exists(log, error)) return;
  std::vector<fs::path> inputs{config.footprints, config.city, config.dtm, other};
  inputs.insert(inputs.end(), config.points.begin(), config.points.end());
  const bool is_input = std::any_of(inputs.begin(), inputs.end(), [&](const fs::path& input) {
    return fs::equivalent(input, log, error);
  });
  if (is_input || is_side_file(log, config.footprints) || is_side_file(log, config.dtm))
    throw Error(ErrorKind::kUsage,
                fmt::format("--log: {} is an input of this run, which would be lost; choose "
                            "another name",
                            config.log));
}

/// Errors of `action` are in the log, too. `other` as above.
int with_console(const Config& config, const std::string& other,
                 const std::function<int(Console&)>& action,
                 const char* out_of_memory = kOutOfMemory) {
  require_log_apart(config, other);
  Console console(config.quiet, config.log);
  return guarded([&] { return action(console); },
                 [&](const std::string& line) { console.error(line); }, out_of_memory);
}

using RunFunction = Report (*)(const Config&, const RunHooks&);

int run(const ConfigOptions& options, Command command, RunFunction function) {
  const Config config = options.config();
  return with_console(
      config, options.file(),
      [&](Console& console) {
        print_summary(function(config, console.hooks()), console);
        return 0;
      },
      (command & (kBuild | kMesh)) != 0 ? kOutOfMemoryMeshing : kOutOfMemory);
}

int run_check(const ConfigOptions& options, const std::string& path,
              std::optional<double> min_distance) {
  const Config config = options.config();
  const ThreadLimit limit(config.threads);
  return with_console(config, path, [&](Console& console) {
    return check(path, min_distance, console) ? 0 : static_cast<int>(ErrorKind::kGuarantee);
  });
}

void init(const std::string& path) {
  const std::string text = config_template(kBuild | kCity | kMesh | kSynth);
  if (path == "-") {
    put(stdout, text);
    return;
  }
  // write_file says what is wrong with the path. Links to nothing are in the way, too.
  std::error_code ignored;
  if (fs::exists(fs::symlink_status(path, ignored)))
    throw Error(ErrorKind::kUsage, fmt::format("{}: exists already; choose another name", path));
  const fs::path folder = fs::path(path).parent_path();
  if (!folder.empty() && !fs::is_directory(folder, ignored))
    throw Error(ErrorKind::kUsage,
                fmt::format("{}: there is no folder {}; make it first", path, folder.string()));
  write_file(path, text);
}

/// One line for what CLI11 could not parse, with the nearest option.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = &app;
  for (const CLI::App* sub : app.get_subcommands()) command = sub;
  // What was not understood explains the error better than what is missing because of it.
  const std::vector<std::string> leftover = command->remaining(true);
  if (leftover.empty()) {
    if (const std::vector<std::string> before = app.remaining(); command != &app && !before.empty())
      return fmt::format("'{}' comes before the command; write it after: tetropolis {} ...",
                         before.front(), command->get_name());
    for (const CLI::Option* option : command->get_options())
      if (option->count() > 1 && option->get_items_expected_max() == 1)
        return fmt::format("{} is given {} times; give it once{}", option->get_name(),
                           option->count(),
                           option->get_name() == "--footprints"
                               ? ", with one file (ogrmerge.py -single makes one of several)"
                               : "");
    return error.what();
  }
  const std::string& unknown = leftover.front();
  if (std::error_code ignored; fs::exists(unknown, ignored))
    return fmt::format("unknown argument '{}'; an option before it takes one file only", unknown);
  std::vector<std::string> known;
  for (const CLI::Option* option : command->get_options()) known.push_back(option->get_name());
  for (const CLI::App* sub : command->get_subcommands({})) known.push_back(sub->get_name());
  const std::string nearest = nearest_name(unknown, known);
  return fmt::format("unknown argument '{}'{}", unknown,
                     nearest.empty() ? fmt::format("; see 'tetropolis {}--help'",
                                                   command == &app ? "" : command->get_name() + " ")
                                     : fmt::format("; did you mean '{}'?", nearest));
}

/// The commands, and where CLI11 puts what it finds. It keeps addresses of all of this.
struct CommandLine {
  CLI::App app{"Tetropolis: from building footprints and LiDAR to simulation-ready city meshes",
               "tetropolis"};
  std::function<int()> action;         ///< What the chosen command does; it returns the exit code.
  std::vector<std::string> files;      ///< Of info.
  std::string checked;                 ///< Of check.
  std::optional<double> min_distance;  ///< Of check.
  std::string settings{"tetropolis.toml"};  ///< Of init.

  CommandLine() = default;
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;
};

/// Has `command` do `act` if it is the one that is chosen.
void on_choice(CommandLine& line, CLI::App& command, std::function<int()> act) {
  command.callback([&line, act = std::move(act)] { line.action = act; });
}

void add_run(CommandLine& line, const std::string& name, const std::string& help, Command command,
             RunFunction function) {
  CLI::App& added = *line.app.add_subcommand(name, help);
  const auto options = std::make_shared<ConfigOptions>(added, command);
  on_choice(line, added, [options, command, function] { return run(*options, command, function); });
}

/// As a script makes them of a variable that is not set.
std::string wrong_name(const std::string& text) { return text.empty() ? "an empty name" : ""; }

void add_info(CommandLine& line) {
  CLI::App& added = *line.app.add_subcommand(
      "info", "What is in a point cloud, vector file, city model, raster or mesh");
  added.add_option("files", line.files, "Files")
      ->required()
      ->type_name("FILE...")
      ->check(wrong_name);
  on_choice(line, added,
            [&line] { return info(line.files) ? 0 : static_cast<int>(ErrorKind::kInput); });
}

/// What is wrong with a distance on the command line; empty if nothing is.
std::string wrong_distance(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, code] = std::from_chars(text.data(), end, value);
  const bool valid = code == std::errc() && stop == end && std::isfinite(value) && value >= 0;
  return valid ? "" : fmt::format("'{}' is no distance in metres", text);
}

void add_check(CommandLine& line) {
  CLI::App& added = *line.app.add_subcommand(
      "check",
      "Validate a city model, a mesh or a folder of results; exit 1 if a guarantee is broken");
  added.add_option("path", line.checked, "File or folder")
      ->required()
      ->type_name("PATH")
      ->check(wrong_name);
  added
      .add_option("--min-building-distance", line.min_distance,
                  "Clearance to ask of a city model [m] (default: as in report.json, else 1.0)")
      ->type_name("NUMBER")
      ->check(wrong_distance);
  const auto options = std::make_shared<ConfigOptions>(added, kCheck);
  on_choice(line, added,
            [&line, options] { return run_check(*options, line.checked, line.min_distance); });
}

void add_init(CommandLine& line) {
  CLI::App& added = *line.app.add_subcommand("init", "Write a commented configuration file");
  added
      .add_option("file", line.settings,
                  "File to write, '-' for standard output (default tetropolis.toml)")
      ->type_name("FILE");
  on_choice(line, added, [&line] {
    init(line.settings);
    return 0;
  });
}

void add_settings(CommandLine& line) {
  on_choice(line,
            *line.app.add_subcommand("settings",
                                     "All settings as Markdown tables, for the documentation"),
            [] {
              put(stdout, config_markdown());
              return 0;
            });
  on_choice(
      line,
      *line.app.add_subcommand(
          "report-keys", "All keys of report.json as a Markdown table, for the documentation"),
      [] {
        put(stdout, report_markdown());
        return 0;
      });
}

void declare(CommandLine& line) {
  line.app.set_version_flag("--version", std::string("tetropolis ") + kVersion);
  line.app.require_subcommand(1);
  add_run(line, "build", "Footprints and points to a city model, a volume mesh and a surface",
          kBuild, run_build);
  add_run(line, "city", "Footprints and points to a city model and a terrain (steps 1 and 2)",
          kCity, run_city);
  add_run(line, "mesh", "A city model and a terrain to meshes (step 3)", kMesh, run_mesh);
  add_run(line, "synth", "Invent a city: footprints and points", kSynth, run_synth);
  add_info(line);
  add_check(line);
  add_init(line);
  add_settings(line);
}

/// CLI11 takes what comes after "--option=", or after an option with a value, as that value, be it
/// the next option.
void require_values(const CLI::App& app, int argc, char** argv) {
  const CLI::App* command = &app;
  const auto takes_value = [&](std::string_view word) {
    const CLI::Option* option = command->get_option_no_throw(std::string(word));
    return option != nullptr && option->get_items_expected_min() > 0;
  };
  for (int i = 1; i < argc; ++i) {
    std::string_view word = argv[i];
    if (word == "--") return;
    if (command == &app)
      for (const CLI::App* sub : app.get_subcommands({}))
        if (sub->get_name() == word) command = sub;
    if (!word.starts_with("--")) continue;
    const bool is_next_option = i + 1 < argc && std::string_view(argv[i + 1]).starts_with("--") &&
                                command->get_option_no_throw(argv[i + 1]) != nullptr;
    if (word.find('=') == word.size() - 1)
      word.remove_suffix(1);
    else if (!(is_next_option && takes_value(word)))
      continue;
    throw Error(ErrorKind::kUsage,
                fmt::format("{} has no value; write one, or leave the option out", word));
  }
}

/// Libraries end in many ways where they do not get the little memory that they begin with.
void require_address_space() {
  constexpr double kMegabyte = 1 << 20, kLeast = 32 * kMegabyte;
  const double left = address_space_left();
  if (left < kLeast)
    throw Error(
        ErrorKind::kGuarantee,
        fmt::format("out of memory: the limit of address space (ulimit -v) leaves {:.0f} MB "
                    "besides the program itself; allow at least {:.0f} MB more",
                    std::max(left, 0.0) / kMegabyte, (kLeast - left) / kMegabyte));
}

/// For whoever types nothing but the program's name: what to type next.
std::string guidance(const CLI::App& app) {
  std::string text = fmt::format("{}\n\nCommands:\n", app.get_description());
  for (const CLI::App* sub : app.get_subcommands({}))
    text += fmt::format("  {:<10} {}\n", sub->get_name(), sub->get_description());
  return text +
         "\nFirst steps:\n"
         "  tetropolis synth --out input                 # a synthetic city to try things on\n"
         "  tetropolis build --footprints input/footprints.shp --points input --out city\n"
         "  tetropolis check city\n"
         "\n'tetropolis COMMAND --help' lists the options of a command.\n";
}

}  // namespace

int main(int argc, char** argv) {
  catch_interrupts();
  CommandLine line;
  declare(line);
  if (argc <= 1) {
    put(stderr, guidance(line.app));
    return static_cast<int>(ErrorKind::kUsage);
  }
  try {
    require_values(line.app, argc, argv);
    line.app.parse(argc, argv);
  } catch (const Error& error) {
    put(stderr, fmt::format("tetropolis: {}\n", with_options(one_line(error.what()))));
    return static_cast<int>(error.kind());
  } catch (const CLI::Success& success) {
    return guarded(
        [&] {
          std::ostringstream text;
          const int code = line.app.exit(success, text, text);
          put(stdout, text.str());
          return code;
        },
        say_on_stderr);
  } catch (const CLI::ParseError& error) {
    put(stderr, fmt::format("tetropolis: {}\n", one_line(usage_message(line.app, error))));
    return static_cast<int>(ErrorKind::kUsage);
  }
  return guarded(
      [&] {
        require_address_space();
        return line.action();
      },
      say_on_stderr);
}
