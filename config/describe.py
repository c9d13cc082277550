#!/usr/bin/env python3
"""Man pages and a completion for bash, from what the program says of itself.

    config/describe.py PROGRAM FOLDER

writes trapeze.1 and trapeze.toml.5, both also compressed, and trapeze.bash into the folder. What
they tell is read from `trapeze COMMAND --help`, `trapeze config schema` and `trapeze parameters`:
an option, a setting or a parameter is described in the program alone.
"""

import dataclasses
import datetime
import gzip
import itertools
import json
import os
import pathlib
import re
import subprocess
import sys
import textwrap


@dataclasses.dataclass
class Entry:
    """A line of a list in the help: an option, a positional or a command, and what it is for."""

    names: list
    operand: str  # FILE, NAME; empty if it takes none
    text: str


@dataclasses.dataclass
class Command:
    path: list  # of `trapeze config check`: config, check
    summary: str
    usage: str
    lists: dict  # by heading: Positionals, Options, Subcommands
    notes: list  # what follows the lists, line by line
    commands: list


def said_by(program, *arguments):
    return subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout


def entry_of(head, text):
    head = head.replace(" REQUIRED", "").replace(" TEXT", "")
    names, _, operand = head.partition(" ")
    operand = re.sub(r":\w+ in \[.*\]", "", operand)
    repeats = operand.endswith("...")
    operand = operand.removesuffix("...").strip() + (" ..." if repeats else "")
    return Entry(names.split(","), operand.strip(), text)


def lists_of(lines):
    """The lists at the head of `lines`, which are taken away."""
    lists = {}
    heading = None
    while lines:
        line = lines[0]
        if match := re.fullmatch(r"(Positionals|Options|Subcommands):", line):
            heading = lists.setdefault(match[1], [])
        elif heading is not None and (match := re.fullmatch(r"  (\S.*?)(?:\s{2,}(\S.*))?", line)):
            heading.append(entry_of(match[1], match[2] or ""))
        elif heading and (match := re.fullmatch(r"\s{20,}(\S.*)", line)):
            heading[-1].text = f"{heading[-1].text} {match[1]}".strip()
        elif line.strip():
            break
        lines.pop(0)
    return lists


def command_of(program, path=()):
    said, _, rest = said_by(program, *path, "--help").partition("Usage: ")
    usage, *lines = rest.split("\n")
    lists = lists_of(lines)
    names = [entry.names[0] for entry in lists.get("Subcommands", [])]
    said = said.strip().split("\n")
    # The program itself has its notes before the lists, a command after them.
    notes = said[1:] if not path else lines
    return Command(list(path), said[0], usage, lists, "\n".join(notes).strip().split("\n"),
                   [command_of(program, [*path, name]) for name in names])


def all_commands(command):
    yield command
    for inner in command.commands:
        yield from all_commands(inner)


def choices_of(entry):
    """What an option takes that takes one of a few words; its text lists them."""
    if entry.operand not in ("NAME", "SYSTEM"):
        return []
    plain = re.sub(r"\s*\([^)]*\)", "", entry.text).replace('"', "")
    word = r"[\w-]+(?::\w+)?"
    match = re.search(rf"(?:^|: |Takes )({word}(?:, {word})* or {word})", plain)
    return re.split(r", | or ", match[1]) if match else []


# Man pages


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq").replace("`", "\\(ga")
    return text.replace("^", "\\(ha").replace("~", "\\(ti")


def filled(text):
    lines = textwrap.wrap(roff(text), 79, break_long_words=False, break_on_hyphens=False)
    return "\n".join(f"\\&{line}" if line.startswith(".") else line for line in lines)


def sentences(text):
    return filled(text[:1].upper() + text[1:] + "."[: not text.endswith(".")])


def page(name, section, version, lines):
    stamp = int(os.environ.get("SOURCE_DATE_EPOCH", datetime.datetime.now().timestamp()))
    date = datetime.datetime.fromtimestamp(stamp, datetime.timezone.utc).date()
    head = f'.TH {roff(name.upper())} {section} {date} "{version}"'
    return "\n".join([head, *lines]) + "\n"


def notes_in_roff(lines):
    """Paragraphs, and indented lines, which are commands, as they stand."""
    for is_code, group in itertools.groupby(filter(None, lines), lambda line: line.startswith(" ")):
        if is_code:
            yield from [".RS 4", ".nf", *(roff(line[2:]) for line in group), ".fi", ".RE"]
        else:
            yield from [".PP", filled(" ".join(group))]


def entries_in_roff(entries):
    for entry in entries:
        names = ", ".join(f"\\fB{roff(name)}\\fR" for name in entry.names)
        yield from [".TP", f"{names} \\fI{roff(entry.operand)}\\fR" if entry.operand else names]
        yield sentences(entry.text)


def synopsis_of(command):
    words = command.usage.split()
    operands = [word for word in words[1:] if word not in command.path]
    name = " ".join(["trapeze", *command.path])
    return f"\\fB{roff(name)}\\fR {roff(' '.join(operands))}"


def program_page(program):
    yield from [".SH NAME", f"trapeze \\- {roff(program.summary.rstrip('.').replace('Trapeze serves', 'serves'))}"]
    yield ".SH SYNOPSIS"
    leaves = [command for command in all_commands(program) if not command.commands]
    yield "\n.br\n".join(map(synopsis_of, leaves))
    examples, status = "\n".join(program.notes).split("\n\n")[:2]
    yield from [".SH DESCRIPTION", filled(program.summary)]
    yield from [".SH OPTIONS", *entries_in_roff(program.lists["Options"])]
    yield ".SH COMMANDS"
    told = set()
    for command in leaves:
        yield from [f".SS {roff(' '.join(command.path))}", sentences(command.summary)]
        for heading in ("Positionals", "Options"):
            entries = [entry for entry in command.lists.get(heading, []) if "--help" not in entry.names]
            yield from entries_in_roff(entries)
        notes = tuple(command.notes)
        if notes not in told:
            told.add(notes)
            yield from notes_in_roff(notes)
    yield from [".SH EXIT STATUS", filled(status)]
    yield from [".SH ENVIRONMENT", ".TP", "\\fBTRAPEZE_\\fITABLE\\fB_\\fIKEY\\fR",
                "The setting \\fITABLE\\fR.\\fIKEY\\fR of",
                ".BR trapeze.toml (5);", "it overrides the file, and the command line overrides both."]
    yield from [".SH EXAMPLES", *notes_in_roff(examples.split("\n")[1:])]
    yield from [".SH SEE ALSO", ".BR trapeze.toml (5)"]


def takes(setting):
    kinds = {"integer": "an integer", "number": "a number", "string": "a string", "boolean": "true or false",
             "array": "a list"}
    types = setting.get("type", [])
    words = " or ".join(kinds.get(kind, "") for kind in ([types] if isinstance(types, str) else types))
    if "enum" in setting:
        words = "one of " + ", ".join(json.dumps(value) for value in setting["enum"])
    elif "maximum" in setting:
        words += f" from {setting['minimum']:.10g} to {setting['maximum']:.10g}"
    if "default" in setting:
        words += f"; {json.dumps(setting['default'], ensure_ascii=False)} if it is not set"
    return words


def setting_in_roff(key, setting):
    return [".TP", f"\\fB{roff(key)}\\fR", sentences(setting["description"]), ".br", sentences(takes(setting))]


def parameters_of(program):
    rows = [line.strip("| \n").split(" | ") for line in said_by(program, "parameters").split("\n")]
    return [row for row in rows if row[0].startswith("`")]


def settings_page(schema, parameters):
    yield from [".SH NAME", "trapeze.toml \\- configuration of the tile server trapeze", ".SH DESCRIPTION",
                "A file in TOML that",
                ".B trapeze serve \\-\\-config", "reads; every setting may be left out.",
                "Paths are relative to the file.", "In strings, ${\\fINAME\\fR} is a variable of the environment,",
                "${\\fINAME\\fR:\\-\\fIwords\\fR} has a default, and $$ is a $.", ".PP",
                ".B trapeze config check", "tells all that is wrong with a file,",
                ".B trapeze config print", "what comes of it."]
    tables = schema["properties"]
    for name, table in tables.items():
        if name in ("styles", "fonts", "values", "layer"):
            continue
        yield from [f".SH [{roff(name)}]",
                    f"A key is also a variable of the environment, \\fBTRAPEZE_{roff(name.upper())}_\\fIKEY\\fR."]
        for key, setting in table["properties"].items():
            yield from setting_in_roff(key, setting)
    yield from [".SH [[layer]]", sentences(tables["layer"]["description"])]
    for key, setting in tables["layer"]["items"]["properties"].items():
        if key == "style":
            setting = {"description": "a table of what is told under STYLES"}
        yield from setting_in_roff(key, setting)
    for name in ("values", "fonts"):
        yield from [f".SH [{name}.\\fINAME\\fR]", sentences(tables[name]["description"])]
        for key, setting in tables[name]["additionalProperties"]["properties"].items():
            yield from setting_in_roff(key, setting)
    yield from [".SH STYLES", "A layer's \\fBstyle\\fR, and a table \\fB[styles.\\fINAME\\fB]\\fR for",
                "style=\\fINAME\\fR in requests, take these parameters;",
                "in their names \\(aq_\\(aq may stand for \\(aq\\-\\(aq."]
    for name, does, what, otherwise in parameters:
        yield from [".TP", f"\\fB{roff(name.strip('`'))}\\fR", sentences(does), ".br",
                    sentences(f"{what}; without it: {otherwise}")]
    yield from [".SH SEE ALSO", ".BR trapeze (1)"]


# Completion


KEYWORDS = {"--config": "toml", "--set": "setting", "--style": "nothing"}


def kind_of(command, entry):
    """How the operand of an entry is completed: in words, or by a name that the function knows."""
    operand = entry.operand.removesuffix("...").strip() or entry.names[0]
    for name in entry.names:
        if name in KEYWORDS:
            return KEYWORDS[name]
    if command.path == ["config", "check"] and operand == "FILE":
        return "toml"
    if choices := choices_of(entry):
        return " ".join(choices)
    return {"FILE": "file", "OUT": "file", "F": "file", "OLD": "file", "NEW": "file", "PART": "file",
            "DIR": "folder"}.get(operand, "nothing")


def cases_of(program):
    for command in all_commands(program):
        path = " ".join(["trapeze", *command.path])
        words = [inner.path[-1] for inner in command.commands]
        for entry in command.lists.get("Options", []):
            words += [name for name in entry.names if name.startswith("--")]
            if entry.operand:
                for name in entry.names:
                    yield f'["{path}:{name}"]="{kind_of(command, entry)}"'
        positionals = command.lists.get("Positionals", [])
        yield f'["{path}"]="{" ".join(words)}"'
        if positionals:
            yield f'["{path}:"]="{kind_of(command, positionals[-1])}"'


def settings_in_words(schema):
    for name, table in schema["properties"].items():
        for key, setting in table.get("properties", {}).items():
            values = setting.get("enum") or (["true", "false"] if setting.get("type") == "boolean" else [])
            yield f'["{name}.{key}"]="{" ".join(values)}"'


COMPLETION = """\
# Completes the command line of trapeze in bash. Made from what the program says of itself.

# By command: its commands and options; by command and option, or nothing: what is to follow.
declare -gA _trapeze_words=(
  @CASES@
)
# By setting: its values, if they are few.
declare -gA _trapeze_settings=(
  @SETTINGS@
)

# Words that begin as $cur does.
_trapeze_offer() {
  mapfile -t COMPREPLY < <(compgen "$@" -- "$cur")
}

_trapeze_offer_names() {
  compopt -o filenames 2>/dev/null # outside of a completion, there is nothing to set
  _trapeze_offer "$@"
}

_trapeze_offer_settings() {
  if [[ $cur == *=* ]]; then
    local setting=${cur%%=*}
    local value=${cur#*=}
    mapfile -t COMPREPLY < <(compgen -P "$setting=" -W "${_trapeze_settings[$setting]-}" -- "$value")
  else
    compopt -o nospace 2>/dev/null
    _trapeze_offer -S = -W "${!_trapeze_settings[*]}"
  fi
}

_trapeze_offer_kind() {
  case $1 in
    nothing) ;;
    file) _trapeze_offer_names -f ;;
    folder) _trapeze_offer_names -d ;;
    toml)
      _trapeze_offer_names -f -X '!*.toml'
      local files=("${COMPREPLY[@]}")
      _trapeze_offer -d
      COMPREPLY+=("${files[@]}")
      ;;
    setting) _trapeze_offer_settings ;;
    *) _trapeze_offer -W "$1" ;;
  esac
}

_trapeze() {
  local words cur previous path=trapeze word
  # Words as the shell has them: readline parts them at ':' and '=' too.
  # shellcheck disable=SC2162 # a backslash keeps a blank in its word
  read -a words <<<"${COMP_LINE:0:COMP_POINT}"
  [[ ${COMP_LINE:0:COMP_POINT} != *[[:space:]] ]] || words+=('')
  cur=${words[-1]}
  previous=${words[-2]}
  COMPREPLY=()
  for word in "${words[@]:1:${#words[@]}-2}"; do
    [[ ! -v _trapeze_words["$path $word"] ]] || path="$path $word"
  done
  if [[ -v _trapeze_words["$path:$previous"] ]]; then
    _trapeze_offer_kind "${_trapeze_words["$path:$previous"]}"
  elif [[ $cur == --*=* ]]; then
    local option=${cur%%=*}
    cur=${cur#*=}
    _trapeze_offer_kind "${_trapeze_words["$path:$option"]-nothing}"
  elif [[ $cur != -* && -v _trapeze_words["$path:"] ]]; then
    _trapeze_offer_kind "${_trapeze_words["$path:"]}"
  else
    _trapeze_offer -W "${_trapeze_words["$path"]}"
  fi
  # What readline takes for words of their own is there already.
  local there=${cur%"${cur##*[:=]}"}
  [[ -z $there ]] || COMPREPLY=("${COMPREPLY[@]#"$there"}")
}

complete -F _trapeze trapeze
"""


def completion(program, schema):
    return (COMPLETION.replace("@CASES@", "\n  ".join(cases_of(program)))
            .replace("@SETTINGS@", "\n  ".join(settings_in_words(schema))))


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    version = said_by(program, "--version").strip()
    described = command_of(program)
    schema = json.loads(said_by(program, "config", "schema"))
    pages = {
        "trapeze.1": page("trapeze", 1, version, program_page(described)),
        "trapeze.toml.5": page("trapeze.toml", 5, version, settings_page(schema, parameters_of(program))),
    }
    for name, text in pages.items():
        (folder / name).write_text(text, encoding="utf-8")
        (folder / f"{name}.gz").write_bytes(gzip.compress(text.encode(), mtime=0))
    (folder / "trapeze.bash").write_text(completion(described, schema))


main()
