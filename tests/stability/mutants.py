"""Small faults to plant in the sources: what scripts/mutate changes, and how it chooses.

A fault is planted as an expression of planted.h, which does what the source says unless the fault is switched on when the
program runs. So one build holds hundreds of them.
"""

import dataclasses
import json
import pathlib
import random
import re

FOLDERS = ("core", "parallel", "render", "experiments/metrics")
HEADER = pathlib.Path(__file__).with_name("planted.h")

# (kind, pattern, what it becomes, how it is planted: # is the number of the fault). The sources are formatted, so that
# binary operators stand between blanks, and the brackets of templates do not.
RULES = [
    ("comparison", r" < ", " <= ", " < planted::less<#>{} < "),
    ("comparison", r" <= ", " < ", " <= planted::less_equal<#>{} <= "),
    ("comparison", r" > ", " >= ", " > planted::greater<#>{} > "),
    ("comparison", r" >= ", " > ", " >= planted::greater_equal<#>{} >= "),
    ("comparison", r" == ", " != ", " == planted::equal<#>{} == "),
    ("comparison", r" != ", " == ", " != planted::unequal<#>{} != "),
    ("sign", r" \+ (?!1\b(?!\.))", " - ", " + planted::plus<#>{} + "),
    ("sign", r" - (?!1\b(?!\.))", " + ", " - planted::minus<#>{} - "),
    ("sign", r" \+= ", " -= ", " += planted::add<#>{} += "),
    ("bound", r" \+ 1\b(?!\.)", "", " + planted::plus_one<#>{} + 1"),
    ("bound", r" - 1\b(?!\.)", "", " - planted::minus_one<#>{} - 1"),
    ("bound", r"\bstd::min\(", "std::max(", "planted::smaller<#>("),
    ("bound", r"\bstd::max\(", "std::min(", "planted::larger<#>("),
    ("bound", r"\bstd::ceil\(", "std::floor(", "planted::up<#>("),
    ("bound", r"\bstd::floor\(", "std::ceil(", "planted::down<#>("),
    ("logic", r" && ", " || ", "both"),
    ("logic", r" \|\| ", " && ", "either"),
    ("logic", r"(?<=\()!(?=[\w(])", "", "planted::on<#>() != !"),
    ("logic", r"(?<=return )true(?=;)", "false", "!planted::on<#>()"),
    ("logic", r"(?<=return )false(?=;)", "true", "planted::on<#>()"),
    ("flow", r"(?<= )continue;", ";", "{ if (!planted::on<#>()) continue; }"),
    ("flow", r"(?<= )break;", ";", "{ if (!planted::on<#>()) break; }"),
    ("lock", r"(?:const )?\bstd::(?:scoped_lock|lock_guard)(?:<[^;]*>)? (\w+)[({]([^;]*)[)}];", "",
     r"const auto \1 = planted::lock<#>(\2);"),
]


@dataclasses.dataclass(frozen=True)
class Mutant:
    file: str
    line: int
    kind: str
    start: int    # offsets in the file of what the fault changes
    end: int
    new: str
    first: int    # offsets of what is replaced to plant it
    last: int
    planted: str

    def apply(self, text):
        return text[:self.start] + self.new + text[self.end:]


def code_alone(text):
    """The text with comments, strings, preprocessor lines, assertions and constants blanked, every offset kept."""
    blank = lambda found: re.sub(r"[^\n]", "\0", found[0])  # noqa: E731
    text = re.sub(r'R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|//[^\n]*|/\*.*?\*/', blank, text,
                  flags=re.DOTALL)
    return re.sub(r"(?m)^\s*#.*$|\b(?:static_)?assert\(.*?\);|\bif constexpr \(.*\)|\bconstexpr\b[^;({]*[={][^;]*;|"
                  r"\brequires\b.*$", blank, text)


# Where the operands of a logical operator end: at an assignment, a comma, the parts of a conditional, an operator of
# lower precedence.
BEFORE = {"both": r" \|\| | \? | : |, |;|\breturn | [-+|&]?= ", "either": r" \? | : |, |;|\breturn | [-+|&]?= "}
AFTER = {"both": r" && | \|\| | \? | : |,|;", "either": r" \|\| | \? | : |,|;"}


def operand(code, at, step, limit):
    """The other end of the operand that begins or ends at `at`, going backward or forward over brackets that match."""
    depth = 0
    opening, closing = ("([{", ")]}") if step > 0 else (")]}", "([{")
    while 0 <= at - (step < 0) and at < len(code):
        char = code[at if step > 0 else at - 1]
        if char in closing and depth == 0:
            return at
        if depth == 0 and step > 0 and limit.match(code, at):
            return at
        if depth == 0 and step < 0 and (found := limit.search(code, max(0, at - 8), at)) and found.end() == at:
            return at
        depth += (char in opening) - (char in closing)
        at += step
    return at


def planting(code, text, found, how):
    """What to replace, and by what."""
    if how not in BEFORE:
        return found.start(), found.end(), found.expand(how) if "\\" in how else how
    before = re.compile(f"(?:{BEFORE[how]})$")
    first = operand(code, found.start(), -1, before)
    last = operand(code, found.end(), 1, re.compile(AFTER[how]))
    left, right = text[first:found.start()], text[found.end():last]
    return first, last, f"planted::{how}<#>([&] {{ return bool({left}); }}, [&] {{ return bool({right}); }})"


def mutants_of(file, text):
    code = code_alone(text)
    for kind, pattern, new, how in RULES:
        for found in re.finditer(pattern, code):
            first, last, planted = planting(code, text, found, how)
            yield Mutant(file, text.count("\n", 0, found.start()) + 1, kind, found.start(), found.end(), new, first, last,
                         planted)


def all_mutants(root):
    root = pathlib.Path(root)
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*.cpp")):
            yield from mutants_of(path.relative_to(root).as_posix(), path.read_text())


def commands_by_source(build, root):
    """The entry of compile_commands.json that compiles each source file, alone or by a file of build/merged that includes
    those of its folder."""
    commands = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        path = pathlib.Path(entry["file"])
        merged = re.findall(r'#include "(.+)"', path.read_text()) if build / "merged" in path.parents else []
        commands |= dict.fromkeys(merged or [path.relative_to(root).as_posix()], entry)
    return commands


def choose(mutants, seed, each=4):
    """An order in which to try them. Compiling costs by the file, so faults are drawn in groups: files at random, by the
    number of their places, and `each` of a file at random. Any beginning is a fair sample of all places."""
    random_ = random.Random(seed)
    files = {}
    for mutant in mutants:
        files.setdefault(mutant.file, []).append(mutant)
    # The order of drawing without replacement, by weight.
    order = sorted(files, key=lambda file: -random_.random() ** (1 / len(files[file])))
    for file in order:
        yield from random_.sample(files[file], min(each, len(files[file])))


def apart(mutants):
    """Those that touch none before them, so that they can be planted together."""
    taken = {}
    for mutant in mutants:
        places = taken.setdefault(mutant.file, [])
        if all(mutant.last <= first or last <= mutant.first for first, last in places):
            places.append((mutant.first, mutant.last))
            yield mutant


def plant(text, numbered):
    """The text of a file with these faults, {number: mutant}, to be switched on by number."""
    for number, mutant in sorted(numbered.items(), key=lambda item: -item[1].first):
        text = text[:mutant.first] + mutant.planted.replace("<#>", f"<{number}>") + text[mutant.last:]
    return f'#include "{HEADER}"\n' + text
