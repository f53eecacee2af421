#include "scenes/cli/manual.h"

#include <fmt/format.h>

#include "scenes/cli/list.h"
#include "scenes/cli/print.h"
#include "scenes/version.h"

namespace epafi {
namespace {

/// Text for roff: backslashes doubled, hyphens that can be copied, no line that begins like a request.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return !out.empty() && (out[0] == '.' || out[0] == '\'') ? "\\&" + out : out;
}

/// "--out" of "-o,--out"; the only name where there is one.
std::vector<std::string> names_of_option(const std::string& names) {
  std::vector<std::string> out(1);
  for (const char c : names)
    if (c == ',')
      out.emplace_back();
    else
      out.back() += c;
  return out;
}

constexpr const char* exits[][2] = {{"0", "done"},
                                    {"1", "a bound of the scene was violated"},
                                    {"2", "wrong scene or usage"},
                                    {"3", "input or output"},
                                    {"4", "the simulation failed; the last good state is saved"},
                                    {"75", "stopped by --time-limit after a checkpoint; epafi resume goes on"},
                                    {"130, 143", "SIGINT, SIGTERM after a checkpoint"}};

}  // namespace

std::string manual_page(const ProgramText& program) {
  std::string out = fmt::format(".TH EPAFI 1 \"\" \"Epafi {}\" \"User Commands\"\n.SH NAME\nepafi \\- {}\n", version(),
                                "many\\-body contact: smooth and non\\-smooth mechanics on one scene file");
  out += ".SH SYNOPSIS\n.B epafi\n.I command\n[\\fIarguments\\fR]\n.SH COMMANDS\n";
  for (const auto& c : program.commands) {
    std::string places;
    for (const auto& o : c.options)
      if (o.positional) places += " \\fI" + roff(o.names) + "\\fR";
    out += ".SS \"epafi " + roff(c.name) + places + "\"\n" + roff(c.description) + ".\n";
    for (const auto& o : c.options) {
      std::string names;
      for (const auto& n : names_of_option(o.names)) names += (names.empty() ? "" : ", ") + roff(n);
      out += fmt::format(".TP\n{}{}{}\n{}\n", o.positional ? "\\fI" : "\\fB", names,
                         o.takes_value && !o.positional ? "\\fR \\fIvalue\\fR" : "\\fR", roff(o.description));
    }
  }
  out += ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : exits) out += fmt::format(".TP\n.B {}\n{}\n", code, roff(meaning));
  out +=
      ".SH FILES\n.TP\n.I out/NAME/summary.json\nwhat came out: energies, overlap, residual, measures, state hash\n"
      ".TP\n.I out/NAME/measures.csv\ntime, measure, component, value\n.TP\n.I out/NAME/run.h5\nsnapshots, measures, "
      "scene text\n"
      ".TP\n.I out/NAME/checkpoint.h5\nwhat epafi resume reads\n.TP\n.I out/NAME/frames.pvd\nfor ParaView\n";
  return out +
         ".SH EXAMPLES\n.nf\nepafi new hopper > hopper.toml\nepafi check hopper.toml\nepafi run hopper.toml \\-\\-set "
         "params.n=500\n"
         "epafi report out/hopper\n.fi\n";
}

std::string bash_completion(const ProgramText& program) {
  std::string commands, cases;
  for (const auto& c : program.commands) {
    commands += (commands.empty() ? "" : " ") + c.name;
    std::string options;
    for (const auto& o : c.options)
      if (!o.positional)
        for (const auto& n : names_of_option(o.names)) options += " " + n;
    cases += fmt::format("    {}) options=\"--help{}\" ;;\n", c.name, options);
  }
  std::string kinds;
  for (const auto& k : list_kinds()) kinds += (kinds.empty() ? "" : " ") + k;
  return "# bash completion for epafi; source it, or put it into "
         "/usr/share/bash-completion/completions/epafi\n_epafi() {\n"
         "  local word=\"${COMP_WORDS[COMP_CWORD]}\" command=\"${COMP_WORDS[1]}\" options=\"\"\n  COMPREPLY=()\n"
         "  if [ \"$COMP_CWORD\" -eq 1 ]; then COMPREPLY=($(compgen -W \"" +
         commands +
         " --help --version\" -- \"$word\")); return; fi\n"
         "  case \"$command\" in\n" +
         cases +
         "  esac\n"
         "  case \"$word\" in -*) COMPREPLY=($(compgen -W \"$options\" -- \"$word\")); return ;; esac\n"
         "  case \"$command\" in\n"
         "    list) COMPREPLY=($(compgen -W \"" +
         kinds +
         "\" -- \"$word\")) ;;\n"
         "    new) COMPREPLY=($(compgen -W \"hopper stack impact pile\" -- \"$word\")) ;;\n"
         "    resume|export|report|reference) COMPREPLY=($(compgen -d -- \"$word\")) ;;\n"
         "    solve) COMPREPLY=($(compgen -f -X '!*.@(hdf5|dat)' -- \"$word\") $(compgen -d -- \"$word\")) ;;\n"
         "    *) COMPREPLY=($(compgen -f -X '!*.toml' -- \"$word\") $(compgen -d -- \"$word\")) ;;\n"
         "  esac\n}\nshopt -s extglob\ncomplete -o filenames -F _epafi epafi ./epafi\n";
}

int command_manual(const ProgramText& program) {
  print(manual_page(program));
  return 0;
}

int command_completion(const ProgramText& program) {
  print(bash_completion(program));
  return 0;
}

}  // namespace epafi
