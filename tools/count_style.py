#!/usr/bin/env python3
"""Counts what CONTRIBUTING's style page asks for, over all files that git knows.

  tools/count_style.py [--list KIND] [--links] [--check]

Prints: functions over 50 lines, files over 500 lines, comma chains, lines over 120 characters, commit subjects over 72
characters, words per page, median depth of includes, table cells over 25 words, links without a target, pages with
other figures than the table. --list KIND names the places of one kind; --links alone checks links and ends with 1 where
a page, picture or heading is missing; --check names all places but links and subjects and ends with 1 where there is
one. Reads text only; functions of C++ are found by indentation (a body from a brace at the end of an unindented line to
a brace in column 1), so that class members and lambdas are not counted by
themselves.
"""
import argparse
import ast
import functools
import pathlib
import re
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCES = {".h", ".cpp"}
LINES_COUNTED = SOURCES | {".cmake", ".css", ".html", ".js", ".mjs", ".py", ".sbatch", ".sh", ".toml"}
DATA = ("tests/data/", "viz_export/view/glyphs.h", "viz_export/view/more_glyphs.h")  # tables that tools write
MOST_LINES_OF_A_FILE = 500
MOST_LINES_OF_A_FUNCTION = 50
MOST_CHARACTERS_OF_A_LINE = 120
MOST_CHARACTERS_OF_A_SUBJECT = 72
MOST_WORDS_OF_A_CELL = 25
MOST_DEPTH_OF_INCLUDES = 8
FLOORS = ["engine", "detection", "laws", "ranks", "viz_export", "scenes"]
# Statements whose outermost commas join declarations, not expressions.
DECLARATION = re.compile(r"^(const|constexpr|inline|mutable|static|alignas|using|template|return\s*\{|case|"
                         r"(?!return|delete|throw|goto)[A-Za-z_][\w:]*(<.*>)?(\s*[&*]+\s*|\s+)(const\s+)?[A-Za-z_]\w*)")
# `matrix << a, b;`: Eigen's list of coefficients, none of which assigns.
COEFFICIENTS = re.compile(r"^[^=]*?<<[^=]*$")
LABEL = re.compile(r"^(case\b.*|default|public|private|protected)\s*:$")
SOURCE_NAME = re.compile(r"`((?:cmake|detection|engine|examples|laws|perf|ranks|scenes|tests|tools|viz_export)/"
                         r"[\w/.-]+\.(?:h|cpp|py|sh|cmake|toml|csv|bin|txt))[`: ]")
KINDS_CHECKED = ("functions", "files", "chains", "lines", "cells")
CONTROL = re.compile(r"^(else\s+)?(if|for|while)\s*(constexpr\s*)?\(|^else\s+")


def tracked_files():
    """All files of the last commit and the index that are there; without git, all outside of build folders."""
    listed = subprocess.run(["git", "-C", ROOT, "ls-files"], capture_output=True, text=True)
    if listed.returncode == 0:
        return [ROOT / name for name in listed.stdout.splitlines() if (ROOT / name).is_file()]
    return [path for path in sorted(ROOT.rglob("*")) if path.is_file()
            and not re.match(r"(build|out|\.git)", path.relative_to(ROOT).parts[0])]


def pages():
    return [path for path in tracked_files() if path.suffix == ".md"]


def has_counted_lines(path):
    """Whether people write the file line by line: code, build files, scripts with or without a suffix; no data."""
    if path.relative_to(ROOT).as_posix().startswith(DATA):
        return False
    if path.suffix in LINES_COUNTED or path.name == "CMakeLists.txt":
        return True
    with open(path, "rb") as file:
        return not path.suffix and file.read(2) == b"#!"


def without_literals(line):
    """The line with empty strings, no characters and no comment."""
    line = re.sub(r"\"(\\.|[^\"\\])*\"|'(\\.|[^'\\])'", '""', line)
    return line.split("//")[0]


def outer_commas(statement):
    """Commas outside of all brackets and template arguments."""
    statement = re.sub(r"decltype\([^()]*\)", "x", statement)
    inner = None
    while inner != statement:
        inner = statement
        statement = re.sub(r"\w<[^<>;()]*>", "x", statement)
    depth = 0
    count = 0
    for character in statement:
        depth += character in "([{"
        depth -= character in ")]}"
        count += character == "," and depth == 0
    return count


def without_control(line):
    """The statement behind `if (...)`, `else`, `for (...)`, `while (...)` of a line."""
    while control := CONTROL.match(line):
        end = control.end()
        depth = 1 if line[end - 1] == "(" else 0
        while end < len(line) and depth:
            depth += line[end] == "("
            depth -= line[end] == ")"
            end += 1
        line = line[end:].strip()
    return line


def inner_statements(line):
    """Statements that begin and end inside braces of one line."""
    starts = []
    for place, character in enumerate(line):
        if character == "{":
            starts.append(place + 1)
        elif character == "}" and starts:
            starts.pop()
        elif character == ";" and starts:
            statement = line[starts[-1]:place].strip()
            if statement.count("(") == statement.count(")"):
                yield statement
                starts[-1] = place + 1


def is_chain(statement):
    """Whether a statement without its semicolon joins expressions by commas."""
    part = without_control(statement)
    if DECLARATION.match(part) or COEFFICIENTS.match(part) or part.count("}") > part.count("{"):
        return False
    return bool(outer_commas(part) and re.search(r"[=(]|\+\+|--", part))


def comma_chains(lines):
    """Numbers of lines on which a statement `a, b;` of expressions ends; statements over several lines are joined."""
    found = []
    statement = ""
    text = re.sub(r'R"(\w*)\((.*?)\)\1"', lambda raw: '""' + '\n""' * raw[0].count("\n"), "\n".join(lines), flags=re.S)
    for number, raw in enumerate(text.splitlines(), 1):
        line = without_literals(raw).strip()
        if line.startswith("#"):
            continue
        if any(is_chain(inner) for inner in inner_statements(line)):
            found.append(number)
        statement = f"{statement} {line}".strip()
        if not line or line[-1] in "{}" or LABEL.match(line):
            statement = ""
            continue
        if line[-1] != ";" or statement.count("(") > statement.count(")"):
            continue
        if is_chain(statement[:-1]):
            found.append(number)
        statement = ""
    return found


def long_functions(lines):
    """(first line, number of lines) of functions at the outermost level whose body is too long."""
    found = []
    start = None
    for number, line in enumerate(lines, 1):
        opens = line.rstrip().endswith("{") and line[:1] not in (" ", "}", "\t")
        if opens and "(" in line and not re.match(r"(namespace|struct|class|enum|union|extern)\b", line):
            start = number
        elif re.match(r"    .*\)\s*(const\s*)?(noexcept\s*)?\{$", line) and start is None and number > 1:
            if not lines[number - 2].startswith(" ") and "(" in lines[number - 2]:
                start = number - 1
        elif line.startswith("}") and start is not None:
            if number - start - 1 > MOST_LINES_OF_A_FUNCTION:
                found.append((start, number - start - 1))
            start = None
    return found


def long_python_functions(text):
    """(first line, number of lines) of functions at any level whose body, with its docstring, is too long."""
    return [(node.lineno, node.end_lineno - node.lineno) for node in ast.walk(ast.parse(text))
            if isinstance(node, ast.FunctionDef) and node.end_lineno - node.lineno > MOST_LINES_OF_A_FUNCTION]


def prose_lines(text):
    """(number, line) outside fenced blocks."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            fenced = not fenced
        elif not fenced:
            yield number, line


def shown(text):
    """Without comments, line by line: patterns of tables are none of a page's words."""
    return re.sub(r"<!--.*?-->", lambda hidden: "\n" * hidden[0].count("\n"), text, flags=re.DOTALL)


def long_cells(text):
    """(line, words) of table cells with too many words; commands between backticks count as one word."""
    for number, line in prose_lines(text):
        if not line.startswith("|"):
            continue
        for cell in line.strip().strip("|").split(" | "):
            words = len(re.sub(r"`[^`]*`", "code", cell).split())
            if words > MOST_WORDS_OF_A_CELL:
                yield number, words


@functools.cache
def anchors(page):
    """Names of the headings of a page as GitHub makes them."""
    names = set()
    for _, line in prose_lines(page.read_text()):
        if line.startswith("#"):
            title = re.sub(r"[`*]", "", line.lstrip("#").strip().lower())
            names.add(re.sub(r"[^\w\- ]", "", title).replace(" ", "-"))
    return names


def broken_links(page):
    """(line, target) of links in a page that lead nowhere in the tree, and of files that it names by their folder."""
    for number, line in prose_lines(page.read_text()):
        for name in [] if "docs/history" in page.as_posix() else SOURCE_NAME.findall(line):
            if not (ROOT / name).exists():
                yield number, name
        for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", line)):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, anchor = target.partition("#")
            to = (page.parent / name).resolve() if name else page
            if not to.exists() or (anchor and to.suffix == ".md" and anchor not in anchors(to)):
                yield number, target


def find_all():
    """Places of every kind: {kind: [(path, line, what)]}."""
    places = {kind: [] for kind in ("functions", "files", "chains", "lines", "cells", "links")}
    for path in tracked_files():
        name = path.relative_to(ROOT).as_posix()
        if path.suffix == ".md":
            text = path.read_text()
            places["cells"] += [(name, line, f"{words} words") for line, words in long_cells(shown(text))]
            places["links"] += [(name, line, target) for line, target in broken_links(path)]
        if path.suffix == ".py":
            text = path.read_text()
            count = text.count("\n")
            if count > MOST_LINES_OF_A_FILE:
                places["files"].append((name, 1, f"{count} lines"))
            places["functions"] += [(name, line, f"{length} lines") for line, length in long_python_functions(text)]
        if path.suffix in SOURCES:
            lines = path.read_text(errors="replace").splitlines()
            if len(lines) > MOST_LINES_OF_A_FILE:
                places["files"].append((name, 1, f"{len(lines)} lines"))
            places["functions"] += [(name, line, f"{length} lines") for line, length in long_functions(lines)]
            places["chains"] += [(name, line, lines[line - 1].strip()) for line in comma_chains(lines)]
        if has_counted_lines(path):
            lines = path.read_text(errors="replace").splitlines()
            places["lines"] += [(name, number, f"{len(line)} characters") for number, line in enumerate(lines, 1)
                                if len(line) > MOST_CHARACTERS_OF_A_LINE]
    return places


def include_depth():
    """Median over the .cpp files of the program of the longest chain of its headers that they include."""
    sources = [path for folder in FLOORS for path in (ROOT / folder).rglob("*") if path.suffix in (".h", ".cpp")]
    included = {path.relative_to(ROOT).as_posix(): re.findall(r'^#include "([^"]+)"', path.read_text(), re.M)
                for path in sources}

    @functools.cache
    def depth(name):
        return max((1 + depth(other) for other in included[name] if other in included), default=0)

    return statistics.median(depth(name) for name in included if name.endswith(".cpp"))


def long_subjects():
    """Subjects of all commits that are too long."""
    log = subprocess.run(["git", "-C", ROOT, "log", "--format=%h %s"], capture_output=True, text=True).stdout
    return [line for line in log.splitlines() if len(line.partition(" ")[2]) > MOST_CHARACTERS_OF_A_SUBJECT]


def differing_figures():
    """What tools/figures.py says of pages that do not hold the figures of docs/performance/figures.csv."""
    ran = subprocess.run([sys.executable, ROOT / "tools/figures.py", "--check"], capture_output=True, text=True)
    return ran.stdout.splitlines() if ran.returncode else []


def print_summary(places):
    """All counts, then words per page."""
    titles = {"functions": f"functions over {MOST_LINES_OF_A_FUNCTION} lines",
              "files": f"files over {MOST_LINES_OF_A_FILE} lines",
              "chains": "comma chains",
              "lines": f"lines over {MOST_CHARACTERS_OF_A_LINE} characters",
              "cells": f"table cells over {MOST_WORDS_OF_A_CELL} words",
              "links": "links without a target"}
    for kind, title in titles.items():
        print(f"{len(places[kind]):6d}  {title}")
    print(f"{len(long_subjects()):6d}  commit subjects over {MOST_CHARACTERS_OF_A_SUBJECT} characters")
    print(f"{include_depth():6.0f}  median depth of includes of .cpp files (at most {MOST_DEPTH_OF_INCLUDES})")
    print(f"{len(differing_figures()):6d}  pages with other figures than docs/performance/figures.csv")
    counts = [(len(shown(page.read_text()).split()), page.relative_to(ROOT).as_posix()) for page in pages()]
    counts.sort(reverse=True)
    print(f"{sum(count for count, _ in counts):6d}  words in {len(counts)} pages:")
    for count, name in counts:
        print(f"{count:12d}  {name}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", choices=["functions", "files", "chains", "lines", "cells", "links", "subjects"])
    parser.add_argument("--links", action="store_true")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    if options.list == "subjects":
        print("\n".join(long_subjects()))
        return 0
    if options.links:
        broken = [(page, line, target) for page in pages() for line, target in broken_links(page)]
        for page, line, target in broken:
            print(f"{page.relative_to(ROOT)}:{line}: {target} is not there")
        return 1 if broken else 0
    places = find_all()
    if options.check:
        wrong = [place for kind in KINDS_CHECKED for place in places[kind]]
        for name, line, what in wrong:
            print(f"{name}:{line}: {what}")
        depth = include_depth()
        if depth > MOST_DEPTH_OF_INCLUDES:
            print(f"median depth of includes of .cpp files: {depth:.0f}, at most {MOST_DEPTH_OF_INCLUDES} is allowed")
        return 1 if wrong or depth > MOST_DEPTH_OF_INCLUDES else 0
    if not options.list:
        print_summary(places)
    for name, line, what in places[options.list] if options.list else []:
        print(f"{name}:{line}: {what}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
