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
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <poll.h>
#include <unistd.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/system_memory.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/core/version.h"
#include "tetropolis/io/file/write_file.h"
#include "tetropolis/run/output_folder.h"
#include "tetropolis/run/progress.h"
#include "tetropolis/run/run.h"

#include "arguments.h"
#include "case_command.h"
#include "choice.h"
#include "commands.h"
#include "console.h"
#include "help.h"
#include "interrupts.h"
#include "options.h"
#include "reference.h"
#include "render_command.h"
#include "summary.h"

namespace {

namespace fs = std::filesystem;
using namespace tetropolis;
using namespace tetropolis::app;

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
  std::vector<fs::path> inputs{other};
  for (const std::string& file : input_files(config)) inputs.emplace_back(file);
  const bool is_input = std::any_of(inputs.begin(), inputs.end(), [&](const fs::path& input) {
    return fs::equivalent(input, log, error);
  });
  const bool is_beside = std::any_of(inputs.begin(), inputs.end(), [&](const fs::path& input) {
    return is_side_file(log, input);
  });
  if (is_input || is_beside)
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
  Console console(config);
  return guarded([&] { return action(console); },
                 [&](const std::string& line) { console.error(line); }, out_of_memory);
}

using RunFunction = Report (*)(const Config&, const RunHooks&);

int run(const ConfigOptions& options, Command command, RunFunction function) {
  const Config config = options.config();
  return with_console(
      config, options.file(),
      [&](Console& console) {
        RunProgress progress(command, config);
        const Report report = function(config, console.hooks(progress));
        console.stage_line(progress.finish());
        for (const std::string& text : summary(report)) console.line(text);
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
  put(stderr, fmt::format("wrote {}; use it with --config {}\n", path, path));
}

/// The commands, and where CLI11 puts what it finds. It keeps addresses of all of this.
struct CommandLine {
  CLI::App app{"Tetropolis: from building footprints and LiDAR to simulation-ready city meshes",
               "tetropolis"};
  std::function<int()> action;         ///< What the chosen command does; it returns the exit code.
  std::vector<std::string> files;      ///< Of info.
  std::string checked;                 ///< Of check.
  std::optional<double> min_distance;  ///< Of check.
  RenderArguments picture;             ///< Of render.
  CaseArguments flow;                  ///< Of case.
  std::string settings{"tetropolis.toml"};  ///< Of init.
  std::string topic;                        ///< Of help and completions.

  CommandLine() = default;
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;
};

/// Has `command` do `act` if it is the one that is chosen.
void on_choice(CommandLine& line, CLI::App& command, std::function<int()> act) {
  command.callback([&line, act = std::move(act)] { line.action = act; });
}

void add_run(CommandLine& line, const std::string& name, const std::string& help, Command command,
             RunFunction function, const std::string& example) {
  CLI::App& added = *line.app.add_subcommand(name, help);
  added.footer(example);
  const auto options = std::make_shared<ConfigOptions>(added, command);
  on_choice(line, added, [options, command, function] { return run(*options, command, function); });
}

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

/// Runs `act` with a console for what is at `where`. `added` has the settings of `check`.
template <typename Act>
void on_console(CommandLine& line, CLI::App& added, const std::string& where, const Act& act) {
  const auto options = std::make_shared<ConfigOptions>(added, kCheck);
  on_choice(line, added, [options, &where, act] {
    const Config config = options->config();
    const ThreadLimit limit(config.threads);
    return with_console(config, where, [&](Console& console) {
      act(console);
      return 0;
    });
  });
}

void add_render(CommandLine& line) {
  CLI::App& added = *line.app.add_subcommand(
      "render", "Draw a folder of results, a mesh or a city model as a PNG picture");
  add_render_options(added, line.picture);
  added.footer("tetropolis render city -o section.png --view section");
  on_console(line, added, line.picture.path,
             [&line](Console& console) { render(line.picture, console); });
}

void add_case(CommandLine& line) {
  CLI::App& added = *line.app.add_subcommand(
      "case", "Make a folder of results a case of wind that a solver runs as it is");
  add_case_options(added, line.flow);
  added.footer("tetropolis case openfoam city --wind-speed 5 --wind-from 240 --roughness 0.5");
  on_console(line, added, line.flow.folder,
             [&line](Console& console) { make_case(line.flow, console); });
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

/// Commands that print a text about the command line itself.
void add_text(CommandLine& line, const std::string& name, const std::string& help,
              std::function<std::string()> text) {
  CLI::App& added = *line.app.add_subcommand(name, help);
  added.group("");
  on_choice(line, added, [text = std::move(text)] {
    put(stdout, text());
    return 0;
  });
}

void add_help(CommandLine& line) {
  CLI::App& added = *line.app.add_subcommand("help", "What a command does, and its options");
  added.add_option("command", line.topic)->type_name("[COMMAND]");
  on_choice(line, added, [&line] {
    const CLI::App* topic = line.topic.empty() ? &line.app : nullptr;
    for (const CLI::App* command : line.app.get_subcommands({}))
      if (command->get_name() == line.topic) topic = command;
    if (topic == nullptr) throw Error(ErrorKind::kUsage, unknown_command(line.app, line.topic));
    put(stdout, help_text(*topic, CLI::AppFormatMode::Normal, terminal_width(STDOUT_FILENO)));
    return 0;
  });
}

void add_completions(CommandLine& line) {
  CLI::App& added =
      *line.app.add_subcommand("completions", "Completions for a shell: bash, zsh or fish");
  added.add_option("shell", line.topic)->required()->type_name("SHELL");
  added.footer("source <(tetropolis completions bash)");
  on_choice(line, added, [&line] {
    put(stdout, completions(line.app, line.topic));
    return 0;
  });
}

void declare(CommandLine& line) {
  line.app.set_version_flag("-V,--version", std::string("tetropolis ") + kVersion);
  line.app.set_help_all_flag("--help-all", "Print all options and exit");
  line.app.formatter_fn([](const CLI::App* app, const std::string&, CLI::AppFormatMode mode) {
    return help_text(*app, mode, terminal_width(STDOUT_FILENO));
  });
  line.app.require_subcommand(1);
  line.app.footer(
      "First steps:\n"
      "  tetropolis synth input                 # a synthetic city to try things on\n"
      "  tetropolis build input/footprints.shp input city\n"
      "  tetropolis check city\n"
      "\n'tetropolis help COMMAND' lists the options of a command.\n");
  add_run(line, "build", "Footprints and points to a city model, a volume mesh and a surface",
          kBuild, run_build, "tetropolis build footprints.gpkg points/ city --mesh-size 5");
  add_run(line, "city", "Footprints and points to a city model and a terrain (steps 1 and 2)",
          kCity, run_city, "tetropolis city footprints.gpkg points/ model");
  add_run(line, "mesh", "A city model and a terrain to meshes (step 3)", kMesh, run_mesh,
          "tetropolis mesh model/city.city.json model/dtm.tif mesh --mesh-size 5");
  add_run(line, "synth", "Invent a city: footprints and points", kSynth, run_synth,
          "tetropolis synth invented --kind blocks --size 500");
  add_info(line);
  add_check(line);
  add_render(line);
  add_case(line);
  add_init(line);
  add_help(line);
  add_completions(line);
  add_text(line, "man", "The manual page", [&line] { return man_page(line.app); });
  add_text(line, "settings", "All settings as Markdown tables", config_markdown);
  add_text(line, "report-keys", "All keys of report.json as a Markdown table", report_markdown);
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

}  // namespace

int main(int argc, char** argv) {
#ifdef __GLIBC__
  // Left alone, the allocator learns from large arrays that are freed to keep their memory.
  mallopt(M_MMAP_THRESHOLD, 1 << 18);
  mallopt(M_TRIM_THRESHOLD, 8 << 20);
#endif
  catch_interrupts();
  CommandLine line;
  declare(line);
  if (argc <= 1) {
    put(stderr, help_text(line.app, CLI::AppFormatMode::Normal, terminal_width(STDERR_FILENO)));
    return static_cast<int>(ErrorKind::kUsage);
  }
  try {
    line.app.parse(arguments(line.app, argc, argv));
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
